// mica/grid/distributed.hpp: binomial and multinomial counts that stay where they are on a surface.
//
// The randomness belongs to the vertices around a pixel (grid_vertices.hpp), so neighbouring pixels and frames agree. Two
// ways to make one count of it:
//
//     blended_variates      (the default)  count = law(N, p; the uniforms blended of all vertices)
//     interpolated_counts   (published)    count = sum over the vertices of v law(N_i, p; seed)
//
// Blended variates give every pixel exactly the law, at one evaluation of it; real N is dithered by a blended uniform, too.
// Interpolated counts have the mean of the law, and of its variance sum v^2: 1/2 on average over the triangles, 2/9 with
// half vectors; they take 12 or 48 evaluations (DB23 Eq. 10 and 14, KK25 Eq. 10).
//
// A law of integers switches glints on and off between neighbouring pixels, as facets with hard edges do. smooth laws and
// softened_variates change them continuously.
#pragma once

#include "../law/multinomial.hpp"
#include "../random/uniform_stream.hpp"
#include "blended_uniforms.hpp"

namespace mica {

/// The lights of a pixel are numbered up to this. The streams beyond are those of the pixel itself: its density, its tints.
inline constexpr std::uint32_t largest_light = 0xfffffeffU;

/// One evaluation, with the blended randomness of the vertices.
struct blended_variates {
    /// draw(trials, xi) with the blended uniforms of light number `light`.
    template <class Vertices, class Draw>
    MICA_HOST_DEVICE constexpr auto operator()(const Vertices& vertices, std::uint32_t light, const Draw& draw) const {
        return draw(vertices.trials, blended_uniforms(vertices, light));
    }
    /// How often a law is evaluated for one count.
    template <class Vertices>
    static constexpr std::size_t evaluations = 1;
};

/// One evaluation per seed, interpolated.
struct interpolated_counts {
    /// The weighted sum of draw(trials, xi) of all seeds, for light number `light`.
    template <class Vertices, class Draw>
    MICA_HOST_DEVICE constexpr auto operator()(const Vertices& vertices, std::uint32_t light, const Draw& draw) const {
        using Real = typename Vertices::number;
        using Counts = decltype(draw(vertices.trials, std::declval<uniform_stream<Real>>()));
        Counts sum{};
        const auto add = [&](Real trials, index_of<Real> seed, Real weight) {
            const Counts counts = draw(trials, uniform_stream<Real>(seed, index_of<Real>(light)));
            for (std::size_t k = 0; k < sum.size(); ++k) sum[k] = sum[k] + weight * counts[k];
        };
        for (const auto& grid : vertices.grids)
            for (const auto& vertex : grid.vertices) {
                if constexpr (std::tuple_size_v<decltype(vertex.cells)> == 0)
                    add(vertex.trials, vertex.seed, vertex.weight);
                else
                    for (const auto& cell : vertex.cells) add(vertex.trials, cell.seed, vertex.weight * cell.weight);
            }
        return sum;
    }
    /// How often a law is evaluated for one count.
    template <class Vertices>
    static constexpr std::size_t evaluations = Vertices::seeds;
};

/// The expected count given part of the blended randomness: real counts without jumps, of the same mean. For laws that have
/// a function `softened`, quantile_binomial among them, which says how much of the variance is left.
struct softened_variates {
    float softness = 0.1F; ///< in [0, 1), the standard deviation of what is averaged over; 0 is blended_variates

    /// draw(trials, xi) with xi the variates and the softness.
    template <class Vertices, class Draw>
    MICA_HOST_DEVICE constexpr auto operator()(const Vertices& vertices, std::uint32_t light, const Draw& draw) const {
        using Real = typename Vertices::number;
        if (!(softness > 0)) return blended_variates{}(vertices, light, draw);
        return draw(vertices.trials, known_part<Real, blended_uniforms<const Vertices&>>{
                                         blended_uniforms(vertices, light), Real(softness)});
    }
    /// How often a law is evaluated for one count.
    template <class Vertices>
    static constexpr std::size_t evaluations = 1;

  private:
    /// A source of which a law with `softened` takes the variates and the softness.
    template <class Real, class Uniforms>
    struct known_part {
        Uniforms uniforms;
        Real softness;

        MICA_HOST_DEVICE constexpr Real normal() { return uniforms.normal(); }
    };
};

namespace detail {

/// What is counted where the grids do not resolve the pixel. Arguments outside the domain as laws take them.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real mean_successes(Real trials, Real probability) {
    const auto [n, p] = in_domain(trials, probability);
    return n * p;
}

/// exp(s z - s^2 / 2) with z limited to 4: of mean 1 for z standard normal.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real lognormal(Real z, Real s) {
    return mica::exp(s * (clamp(z, Real(-4), Real(4)) - Real(0.5) * s));
}

} // namespace detail

/// The number of successes in a pixel, with mean N p; N and p as in binomial_law.hpp. `light`, at most largest_light, tells
/// the lights of a pixel apart, whose counts are independent. Where the grids do not resolve the pixel the count is its mean.
template <class Law, class Interpolation = blended_variates>
struct distributed_binomial {
    [[no_unique_address]] Interpolation interpolation{}; ///< the interpolation, with its parameters

    /// The count of one pixel.
    template <real_number Real, std::size_t HalfVectors, std::size_t Grids>
        requires(binomial_law<Law, Real>)
    MICA_HOST_DEVICE constexpr Real operator()(const grid_vertices<Real, HalfVectors, Grids>& vertices,
                                               std::type_identity_t<Real> probability, std::uint32_t light = 0) const {
        MICA_ASSERT(light <= largest_light);
        const auto drawn = interpolation(vertices, light, [&](Real trials, auto&& xi) {
            return std::array<Real, 1>{detail::drawn_counts<Law>(trials, probability, xi).successes};
        });
        return select(vertices.resolved, drawn[0], detail::mean_successes(vertices.trials, probability));
    }
};

/// The counts of K categories in a pixel, with means N p_k. Probabilities as for multinomial.
template <std::size_t K, class Law, class Interpolation = blended_variates>
struct distributed_multinomial {
    [[no_unique_address]] Interpolation interpolation{}; ///< the interpolation, with its parameters

    /// The counts of one pixel.
    template <real_number Real, std::size_t HalfVectors, std::size_t Grids>
        requires(binomial_law<Law, Real>)
    MICA_HOST_DEVICE constexpr std::array<Real, K> operator()(const grid_vertices<Real, HalfVectors, Grids>& vertices,
                                                              const std::array<Real, K>& probabilities,
                                                              std::uint32_t light = 0) const {
        MICA_ASSERT(light <= largest_light);
        auto drawn = interpolation(
            vertices, light, [&](Real trials, auto&& xi) { return multinomial<K, Law>{}(trials, probabilities, xi); });
        for (std::size_t k = 0; k < K; ++k)
            drawn[k] = select(vertices.resolved, drawn[k], detail::mean_successes(vertices.trials, probabilities[k]));
        return drawn;
    }
};

/// The pixel with a density of facets that varies from place to place: trials times exp(s z - s^2 / 2), z standard normal,
/// of which `deviation` s is the standard deviation of the logarithm, in [0, 1] (outside as the nearer end, NaN as 0). The
/// mean is the same. z is limited to 4, which takes less than 0.2 % off the mean. Where the grids do not resolve the pixel
/// its trials stay what they are. (DB23 Sec. 6.4 varies the density of every vertex; blended variates see the blend of the
/// vertices' z.)
template <real_number Real, std::size_t HalfVectors, std::size_t Grids>
MICA_HOST_DEVICE constexpr grid_vertices<Real, HalfVectors, Grids>
with_varied_density(grid_vertices<Real, HalfVectors, Grids> vertices, std::type_identity_t<Real> deviation) {
    constexpr std::uint32_t stream = 0xffffffffU;
    static_assert(stream > largest_light);
    const Real s = clamp(deviation, Real(0), Real(1));
    const auto factor = [s, resolved = vertices.resolved](Real z) {
        return select(resolved, detail::lognormal(z, s), Real(1));
    };
    grid_vertices<Real, 0, Grids> surface{vertices.trials, vertices.resolved, {}};
    for (std::size_t g = 0; g < Grids; ++g) {
        surface.grids[g].variate_weight = vertices.grids[g].variate_weight;
        for (std::size_t v = 0; v < 3; ++v) {
            auto& vertex = vertices.grids[g].vertices[v];
            // With half vectors variate_weight is not that of the vertices alone, but weight is, in either case.
            surface.grids[g].vertices[v] = {vertex.seed, vertex.trials, vertex.weight, vertex.weight, {}};
            const auto bits = mix(index_of<Real>(mix(stream)) ^ vertex.seed);
            vertex.trials = vertex.trials * factor(normal_pair_from_bits<Real>(bits).first);
        }
    }
    vertices.trials = vertices.trials * factor(blended_uniforms(surface, stream).normal());
    return vertices;
}

} // namespace mica
