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

/// A rendered picture and what was seen in it. Means are of luminance over the pixels that show the surface.
struct frame {
    radiance_picture glint, smooth;
    std::size_t surface_pixels = 0;
    std::size_t non_finite_pixels = 0;
    double mean_glint = 0, mean_smooth = 0;
    double log_mean_smooth = 0; ///< geometric mean, for the exposure
    double seconds = 0;         ///< of shading, on the wall
};

/// Where no surface is.
inline constexpr mica::rgb<float> background{0, 0, 0};

inline frame render_frame(const scene& seen, const shader& shade, std::uint32_t seed) {
    const stopwatch watch;
    const std::size_t width = seen.width(), height = seen.height();
    const std::vector<mica::rgb<float>> empty(width * height, background);
    frame result{{width, height, empty}, {width, height, empty}};
    std::vector<char> shows_surface(width * height, 0);
    parallel_loop{"rendering"}(height, [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x) {
            const auto hit = seen.surface(x, y);
            if (!hit) continue;
            const std::size_t i = y * width + x;
            const auto radiance = shade(hit->point, seen.surfaces()[hit->surface], seed);
            result.glint.pixels[i] = radiance.glint;
            result.smooth.pixels[i] = radiance.smooth;
            shows_surface[i] = 1;
        }
    });
    result.seconds = watch.seconds();

    // In the order of the pixels, so that the sums do not depend on the threads.
    for (std::size_t i = 0; i < width * height; ++i) {
        if (!shows_surface[i]) continue;
        const double glint = static_cast<double>(luminance(result.glint.pixels[i]));
        const double smooth = static_cast<double>(luminance(result.smooth.pixels[i]));
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

/// The exposure that brings the typical smooth pixel to middle grey, or, under few small lights, where most pixels are black,
/// a twentieth of the mean. By the smooth radiance, so that pictures of all densities compare.
inline float exposure_of(const frame& seen) {
    return static_cast<float>(0.25 / std::max({seen.log_mean_smooth, seen.mean_smooth / 8, 1e-6}));
}

/// What the command line asks of `glint render`.
struct render_options {
    std::string scene_file; ///< JSON; empty: the scene that the other options describe
    std::string environment;
    std::string light = "environment";
    std::string shape = "sphere";
    std::string size = "960x540";
    std::string occluder; ///< "x,y,z", or empty
    std::string classes = "brightness";
    double roughness = 0.1;
    double log_density = 13;
    int levels = 4;
    int lights = 1;
    counting_description counting;
    std::uint32_t seed = 1;
    std::string output = "glint.png";
    bool json = false;
};

/// The scene that the options describe, or the one of their file.
scene_description describe(const render_options& options);

void render(const render_options& options);

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
