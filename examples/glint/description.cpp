#include "description.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string_view>

#include "kernels.hpp"

namespace glint {

namespace {

std::string text_of(float value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", static_cast<double>(value));
    return text;
}

void require_within(const char* name, float value, float low, float high) {
    if (!(value >= low && value <= high))
        throw std::invalid_argument(std::string(name) + " " + text_of(value) + " is not in [" + text_of(low) + ", " +
                                    text_of(high) + "]");
}

void require_positive(const char* name, float value) {
    if (!(value > 0 && std::isfinite(value)))
        throw std::invalid_argument(std::string(name) + " " + text_of(value) + " is not positive");
}

/// Of what a scene holds, so that squares of squares stay finite.
constexpr float smallest_size = 1e-6F, largest_size = 1e6F;

void require_place(const char* name, vector v) {
    for (const float x : {v.x, v.y, v.z}) require_within(name, x, -largest_size, largest_size);
}

void require_direction(const char* name, vector v) {
    const float square = dot(v, v);
    if (!(square > 0 && std::isfinite(square)))
        throw std::invalid_argument(std::string(name) + " is not a direction: it is zero or not finite");
}

void require_one_of(const char* what, const std::string& name, std::initializer_list<const char*> known) {
    std::string list;
    for (const char* one : known) {
        if (name == one) return;
        list += (list.empty() ? "" : ", ") + std::string(one);
    }
    throw std::invalid_argument(std::string("unknown ") + what + " '" + name + "' (known: " + list + ")");
}

void check(const surface_description& surface) {
    require_one_of("shape", surface.shape, {"sphere", "plane"});
    require_one_of("distribution", surface.distribution, {"ggx", "beckmann"});
    require_within("roughness", surface.material.roughness, 0, 1);
    require_within("roughness_across", surface.roughness_across, 0, 1);
    require_within("log density", surface.material.log_density, -60, 60);
    for (const float band : {surface.material.f0.r, surface.material.f0.g, surface.material.f0.b})
        require_within("reflectance", band, 0, 1);
    require_place("centre", surface.centre);
    require_positive("glint_size", surface.material.footprint_scale);
    require_within("radius", surface.radius, smallest_size, largest_size);
}

void check(const light_description& light) {
    require_one_of("light", light.type, {"environment", "wdh20", "directional", "sun", "area", "rectangle", "disk"});
    require_one_of("classes", light.classes, {"brightness", "colour", "published"});
    if (light.levels < 2)
        throw std::invalid_argument("levels " + std::to_string(light.levels) + " is below 2 (one level is the dark)");
    if (light.levels > 8)
        throw std::invalid_argument("levels " + std::to_string(light.levels) + " is not compiled in (2 to 8 are)");
    require_positive("gamma", light.gamma);
    require_within("gamma", light.gamma, 0, 1);
    require_direction("direction", light.direction);
    require_direction("normal", light.normal);
    require_direction("the area of a light", cross(light.half_u, light.half_v));
    require_place("centre", light.centre);
    require_place("half_u", light.half_u);
    require_place("half_v", light.half_v);
    require_within("radius", light.radius, smallest_size, largest_size);
    require_positive("half_angle_degrees", light.half_angle);
    require_within("half_angle_degrees", light.half_angle * degrees_per_radian, 0, 180);
    require_within("glint_fraction", light.glint_fraction, 1e-6F, 1);
    for (const float band : {light.radiance.r, light.radiance.g, light.radiance.b})
        require_within("radiance", band, 0, 1e12F);
}

void check(const effects_description& effects) {
    if (effects.angular_grid) require_within("angular_grid", *effects.angular_grid, 1e-4F, 1);
    if (effects.varied_density) require_within("varied_density", *effects.varied_density, 0, 1);
    if (effects.tint) require_within("tint", *effects.tint, 0, 1);
    if (effects.smooth_tolerance) require_within("smooth_where_dense", *effects.smooth_tolerance, 0, 1);
}

} // namespace

std::string names_of(const effects_description& effects) {
    std::string names;
    const auto add = [&names](bool there, const char* name) {
        if (there) names += (names.empty() ? "" : ", ") + std::string(name);
    };
    add(effects.angular_grid.has_value(), "angular_grid");
    add(effects.varied_density.has_value(), "varied_density");
    add(effects.tint.has_value(), "tint");
    add(effects.smooth_tolerance.has_value(), "smooth_where_dense");
    add(effects.one_grid, "one_grid");
    return names.empty() ? "none" : names;
}

std::optional<float> lamps_apart(const std::string& environment) {
    constexpr std::string_view lamps = "lamps:";
    if (!environment.starts_with(lamps)) return std::nullopt;
    float degrees = 0;
    const char* const end = environment.data() + environment.size();
    const auto [rest, error] = std::from_chars(environment.data() + lamps.size(), end, degrees);
    const bool is_angle = error == std::errc() && rest == end && degrees > 0 && degrees < 90;
    return is_angle ? std::optional(degrees) : std::nullopt;
}

bool is_built_in(const std::string& environment) { return environment == "white" || lamps_apart(environment); }

void check(const scene_description& description) {
    const auto is_side = [](std::size_t n) { return n >= 1 && n <= 16384; };
    if (!is_side(description.width) || !is_side(description.height))
        throw std::invalid_argument("size " + std::to_string(description.width) + "x" +
                                    std::to_string(description.height) + " is not from 1x1 to 16384x16384");
    require_place("eye", description.camera.eye);
    require_place("target", description.camera.target);
    require_direction("the way from eye to target", description.camera.target - description.camera.eye);
    require_within("field_of_view_degrees", description.camera.field_of_view * degrees_per_radian, 0.01F, 170);
    if (description.surfaces.empty()) throw std::invalid_argument("a scene needs a surface");
    for (const auto& surface : description.surfaces) check(surface);
    if (description.lights.empty()) throw std::invalid_argument("a scene needs a light");
    if (description.lights.size() > most_classes)
        throw std::invalid_argument(std::to_string(description.lights.size()) + " lights are more than the " +
                                    std::to_string(most_classes) + " that are compiled in");
    if (std::count_if(description.lights.begin(), description.lights.end(),
                      [](const auto& light) { return light.type == "environment"; }) > 1)
        throw std::invalid_argument("a scene has at most one environment");
    for (const auto& light : description.lights) check(light);
    if (std::any_of(description.lights.begin(), description.lights.end(),
                    [](const auto& light) { return is_environment(light.type); }))
        for (const auto& surface : description.surfaces)
            if (surface.distribution != "ggx" || surface.roughness_across > 0)
                throw std::invalid_argument(
                    "environments are compiled in for ggx of one roughness: under them a surface has "
                    "no other distribution and no roughness_across");
    if (description.occluder) require_direction("occluder", *description.occluder);
    check(description.counting.effects);
}

} // namespace glint
