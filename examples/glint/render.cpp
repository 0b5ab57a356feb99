#include "render.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace glint {

namespace {

struct picture_size {
    std::size_t width, height;
};

/// "WxH", both from 1 to 16384.
picture_size parse_size(const std::string& text) {
    picture_size size{};
    const char* const end = text.data() + text.size();
    const auto [cross, width_error] = std::from_chars(text.data(), end, size.width);
    const bool has_cross = width_error == std::errc() && cross != end && *cross == 'x';
    const auto [rest, height_error] = std::from_chars(has_cross ? cross + 1 : end, end, size.height);
    if (!has_cross || height_error != std::errc() || rest != end)
        throw std::invalid_argument("--size " + text + " is not WIDTHxHEIGHT");
    if (size.width < 1 || size.height < 1 || size.width > 16384 || size.height > 16384)
        throw std::invalid_argument("--size " + text + " is not from 1x1 to 16384x16384");
    return size;
}

shape parse_shape(const std::string& name) {
    if (name == "sphere") return shape::sphere;
    if (name == "plane") return shape::plane;
    throw std::invalid_argument("unknown shape '" + name + "' (known: sphere, plane)");
}

void require(bool holds, const std::string& option, double value, const char* requirement) {
    if (holds) return;
    char text[64];
    std::snprintf(text, sizeof text, " %g is not ", value);
    throw std::invalid_argument("--" + option + text + requirement);
}

/// A string as JSON writes it.
std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            result += {'\\', c};
        } else if (static_cast<unsigned char>(c) < 0x20) {
            char escaped[8];
            std::snprintf(escaped, sizeof escaped, "\\u%04x", c);
            result += escaped;
        } else {
            result += c;
        }
    }
    return result + '"';
}

template <class Law, class Interpolation, std::size_t K>
void render(const render_options& options, const picture_size& size, shape what, Law, Interpolation interpolation,
            std::integral_constant<std::size_t, K>) {
    const stopwatch watch;
    const auto map = options.environment.empty() ? procedural_environment() : read_environment(options.environment);
    const png_file output(options.output);

    mica::glint_material material;
    material.roughness = static_cast<float>(options.roughness);
    material.log_density = static_cast<float>(options.log_density);
    const mica::prefiltered_environment<K> environment(map, mica::environment_levels<K>(map), {&material.roughness, 1},
                                                       parallel_loop{"prefiltering"});
    const mica::microfacet_table table;
    const double prepared = watch.seconds();

    const frame seen = render_frame<Law>(scene(what, size.width, size.height), size.width, size.height, material,
                                         environment, table, options.seed, interpolation);
    srgb_picture picture(size.width, size.height, 0);
    tone_map(seen.glint, exposure_of(seen), picture, 0, 0);
    output.save(picture);

    const auto pixels = static_cast<double>(std::max<std::size_t>(seen.surface_pixels, 1));
    const double ns_per_pixel = seen.seconds * 1e9 / pixels;
    constexpr std::size_t binomials = Interpolation::template evaluations<mica::grid_vertices<float>> * (K - 1);
    if (options.json) {
        std::printf("{\"width\": %zu, \"height\": %zu, \"shape\": %s, \"environment\": %s, \"law\": %s, "
                    "\"levels\": %zu, \"interpolate\": %s, \"roughness\": %.9g, \"log_density\": %.9g, "
                    "\"seed\": %u, \"seconds\": %.4f, \"prepare_seconds\": %.4f, \"ns_per_pixel\": %.1f, "
                    "\"binomials_per_pixel\": %zu, \"surface_pixels\": %zu, \"non_finite_pixels\": %zu, "
                    "\"mean_glint\": %.9g, \"mean_smooth\": %.9g, \"output\": %s}\n",
                    size.width, size.height, quoted(options.shape).c_str(),
                    quoted(options.environment.empty() ? "procedural" : options.environment).c_str(),
                    quoted(options.law).c_str(), K, quoted(options.interpolate).c_str(), options.roughness,
                    options.log_density, options.seed, watch.seconds(), prepared, ns_per_pixel, binomials,
                    seen.surface_pixels, seen.non_finite_pixels, seen.mean_glint, seen.mean_smooth,
                    quoted(options.output).c_str());
    } else {
        std::printf("%s: %zux%zu, %s law, %zu levels, %.2f s (%.2f s of them prefiltering)\n"
                    "mean luminance %.4g with glints, %.4g smooth; %.0f ns and %zu binomials per pixel\n",
                    options.output.c_str(), size.width, size.height, options.law.c_str(), K, watch.seconds(), prepared,
                    seen.mean_glint, seen.mean_smooth, ns_per_pixel, binomials);
    }
}

} // namespace

void render(const render_options& options) {
    const picture_size size = parse_size(options.size);
    const shape what = parse_shape(options.shape);
    require(options.roughness >= 0 && options.roughness <= 1, "roughness", options.roughness, "in [0, 1]");
    require(std::isfinite(options.log_density) && std::abs(options.log_density) <= 60, "density", options.log_density,
            "in [-60, 60]");
    if (options.light != "environment")
        throw std::invalid_argument("unknown light '" + options.light + "' (known: environment)");

    with_law(options.law, [&](auto law) {
        with_interpolation(options.interpolate, options.softness, law, [&](auto interpolation) {
            with_levels(options.levels, [&](auto levels) { render(options, size, what, law, interpolation, levels); });
        });
    });
}

} // namespace glint
