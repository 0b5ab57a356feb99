#include "picture.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <stb_easy_font.h>
#include <stb_image.h>
#include <stb_image_write.h>
#include <unistd.h>

namespace glint {

namespace {

struct file_closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

/// A file that remembers whether more was asked of it than it has, and then gives empty lines, which end a header and
/// are runs in run-length coded data. Left alone, stb goes on with zeros, which end neither.
struct watched_file {
    std::FILE* file;
    bool ran_out = false;

    static int read(void* self, char* data, int size) {
        auto& watched = *static_cast<watched_file*>(self);
        const std::size_t got = std::fread(data, 1, static_cast<std::size_t>(size), watched.file);
        if (got > 0) return static_cast<int>(got);
        watched.ran_out = true;
        std::memset(data, '\n', static_cast<std::size_t>(size));
        return size;
    }
    static void skip(void* self, int bytes) { std::fseek(static_cast<watched_file*>(self)->file, bytes, SEEK_CUR); }
    static int eof(void* self) { return std::feof(static_cast<watched_file*>(self)->file); }
};

/// Run-length coded, 127 texels take at least two bytes in each of four bands.
constexpr std::uintmax_t most_texels_per_byte = 16;

std::uint8_t srgb_byte(float linear) {
    const float x = mica::clamp(linear, 0.F, 1.F); // NaN is black
    const float encoded = x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1 / 2.4F) - 0.055F;
    return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

} // namespace

std::runtime_error file_error(const std::string& path, const std::string& what) {
    return std::runtime_error(path + ": " + what);
}

std::uintmax_t size_of_plain_file(const std::string& path) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (error == std::errc::is_a_directory) throw file_error(path, "is a folder");
    if (error == std::errc::not_supported) throw file_error(path, "is not a plain file"); // a pipe, a device
    if (error) throw file_error(path, error.message());
    return bytes;
}

mica::environment_map read_environment(const std::string& path) {
    const std::uintmax_t bytes = size_of_plain_file(path);
    const std::unique_ptr<std::FILE, file_closer> file(std::fopen(path.c_str(), "rb"));
    if (!file) throw file_error(path, std::strerror(errno));

    watched_file watched{file.get()};
    const stbi_io_callbacks callbacks{watched_file::read, watched_file::skip, watched_file::eof};
    const auto start_again = [&] {
        std::rewind(file.get());
        watched.ran_out = false;
    };
    if (!stbi_is_hdr_from_callbacks(&callbacks, &watched))
        throw file_error(path, "is not an environment map (expected a Radiance .hdr or OpenEXR .exr file)");

    // The size first: nothing is allocated for a picture that cannot be in the file.
    int width = 0, height = 0, bands = 0;
    start_again();
    const bool has_size = stbi_info_from_callbacks(&callbacks, &watched, &width, &height, &bands) != 0;
    if (watched.ran_out) throw file_error(path, "is truncated");
    if (!has_size)
        throw file_error(path, "cannot be read: its header has no FORMAT=32-bit_rle_rgbe or no -Y height +X width");
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    if (height < 1 || height > widest_map || width != 2 * height)
        throw file_error(path, "is not an environment map: " + size + " is not twice as wide as high");
    if (width > widest_map)
        throw file_error(path, "is too large: " + size + ", at most " + std::to_string(widest_map) + " wide is read");
    const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
    if (w * h > most_texels_per_byte * bytes) throw file_error(path, "is truncated: " + size + " pixels are not in it");

    start_again();
    const std::unique_ptr<float, decltype(&stbi_image_free)> data(
        stbi_loadf_from_callbacks(&callbacks, &watched, &width, &height, &bands, 3), &stbi_image_free);
    if (watched.ran_out) throw file_error(path, "is truncated");
    if (!data) throw file_error(path, std::string("cannot be read: ") + stbi_failure_reason());

    std::vector<mica::rgb<float>> texels(w * h);
    for (std::size_t i = 0; i < w * h; ++i) {
        const float* band = data.get() + 3 * i;
        texels[i] = {band[0], band[1], band[2]};
    }
    return mica::environment_map(w, h, std::move(texels));
}

void tone_map(const radiance_picture& from, float exposure, srgb_picture& to, std::size_t left, std::size_t top) {
    constexpr float white = 6;
    for (std::size_t y = 0; y < from.height; ++y)
        for (std::size_t x = 0; x < from.width; ++x) {
            const auto& pixel = from.pixels[y * from.width + x];
            std::uint8_t* bytes = &to.bytes[3 * ((top + y) * to.width + left + x)];
            const float light = std::min(exposure * luminance(pixel), 1e6F);
            // At most white, so that the brightest glint still has the colour of its light.
            const float toned = std::min(light * (1 + light / (white * white)) / (1 + light), 1.F);
            const float scale = light > 0 ? toned / luminance(pixel) : 0.F;
            bytes[0] = srgb_byte(scale * pixel.r);
            bytes[1] = srgb_byte(scale * pixel.g);
            bytes[2] = srgb_byte(scale * pixel.b);
        }
}

void draw_text(srgb_picture& picture, const std::string& text, std::size_t left, std::size_t top, std::size_t scale,
               std::uint8_t grey) {
    // Quads of four vertices: x, y, z as float, then four bytes of colour.
    struct vertex {
        float x, y, z;
        unsigned char colour[4];
    };
    std::vector<vertex> vertices(text.size() * 80);
    std::string writable = text;
    const int quads = stb_easy_font_print(0, 0, writable.data(), nullptr, vertices.data(),
                                          static_cast<int>(vertices.size() * sizeof(vertex)));
    for (int quad = 0; quad < quads; ++quad) {
        const vertex* corner = &vertices[4 * static_cast<std::size_t>(quad)];
        const auto scaled = [scale](float x) { return static_cast<std::size_t>(std::max(x, 0.F)) * scale; };
        for (std::size_t y = top + scaled(corner[0].y); y < top + scaled(corner[2].y); ++y)
            for (std::size_t x = left + scaled(corner[0].x); x < left + scaled(corner[2].x); ++x)
                if (x < picture.width && y < picture.height)
                    std::fill_n(&picture.bytes[3 * (y * picture.width + x)], 3, grey);
    }
}

output_file::output_file(std::string path) : path_(std::move(path)) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path_, ignored)) throw file_error(path_, "cannot be written: is a folder");
    const std::string name = unfinished_name();
    const std::unique_ptr<std::FILE, file_closer> file(std::fopen(name.c_str(), "wb"));
    if (!file) throw file_error(path_, std::string("cannot be written: ") + std::strerror(errno));
    discard(name);
}

std::string output_file::unfinished_name() const { return path_ + "." + std::to_string(::getpid()) + ".part"; }

void output_file::discard(const std::string& name) { std::remove(name.c_str()); }

void output_file::publish(const std::string& name) const {
    if (std::rename(name.c_str(), path_.c_str()) == 0) return;
    const std::string reason = std::strerror(errno);
    discard(name);
    throw file_error(path_, "cannot be written: " + reason);
}

png_file::png_file(std::string path) : file_(std::move(path)) {
    if (!file_.path().ends_with(".png")) throw file_error(file_.path(), "cannot be written: a picture is .png");
}

void png_file::save(const srgb_picture& picture) const {
    const auto write = [](void* file, void* data, int size) {
        std::fwrite(data, 1, static_cast<std::size_t>(size), static_cast<std::FILE*>(file));
    };
    file_.save([&](const std::string& name) {
        const std::unique_ptr<std::FILE, file_closer> file(std::fopen(name.c_str(), "wb"));
        const bool encoded =
            file && stbi_write_png_to_func(write, file.get(), static_cast<int>(picture.width),
                                           static_cast<int>(picture.height), 3, picture.bytes.data(), 0) != 0;
        if (!encoded || std::fflush(file.get()) != 0 || std::ferror(file.get()) != 0)
            throw file_error(file_.path(), std::string("cannot be written: ") + std::strerror(errno));
    });
}

} // namespace glint
