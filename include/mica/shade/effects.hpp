// mica/shade/effects.hpp: what a scene may ask of its glints. Each effect is a type; a kernel is composed of them when it is
// compiled (glint_kernel.hpp), so what a scene leaves out costs nothing.
#pragma once

#include <type_traits>

#include "../grid/distributed.hpp"
#include "vector.hpp"

namespace mica {

/// Glints live and die with the angle between eye, light and surface: every vertex has cells of half vectors, 48 seeds
/// instead of 12. Under a light from one direction (DB23 Sec. 6.3) they are those of its half vector. Under an environment
/// or several lights, each facet has a half vector of its own, which moves half as far as the eye does: the cells are
/// those of wo / 2, and a glint lives while the eye moves by about 2 `facet_roughness` (radians). KK25 leaves the lifetime
/// of glints under an environment as future work.
struct angular_grid {
    float facet_roughness = 0.02F; ///< > 0; angular size of a facet's own reflection, in radians of the half vector
};

/// The density of facets varies from place to place: times exp(deviation z), mean kept (DB23 Sec. 6.4).
struct varied_density {
    float deviation = 0.5F; ///< of the density's logarithm, in [0, 1], outside as the nearer end
};

/// Every glint has a colour of its own: times exp(strength z - strength^2 / 2) in each band, mean 1, z of the vertices, so
/// that a glint keeps its colour while it is seen. Where a pixel shows n glints at once the strength is 1/sqrt(n) of it,
/// as the mean of n colours is.
struct tinted_glints {
    float strength = 0.5F; ///< standard deviation of a band's logarithm, in [0, 1]
};

/// Where the counted radiance deviates from the smooth one by less than `tolerance`, relative, nothing is counted: the
/// pixel is smooth. Up to twice the tolerance the glints fade in, so that nothing pops.
struct smooth_where_dense {
    float tolerance = 0.02F; ///< relative standard deviation of the radiance, >= 0
};

/// One of the four grids of a pixel, picked at random for every pixel and frame: a quarter of the evaluations of
/// interpolated_counts, of the same mean, for renderers that accumulate frames.
struct one_grid {
    std::uint32_t frame = 0; ///< number of the frame: another gives other choices
};

/// The effects of a kernel.
template <class... Effect>
struct effects : Effect... {
    /// Whether Other is one of them.
    template <class Other>
    static constexpr bool has = (std::is_same_v<Other, Effect> || ...);
};

/// A law in name only: nothing is counted, the kernel is that of the smooth surface.
struct no_glints {};

namespace detail {

inline constexpr std::uint32_t tint_stream = 0xfffffffeU;
static_assert(tint_stream > largest_light);

/// The colour of the glints of a pixel that shows `flashes` of them.
template <class Vertices>
MICA_HOST_DEVICE constexpr rgb<typename Vertices::number>
tint_of(const Vertices& vertices, typename Vertices::number flashes, typename Vertices::number strength) {
    using Real = typename Vertices::number;
    blended_uniforms xi(vertices, tint_stream);
    const Real first = xi.normal(), second = xi.normal();
    const Real s = strength * select(flashes > Real(1), inverse_sqrt(maximum(flashes, Real(1))), Real(1));
    // Three unit vectors a third of a turn apart: standard normal each, and their sum is 0, so grey is rare.
    constexpr float half = 0.5F, height = 0.866025404F;
    return {lognormal(first, s), lognormal(Real(height) * second - Real(half) * first, s),
            lognormal(Real(-height) * second - Real(half) * first, s)};
}

} // namespace detail

} // namespace mica
