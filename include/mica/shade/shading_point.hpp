// mica/shade/shading_point.hpp: what a kernel needs to know of a pixel.
#pragma once

#include "../grid/footprint.hpp"
#include "../grid/simplex.hpp"
#include "vector.hpp"

namespace mica {

/// A pixel on a surface, or one in every lane. Directions are of length 1 and point away from the surface.
template <real_number Real>
struct shading_point {
    vector3<Real> normal{};             ///< of the surface, shading normal and all
    vector3<Real> wo{};                 ///< towards the eye
    uv_point<Real> uv{};                ///< texture coordinates
    uv_derivatives<Real> derivatives{}; ///< uv per pixel
    vector3<Real> tangent{};  ///< perpendicular to the normal: the first axis of anisotropy and of half vectors
    vector3<Real> position{}; ///< in the scene; for lights at a finite distance

    /// A direction of the scene in the frame tangent, bitangent (normal x tangent), normal.
    MICA_HOST_DEVICE constexpr vector3<Real> local(vector3<Real> w) const {
        return {dot(w, tangent), dot(w, cross(normal, tangent)), dot(w, normal)};
    }
};

/// Radiance towards the eye: with the facets counted, and the smooth limit of infinitely many.
template <real_number Real>
struct glint_radiance {
    rgb<Real> glint;  ///< with the facets counted
    rgb<Real> smooth; ///< of infinitely many
};

} // namespace mica
