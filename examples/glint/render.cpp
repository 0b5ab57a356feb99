#include "render.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "frame_file.hpp"
#include "option_text.hpp"
#include "scene_file.hpp"

namespace glint {

namespace {

/// Of the rainbow, luminance 1: turn in [0, 1).
colour rainbow(float turn) {
    const auto band = [turn](float third) {
        return 1 + 0.9F * std::cos(2 * std::numbers::pi_v<float> * (turn - third / 3));
    };
    const colour hue{band(0), band(1), band(2)};
    return (1 / luminance(hue)) * hue;
}

/// The light as the option names it. Its radiance is that under which a dielectric-free white surface of the default
/// roughness is about as bright as under the procedural environment.
light_description light_named(const render_options& options) {
    light_description light;
    light.type = options.light;
    light.file = options.environment;
    light.levels = options.levels;
    light.classes = options.classes;
    const float radiance = light.type == "sun" ? 2e4F : light.type == "directional" ? 2.F : 4.F;
    light.radiance = {radiance, radiance, radiance};
    return light;
}

/// Turned about the vertical axis.
vector turned(vector v, float angle) {
    const float c = std::cos(angle), s = std::sin(angle);
    return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

/// The same light so many times in an arc around the scene, each in a colour of the rainbow.
std::vector<light_description> arc_of(const light_description& light, int count) {
    if (count < 1 || count > 8) throw std::invalid_argument("--lights " + std::to_string(count) + " is not in [1, 8]");
    if (count == 1) return {light};
    if (is_environment(light.type))
        throw std::invalid_argument("--lights " + std::to_string(count) + ": an environment is one light");
    std::vector<light_description> lights;
    for (int i = 0; i < count; ++i) {
        const float part = static_cast<float>(i) / static_cast<float>(count);
        const float angle = (part - 0.5F + 0.5F / static_cast<float>(count)) * std::numbers::pi_v<float>;
        auto& one = lights.emplace_back(light);
        for (vector* v : {&one.direction, &one.centre, &one.half_u, &one.half_v, &one.normal}) *v = turned(*v, angle);
        one.radiance = light.radiance * rainbow(part);
    }
    return lights;
}

/// The number that a person would write for it.
double decimal(float value) {
    char text[32];
    const auto [end, error] = std::to_chars(text, text + sizeof text, value);
    return std::strtod(std::string(text, end).c_str(), nullptr);
}

} // namespace

scene_description describe(const render_options& options) {
    if (!options.scene_file.empty()) return read_scene(options.scene_file);
    scene_description scene;
    std::tie(scene.width, scene.height) = parse_size(options.size);
    scene.seed = options.seed;
    scene.camera = camera_for(options.shape);
    surface_description& surface = scene.surfaces.front();
    surface.shape = options.shape;
    surface.material.roughness = static_cast<float>(options.roughness);
    surface.material.log_density = static_cast<float>(options.log_density);
    scene.lights = arc_of(light_named(options), options.lights);
    if (!options.occluder.empty()) scene.occluder = parse_vector(options.occluder);
    scene.counting = options.counting;
    return scene;
}

void render(const render_options& options) {
    const stopwatch watch;
    const scene_description description = describe(options);
    check(description);
    const frame_file output(options.output);
    if (!options.tile.empty() && !output.takes_tiles())
        throw std::invalid_argument("--tile needs an .exr output: the exposure of a PNG is that of the whole picture, "
                                    "which glint merge makes");
    const pixel_rectangle tile = parse_tile(options.tile, description.width, description.height);
    const shader shade(description);
    const double prepared = watch.seconds();

    const stopwatch shading;
    const frame rendered =
        render_frame(scene(description.camera, description.surfaces, description.width, description.height), shade,
                     description.seed, tile);
    const double shading_seconds = shading.seconds();
    const frame_statistics seen = statistics_of(rendered);
    output.save(rendered, seen, options.origin);

    const auto pixels = static_cast<double>(std::max<std::size_t>(seen.surface_pixels, 1));
    const double ns_per_pixel = shading_seconds * 1e9 / pixels;
    const auto& light = description.lights.front();
    const auto& counting = description.counting;
    if (options.json) {
        nlohmann::ordered_json row = {{"width", description.width},
                                      {"height", description.height},
                                      {"shape", description.surfaces.front().shape},
                                      {"light", light.type},
                                      {"lights", description.lights.size()},
                                      {"environment", light.file.empty() ? "procedural" : light.file},
                                      {"classes", light.classes},
                                      {"law", counting.law},
                                      {"levels", light.levels},
                                      {"interpolate", counting.interpolate},
                                      {"effects", names_of(counting.effects)},
                                      {"roughness", decimal(description.surfaces.front().material.roughness)},
                                      {"log_density", decimal(description.surfaces.front().material.log_density)},
                                      {"seed", description.seed},
                                      {"seconds", watch.seconds()},
                                      {"prepare_seconds", prepared},
                                      {"ns_per_pixel", ns_per_pixel},
                                      {"binomials_per_pixel", shade.binomials_per_pixel()},
                                      {"surface_pixels", seen.surface_pixels},
                                      {"non_finite_pixels", seen.non_finite_pixels},
                                      {"mean_glint", seen.mean_glint},
                                      {"mean_smooth", seen.mean_smooth},
                                      {"output", options.output}};
        std::printf("%s\n", row.dump(1).c_str());
    } else {
        std::printf("%s: %zux%zu, %s law, %zu light%s (%s), %.2f s (%.2f s of them preparing)\n"
                    "mean luminance %.4g with glints, %.4g smooth; %.0f ns and %zu binomials per pixel\n",
                    options.output.c_str(), description.width, description.height, counting.law.c_str(),
                    description.lights.size(), description.lights.size() > 1 ? "s" : "", light.type.c_str(),
                    watch.seconds(), prepared, seen.mean_glint, seen.mean_smooth, ns_per_pixel,
                    shade.binomials_per_pixel());
    }
}

} // namespace glint
