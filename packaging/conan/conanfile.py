# The recipe of the checkout that it lies in: conan create packaging/conan -s compiler.cppstd=20
import os

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.files import copy, load
from conan.tools.layout import basic_layout

required_conan_version = ">=2.0"


class Mica(ConanFile):
    name = "mica"
    description = "Binomial and multinomial counts at constant cost, and glints drawn with them"
    license = "MIT"
    topics = ("binomial", "multinomial", "glints", "rendering", "header-only")
    settings = "os", "arch", "compiler", "build_type"
    package_type = "header-library"
    implements = ["auto_header_only"]
    no_copy_source = True

    @property
    def _checkout(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        lines = load(self, os.path.join(self._checkout, "include", "mica", "config.hpp")).splitlines()
        self.version = ".".join(line.split()[2] for line in lines if line.startswith("#define MICA_VERSION_"))

    def export_sources(self):
        copy(self, "LICENSE", self._checkout, self.export_sources_folder)
        copy(self, "include/*.hpp", self._checkout, self.export_sources_folder)

    def layout(self):
        basic_layout(self)

    def validate(self):
        check_min_cppstd(self, 20)

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        copy(self, "*.hpp", os.path.join(self.source_folder, "include"), os.path.join(self.package_folder, "include"))

    def package_info(self):
        self.cpp_info.bindirs = []
        self.cpp_info.libdirs = []
