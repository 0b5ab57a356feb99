// mica/shade/environment_glints.hpp: glints under an environment.
//
//     radiance = L_o sum_k L_k M_k / (N sum_k L_k p_k),   p_k = (E_D / D_H) w_k,   M ~ Multinomial(N, p)
//
// Source: KK25 Sec. 4 and 5, Eq. 15, 17, 21. L_o is the smooth image-based radiance (split sum) in the mirror
// direction, w_k the prefiltered indicators of the levels L_k, N the facets in the pixel. What is missing to sum p = 1
// are facets that reflect nothing. They and level 1, whose radiance is 0 as published, are what the multinomial of the
// other K - 1 levels leaves over, so K levels cost K - 1 binomials.
#pragma once

#include <array>

#include "../grid/distributed.hpp"
#include "microfacet.hpp"
#include "prefilter.hpp"
#include "shading_point.hpp"

namespace mica {

/// Glint radiance over smooth radiance in one pixel, >= 0, with mean 1.
///
/// trials: the facets in the pixel. levels: L_1 = 0 .. L_K. indicators: w_1 .. w_K of the pixel's lobe. visible_fraction:
/// E_D / D_H. 1, the mean, where there is nothing to count: a degenerate footprint, black all around, or so few facets
/// towards so little light that their expected flashes are below 1e-30.
template <class Law, class Interpolation = blended_variates, std::size_t K, class Vertices>
MICA_HOST_DEVICE typename Vertices::number glint_ratio(const Vertices& vertices, typename Vertices::number trials,
                                                       const std::array<typename Vertices::number, K>& levels,
                                                       const std::array<typename Vertices::number, K>& indicators,
                                                       typename Vertices::number visible_fraction,
                                                       Interpolation interpolation = {}) {
    using Real = typename Vertices::number;
    const auto lit = levels[K - 1] > Real(0);
    const Real brightest = select(lit, levels[K - 1], Real(1));
    std::array<Real, K - 1> probabilities;
    Real expected = Real(0); // of the radiance that one facet reflects, relative to the top level
    for (std::size_t k = 1; k < K; ++k) {
        probabilities[k - 1] = visible_fraction * indicators[k];
        expected = expected + levels[k] / brightest * probabilities[k - 1];
    }
    const Real expected_flashes = trials * expected;
    const auto counted = lit && expected_flashes >= Real(1e-30F);
    if (!any(counted)) return Real(1);
    const auto counts = distributed_multinomial<K - 1, Law, Interpolation>{interpolation}(vertices, probabilities);
    Real reflected = Real(0);
    for (std::size_t k = 1; k < K; ++k) reflected = reflected + levels[k] / brightest * counts[k - 1];
    return select(counted, reflected / select(counted, expected_flashes, Real(1)), Real(1));
}

/// A glittering surface.
struct glint_material {
    float roughness = 0.1F;                          ///< GGX alpha, in [0, 1]
    float log_density = 13;                          ///< natural logarithm of the facets per unit uv^2
    rgb<float> f0 = {0.95F, 0.93F, 0.88F};           ///< reflectance at normal incidence
    float footprint_scale = default_footprint_scale; ///< size of a glint, in pixels
};

/// The radiance of a pixel. `seed` picks the realisation.
template <class Law, class Interpolation = blended_variates, std::size_t K>
glint_radiance<float> shade(const shading_point<float>& point, const glint_material& material,
                            const prefiltered_environment<K>& environment, const microfacet_table& table,
                            std::uint32_t seed, Interpolation interpolation = {}) {
    const float n_dot_v = dot(point.normal, point.wo);
    if (!(n_dot_v > 0)) return {{0, 0, 0}, {0, 0, 0}};
    const auto lobe = environment(reflected(point.wo, point.normal), material.roughness);
    const auto albedo = table.albedo(n_dot_v, material.roughness);
    const rgb<float> reflectance = albedo.scale * material.f0 + rgb<float>{albedo.bias, albedo.bias, albedo.bias};
    const rgb<float> smooth = reflectance * lobe.radiance;

    const auto pixel = make_footprint(point.derivatives);
    const float trials = minimum(std::exp(material.log_density) * pixel.area, 1e30F);
    const auto vertices = make_grid_vertices(pixel, point.uv, trials, seed, material.footprint_scale);
    const float ratio = glint_ratio<Law>(vertices, trials, environment.levels().radiance(), lobe.indicator,
                                         table.visible_fraction(n_dot_v, material.roughness), interpolation);
    return {ratio * smooth, smooth};
}

} // namespace mica
