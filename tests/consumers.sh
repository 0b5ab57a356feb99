#!/usr/bin/env bash
# The README's "Using it" as a new user would try it: its program built and run in each of the ways, with the lines that
# stand there, each in an empty folder:
#     consumers.sh SOURCE_DIR CMAKE_GENERATOR
set -euo pipefail
source=$1
unset CXXFLAGS CPPFLAGS LDFLAGS CPATH CPLUS_INCLUDE_PATH CMAKE_BUILD_TYPE
export CXX=g++ CMAKE_GENERATOR=$2 CMAKE_EXPORT_COMPILE_COMMANDS=ON

HOME=$(mktemp -d) # the README installs below it
export HOME
log=$(mktemp) # of the last command that said much
trap '[ $? = 0 ] || cat "$log"; rm -rf "$HOME" "$log"' EXIT
quietly() {
    "$@" >"$log" 2>&1
}
fail() {
    printf '%s\n' "$1" >&2
    exit 1
}
block() { # SECTION N: the N-th fenced block of a section of the README
    awk -v section="$1" -v wanted="$2" '
        /^#+ / && !inside { here = $0 == section; count = 0 }
        /^```/ { if (inside) inside = 0; else { inside = 1; ++count }; next }
        inside && here && count == wanted' "$source/README.md"
}
using() {
    block '## Using it' "$1"
}

# What somebody gets who takes mica: no more is needed.
mkdir "$HOME/got"
cp -r "$source"/{CMakeLists.txt,CMakePresets.json,LICENSE,cmake,include,tools} "$HOME/got"

# A project of the README's program alone.
project() {
    mkdir "$HOME/$1"
    cd "$HOME/$1"
    block '# mica' 1 >main.cpp
}
prints_what_the_readme_says() { # PROGRAM
    diff <("$1") <(block '# mica' 2) || fail "$PWD: the program prints something else"
    printf '%s: good\n' "${PWD##*/}"
}
# A compiler's words: nothing but -std, where headers lie, and which file is made of which.
carries_no_flag() { # COMPILER WORD...
    shift
    while [ $# -gt 0 ]; do
        case $1 in
            -std=gnu++20 | -I*) ;;
            -isystem | -o | -c) shift ;;
            *) fail "$PWD: mica's users are compiled with $1" ;;
        esac
        shift
    done
}
built_by_cmake() { # [OPTION...], with the lines of standard input
    { printf 'cmake_minimum_required(VERSION 3.21)\nproject(glitter LANGUAGES CXX)\n' && cat; } >CMakeLists.txt
    quietly cmake -S . -B build "$@"
    quietly cmake --build build
    # shellcheck disable=SC2046
    carries_no_flag $(sed -n 's/^ *"command": "\(.*\)",$/\1/p' build/compile_commands.json)
    prints_what_the_readme_says build/glitter
}
built_by_hand() { # a script
    quietly bash -euc "$1"
    prints_what_the_readme_says ./glitter
}

cd "$HOME/got"
using 1 >"$HOME/install" # it exports where to find it
quietly . "$HOME/install"

# Headers and what finds them; all headers.
diff <(cd "$source/include" && find mica -name '*.hpp' | sort) <(cd "$HOME/mica/include" && find . -type f | sed 's|^./||' | sort) ||
    fail "include/ is not the tree's headers"
diff - <(cd "$HOME/mica" && find . -type f -not -path './include/*' | sort) <<'END' || fail "something else is installed"
./share/cmake/mica/micaConfig.cmake
./share/cmake/mica/micaConfigVersion.cmake
./share/pkgconfig/mica.pc
END
grep -r "$HOME" "$HOME/mica" && fail "what is installed says where"

project installed
using 2 | built_by_cmake
project pkg-config
built_by_hand "$(using 5)"

mv "$HOME/mica" "$HOME/elsewhere"
export CMAKE_PREFIX_PATH=$HOME/elsewhere PKG_CONFIG_PATH=$HOME/elsewhere/share/pkgconfig
project installed-and-moved
using 2 | built_by_cmake
project pkg-config-and-moved
built_by_hand "$(using 5)"

# shellcheck disable=SC2046
carries_no_flag pkg-config $(pkg-config --cflags mica)
[ -z "$(pkg-config --libs mica)" ] || fail "mica.pc gives the linker $(pkg-config --libs mica)"
version=$(pkg-config --modversion mica)
grep -q "\"version\": \"$version\"" "$source/packaging/vcpkg/ports/mica/vcpkg.json" || fail "vcpkg.json is not of $version"
unset CMAKE_PREFIX_PATH PKG_CONFIG_PATH

project folder
cp -r "$HOME/got" mica
using 3 | built_by_cmake

cd "$HOME/got"
git init --quiet --initial-branch=main
git add .
git -c user.name=consumer -c user.email=consumer@localhost commit --quiet --message=mica
project fetched
using 4 | built_by_cmake -DMICA_REPOSITORY="$HOME/got"

project single-header
cp -r "$HOME/got" mica
built_by_hand "$(using 6)"
diff <(find third_party -type f) <(printf 'third_party/mica/mica.hpp\n')
