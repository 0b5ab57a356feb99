// Rendering of one picture, rows in parallel.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include <mica/shade/environment_glints.hpp>
#include <tbb/parallel_for.h>

#include "dispatch.hpp"
#include "picture.hpp"
#include "progress.hpp"
#include "scene.hpp"

namespace glint {

/// Runs the rows of a loop side by side, with progress under a label.
struct parallel_loop {
    const char* label;

    template <class Body>
    void operator()(std::size_t count, const Body& body) const {
        progress reporter(label, count);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
            body(i);
            reporter.advance();
        });
    }
};

/// Seconds on the wall since it was made.
class stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

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

template <class Law, class Interpolation = mica::blended_variates, std::size_t K>
frame render_frame(const scene& seen, std::size_t width, std::size_t height, const mica::glint_material& material,
                   const mica::prefiltered_environment<K>& environment, const mica::microfacet_table& table,
                   std::uint32_t seed, Interpolation interpolation = {}) {
    const stopwatch watch;
    const std::vector<mica::rgb<float>> empty(width * height, background);
    frame result{{width, height, empty}, {width, height, empty}};
    std::vector<char> shows_surface(width * height, 0);
    parallel_loop{"rendering"}(height, [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x) {
            const auto point = seen.surface(x, y);
            if (!point) continue;
            const std::size_t i = y * width + x;
            const auto radiance = mica::shade<Law>(*point, material, environment, table, seed, interpolation);
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

/// The exposure that brings the typical smooth pixel to middle grey. By the smooth radiance, so that pictures of all
/// densities compare.
inline float exposure_of(const frame& seen) { return static_cast<float>(0.25 / std::max(seen.log_mean_smooth, 1e-6)); }

/// What the command line asks of `glint render`.
struct render_options {
    std::string environment; ///< path of an .hdr file, or empty for the procedural environment
    std::string light = "environment";
    std::string shape = "sphere";
    std::string size = "960x540";
    double roughness = 0.1;
    double log_density = 13;
    int levels = 4;
    std::string law = "quantile";
    std::string interpolate = "variates";
    double softness = 0;
    std::uint32_t seed = 1;
    std::string output = "glint.png";
    bool json = false;
};

void render(const render_options& options);

/// What the command line asks of `glint sheet`.
struct sheet_options {
    std::uint32_t seed = 1;
    std::string output = "contact-sheet.png";
};

void sheet(const sheet_options& options);

/// What the command line asks of `glint furnace`.
struct furnace_options {
    std::string law = "exact";
    std::vector<int> levels = {2, 4, 8};
    std::vector<double> roughness = {0.04, 0.1, 0.25, 0.5};
    std::vector<double> facets = {0.02, 0.14, 1, 7, 50, 400};
    double precision = 0.0015;
    bool json = false;
};

void furnace(const furnace_options& options);

} // namespace glint
