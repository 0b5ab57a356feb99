// Pictures in and out: Radiance .hdr environments, tone curve, labels, PNG.
#pragma once

#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <mica/shade/environment.hpp>

namespace glint {

/// Linear radiance, row by row from the top.
struct radiance_picture {
    std::size_t width = 0, height = 0;
    std::vector<mica::rgb<float>> pixels;
};

/// Some of a picture's pixels.
struct pixel_rectangle {
    std::size_t left = 0, top = 0, width = 0, height = 0;

    std::size_t area() const { return width * height; }
};

/// 8-bit sRGB, row by row from the top.
struct srgb_picture {
    std::size_t width = 0, height = 0;
    std::vector<std::uint8_t> bytes; ///< three per pixel

    srgb_picture(std::size_t width, std::size_t height, std::uint8_t grey)
        : width(width), height(height), bytes(3 * width * height, grey) {}
};

/// Environment maps may be so wide.
inline constexpr int widest_map = 8192;

/// In bytes. Throws std::runtime_error, in one line, where there is no such file or it is a folder, a pipe or a device.
std::uintmax_t size_of_plain_file(const std::string& path);

/// An equirectangular Radiance file. Throws std::runtime_error, in one line, where it is missing, truncated, of another
/// format, too large, or not twice as wide as high.
mica::environment_map read_environment(const std::string& path);

/// Exposure, then x (1 + x / white^2) / (1 + x) of the luminance, the bands in proportion, then the sRGB curve.
void tone_map(const radiance_picture& from, float exposure, srgb_picture& to, std::size_t left, std::size_t top);

/// Draws text, `scale` pixels per pixel of a font 7 high, its top left corner at (left, top). ASCII.
void draw_text(srgb_picture& picture, const std::string& text, std::size_t left, std::size_t top, std::size_t scale,
               std::uint8_t grey);

/// A file that appears under its name only when it is whole.
class output_file {
  public:
    /// Throws std::runtime_error where the file cannot be written, so that nobody renders for nothing. Leaves nothing.
    explicit output_file(std::string path);

    const std::string& path() const { return path_; }

    /// Calls write(name) with the name of a file to fill, which then takes its place. Nothing is left if it throws.
    template <class Write>
    void save(const Write& write) const {
        const std::string name = unfinished_name();
        try {
            write(name);
        } catch (...) {
            discard(name);
            throw;
        }
        publish(name);
    }

  private:
    std::string unfinished_name() const;
    static void discard(const std::string& name);
    void publish(const std::string& name) const;

    std::string path_;
};

/// A PNG file, likewise.
class png_file {
  public:
    explicit png_file(std::string path);

    void save(const srgb_picture& picture) const;

  private:
    output_file file_;
};

/// "path: what", of a file.
std::runtime_error file_error(const std::string& path, const std::string& what);

} // namespace glint
