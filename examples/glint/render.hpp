// Rendering of one picture, rows in parallel.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "picture.hpp"
#include "render_loop.hpp"
#include "scene.hpp"
#include "shader.hpp"

namespace glint {

/// Where no surface is.
inline constexpr mica::rgb<float> background{0, 0, 0};

/// A rendered picture or a tile of one, row by row from the top.
struct frame {
    std::size_t width = 0, height = 0; ///< of the whole picture
    pixel_rectangle tile;              ///< what is here of it
    radiance_picture glint, smooth;
    std::vector<char> shows_surface;

    frame(std::size_t width, std::size_t height, const pixel_rectangle& tile)
        : width(width), height(height), tile(tile), glint(empty(tile)), smooth(glint), shows_surface(tile.area(), 0) {}

  private:
    static radiance_picture empty(const pixel_rectangle& tile) {
        return {tile.width, tile.height, std::vector<mica::rgb<float>>(tile.area(), background)};
    }
};

/// What is seen in a frame. Means are of luminance over the pixels that show a surface.
struct frame_statistics {
    std::size_t surface_pixels = 0, non_finite_pixels = 0;
    double mean_glint = 0, mean_smooth = 0;
    double log_mean_smooth = 0; ///< geometric mean, for the exposure
};

/// Sums in the order of the pixels: they depend neither on threads nor on tiles.
inline frame_statistics statistics_of(const frame& seen) {
    frame_statistics result;
    for (std::size_t i = 0; i < seen.shows_surface.size(); ++i) {
        if (!seen.shows_surface[i]) continue;
        const double glint = static_cast<double>(luminance(seen.glint.pixels[i]));
        const double smooth = static_cast<double>(luminance(seen.smooth.pixels[i]));
        ++result.surface_pixels;
        result.non_finite_pixels += !std::isfinite(glint) || !std::isfinite(smooth);
        result.mean_glint += glint;
        result.mean_smooth += smooth;
        result.log_mean_smooth += std::log(std::max(smooth, 1e-6));
    }
    const auto count = static_cast<double>(std::max<std::size_t>(result.surface_pixels, 1));
    result.mean_glint /= count;
    result.mean_smooth /= count;
    result.log_mean_smooth = std::exp(result.log_mean_smooth / count);
    return result;
}

/// A tile of the picture. A pixel is the same in every tile: its facets come from where it is on the surface.
inline frame render_frame(const scene& seen, const shader& shade, std::uint32_t seed, const pixel_rectangle& tile) {
    frame result(seen.width(), seen.height(), tile);
    parallel_loop{"rendering"}(tile.height, [&](std::size_t y) {
        for (std::size_t x = 0; x < tile.width; ++x) {
            const auto hit = seen.surface(tile.left + x, tile.top + y);
            if (!hit) continue;
            const std::size_t i = y * tile.width + x;
            const auto radiance = shade(hit->point, seen.surfaces()[hit->surface], seed);
            result.glint.pixels[i] = radiance.glint;
            result.smooth.pixels[i] = radiance.smooth;
            result.shows_surface[i] = 1;
        }
    });
    return result;
}

/// All of it.
inline frame render_frame(const scene& seen, const shader& shade, std::uint32_t seed) {
    return render_frame(seen, shade, seed, {0, 0, seen.width(), seen.height()});
}

/// The exposure that brings the typical smooth pixel to middle grey, or, under few small lights, where most pixels are black,
/// a twentieth of the mean. By the smooth radiance, so that pictures of all densities compare.
inline float exposure_of(const frame_statistics& seen) {
    return static_cast<float>(0.25 / std::max({seen.log_mean_smooth, seen.mean_smooth / 8, 1e-6}));
}
inline float exposure_of(const frame& seen) { return exposure_of(statistics_of(seen)); }

/// What the command line asks of `glint render`.
struct render_options {
    std::string scene_file; ///< JSON; empty: the scene that the other options describe
    std::string environment;
    std::string light = "environment";
    std::string shape = "sphere";
    std::string size = "960x540";
    std::string tile;     ///< "x,y,w,h", or empty: all of the picture
    std::string occluder; ///< "x,y,z", or empty
    std::string classes = "brightness";
    double roughness = 0.1;
    double log_density = 13;
    int levels = 4;
    int lights = 1;
    counting_description counting;
    std::uint32_t seed = 1;
    std::string output = "glint.png"; ///< or .exr: linear radiance
    std::string origin;               ///< what is asked for, in words that a picture's tiles must share
    bool json = false;
};

/// The scene that the options describe, or the one of their file.
scene_description describe(const render_options& options);

void render(const render_options& options);

/// What the command line asks of `glint merge`.
struct merge_options {
    std::vector<std::string> tiles; ///< .exr files that `glint render --tile` wrote
    std::string output = "glint.png";
    bool json = false;
};

void merge(const merge_options& options);

/// What the command line asks of `glint sheet`.
struct sheet_options {
    std::uint32_t seed = 1;
    std::string output = "contact-sheet.png";
};

void sheet(const sheet_options& options);

/// What the command line asks of `glint furnace`.
struct furnace_options {
    counting_description counting{"exact", "variates", 0, {}};
    std::vector<std::string> lights = {"environment"};
    std::vector<int> levels = {2, 4, 8};
    std::vector<double> roughness = {0.04, 0.1, 0.25, 0.5};
    std::vector<double> facets = {0.02, 0.14, 1, 7, 50, 400};
    double precision = 0.0015;
    bool json = false;
};

void furnace(const furnace_options& options);

} // namespace glint
