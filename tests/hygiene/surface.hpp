// tests/hygiene/surface.hpp: a patch of a glittering surface. The functions are static: each translation unit has its own.
#pragma once

#include <array>
#include <cstdint>

#include <mica/mica.hpp>
#include <mica/reference/facets.hpp>

#include "drawn.hpp"

namespace surface {

inline constexpr float facets_per_uv2 = 2e7F;

static inline mica::shading_point<float> point() {
    mica::shading_point<float> seen{};
    seen.normal = {0, 0, 1};
    seen.tangent = {1, 0, 0};
    seen.wo = mica::normalized(mica::vector3<float>{0.3F, 0, 1});
    seen.uv = {0.3F, 0.7F};
    seen.derivatives = {0.002F, 0, 0.0005F, 0.002F};
    return seen;
}

static inline float facets() { return facets_per_uv2 * mica::make_footprint<float>(point().derivatives).area; }

/// How many of the facets of the pixel flash.
static inline float flashes(float probability, std::uint32_t seed) {
    const auto seen = point();
    const auto footprint = mica::make_footprint<float>(seen.derivatives);
    const auto vertices = mica::make_grid_vertices(footprint, seen.uv, facets(), seed);
    return mica::distributed_binomial<mica::quantile_binomial<4>>{}(vertices, probability);
}

static inline mica::glint_material material() {
    mica::glint_material shiny;
    shiny.roughness = 0.3F;
    shiny.log_density = mica::log(facets_per_uv2);
    return shiny;
}

/// Under a large sun: one facet in some fifty flashes.
static inline drawn::brightness under_the_sun(std::uint32_t seed) {
    const auto seen = point();
    const auto towards_sun = mica::normalized(mica::vector3<float>{-0.4F, 0.1F, 1});
    const auto sun = mica::respond(mica::sun_light{towards_sun, {20, 18, 15}, 0.1F}, seen,
                                   mica::ggx<float>{material().roughness, material().roughness}, material().f0);
    const std::array<mica::light_class<float>, 1> classes{{{sun.smooth, sun.probability}}};
    const mica::glint_kernel<mica::quantile_binomial<4>> kernel;
    return {mica::luminance(kernel(seen, material(), classes, sun.half_vector, seed).glint),
            mica::luminance(sun.smooth)};
}

} // namespace surface
