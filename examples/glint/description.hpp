// What a scene asks for, as plain data: filled by the command line or a scene file, turned into compiled kernels by shader.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <mica/shade/glint_kernel.hpp>

namespace glint {

using vector = mica::vector3<float>;
using colour = mica::rgb<float>;

inline constexpr float degrees_per_radian = 57.2957795F;

/// A sphere, or a horizontal plane.
struct surface_description {
    std::string shape = "sphere";
    vector centre{0, 0, 0}; ///< of a plane: its height is centre.y
    float radius = 1;
    mica::glint_material material;
    float roughness_across = 0; ///< alpha along the bitangent, for lights; 0: isotropic
    std::string distribution = "ggx";
};

struct light_description {
    std::string type = "environment";
    // An environment.
    std::string file; ///< empty: the procedural one; or one of is_built_in()
    int levels = 4;
    std::string classes = "brightness"; ///< or colour, or published
    float gamma = 0.05F;                ///< of type wdh20: the probability of a flash, whatever the light
    // The others. Directional lights have an irradiance instead of a radiance.
    vector direction{0.55F, 0.6F, 0.6F};               ///< towards the light
    vector centre{1.2F, 1.6F, 2.2F};                   ///< of an area light
    vector half_u{-0.9F, 0, 0.5F}, half_v{0, 0.8F, 0}; ///< of a rectangle
    vector normal{-0.4F, -0.55F, -0.73F};              ///< of a disk, the side that shines
    float radius = 0.8F;                               ///< of a disk
    float half_angle = 0.00465F;                       ///< of a sun, radians
    colour radiance{1, 1, 1};
    float glint_fraction = 1; ///< of a directional light, R in (0, 1]
};

struct effects_description {
    std::optional<float> angular_grid, varied_density, tint, smooth_tolerance;
    bool one_grid = false;

    bool any() const { return angular_grid || varied_density || tint || smooth_tolerance || one_grid; }
};

/// Of a light's type: whether it shines from all around.
inline bool is_environment(const std::string& type) { return type == "environment" || type == "wdh20"; }

/// Whether a wall on that side hides what is in a direction.
inline bool hides(const std::optional<vector>& side, vector direction) { return side && dot(direction, *side) > 0; }

/// "angular_grid, tint", or "none".
std::string names_of(const effects_description& effects);

/// How facets are counted.
struct counting_description {
    std::string law = "quantile"; ///< or none: the smooth surface
    std::string interpolate = "variates";
    double softness = 0;
    effects_description effects;
};

struct camera_description {
    vector eye{0, 0, 4}, target{0, 0, 0};
    float field_of_view = 0.546F; ///< radians, of the smaller side of the picture
};

/// The cameras of the two shapes: the smaller side of the picture sees the unit sphere with a margin; the plane is seen
/// from a height of 1.2.
inline camera_description camera_for(const std::string& shape) {
    if (shape != "plane") return {};
    return {{0, 1.2F, 0}, {0, 1.2F - 0.42F, -1}, 0.8456F};
}

struct scene_description {
    std::size_t width = 960, height = 540;
    std::uint32_t seed = 1;
    camera_description camera;
    std::vector<surface_description> surfaces = {{}};
    std::vector<light_description> lights = {{}};
    std::optional<vector> occluder; ///< a wall: nothing shines from directions on its side
    counting_description counting;
};

/// Environments without a file: "white", radiance 1 from everywhere, and "lamps:50", three coloured lamps 50 degrees apart.
bool is_built_in(const std::string& environment);

/// The degrees of "lamps:50", in (0, 90); nothing of another name.
std::optional<float> lamps_apart(const std::string& environment);

/// Throws std::invalid_argument, in one line, where a number is out of its domain or a name unknown.
void check(const scene_description& description);

} // namespace glint
