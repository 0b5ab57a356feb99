// Scenes as JSON: camera, surfaces, lights and effects. What a file leaves out has its default; what it misspells is an error.
#pragma once

#include <string>

#include "description.hpp"

namespace glint {

/// Throws std::runtime_error or std::invalid_argument, in one line that names the file and the place in it.
///
///     {"size": [960, 540], "seed": 1, "law": "quantile", "interpolate": "variates", "softness": 0,
///      "camera": {"eye": [0, 0, 4], "target": [0, 0, 0], "field_of_view_degrees": 31},
///      "surfaces": [{"shape": "sphere", "centre": [0, 0, 0], "radius": 1, "roughness": 0.1, "roughness_across": 0.1,
///                    "log_density": 13, "reflectance": [0.95, 0.93, 0.88], "distribution": "ggx", "glint_size": 1.25}],
///      "lights": [{"type": "environment", "file": "studio.hdr", "levels": 4, "classes": "brightness"},
///                 {"type": "sun", "direction": [1, 1, 1], "half_angle_degrees": 0.27, "radiance": [1e4, 1e4, 1e4]}],
///      "occluder": [1, 0, 0],
///      "effects": {"angular_grid": 0.02, "varied_density": 0.5, "tint": 0.5, "smooth_where_dense": 0.02,
///                  "one_grid": true}}
///
/// A light has `type` and, by type: environment, wdh20: file, levels, classes (gamma); directional: direction, radiance
/// (its irradiance), glint_fraction; sun: direction, half_angle_degrees, radiance; rectangle: centre, half_u, half_v,
/// radiance; disk: centre, normal, radius, radiance. Files are relative to the scene's folder.
scene_description read_scene(const std::string& path);

} // namespace glint
