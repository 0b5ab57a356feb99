// mica/shade/glint_kernel.hpp: from lights to the radiance of a pixel whose facets are counted.
//
//     radiance = sum over the classes of light of  S_k M_k / (N p_k),   M ~ Multinomial(N, p)
//
// N facets in the pixel, each flashes towards class k with probability p_k, and infinitely many of them would give S_k. A
// class is one light, or one level of an environment: all that a pixel sees is counted by one multinomial. What is missing
// to sum p = 1 flashes nowhere. The mean is the smooth radiance sum S_k, whatever the law and the effects.
// Sources: DB23 Eq. 6 to 9 (one light), KK25 Eq. 15 to 17 (an environment); several lights at once are ours.
#pragma once

#include <array>
#include <cmath>

#include "effects.hpp"
#include "shading_point.hpp"

namespace mica {

/// One class of light in a pixel.
template <real_number Real>
struct light_class {
    rgb<Real> smooth; ///< its radiance towards the eye in the limit of infinitely many facets
    Real probability; ///< that a facet flashes towards it, in [0, 1]
};

/// A glittering surface.
struct glint_material {
    float roughness = 0.1F;                          ///< GGX alpha, in [0, 1]
    float log_density = 13;                          ///< natural logarithm of the facets per unit uv^2
    rgb<float> f0 = {0.95F, 0.93F, 0.88F};           ///< reflectance at normal incidence
    float footprint_scale = default_footprint_scale; ///< size of a glint, in pixels
};

namespace detail {

/// The facets in a pixel, at most 1e30.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real facets_in(const footprint<Real>& pixel, const glint_material& material) {
    return minimum(mica::exp(Real(material.log_density)) * pixel.area, Real(1e30F));
}

/// The luminance of every class as a share of that of all; 0 where all are black.
template <real_number Real, std::size_t K>
MICA_HOST_DEVICE constexpr std::array<Real, K> luminance_shares(const std::array<light_class<Real>, K>& classes) {
    std::array<Real, K> share;
    Real total = Real(0);
    for (std::size_t k = 0; k < K; ++k) total = total + (share[k] = luminance(classes[k].smooth));
    const auto lit = total > Real(0);
    for (auto& one : share) one = select(lit, one / select(lit, total, Real(1)), Real(0));
    return share;
}

/// Variance of the counted radiance over the square of its mean, by luminance: sum s_k^2 / (N p_k) - (sum s_k)^2 / N, s_k
/// the shares of the classes. 0 where all are black.
template <real_number Real, std::size_t K>
MICA_HOST_DEVICE constexpr Real relative_variance(const std::array<light_class<Real>, K>& classes, Real trials) {
    const auto share = luminance_shares(classes);
    Real squares = Real(0), total = Real(0);
    for (std::size_t k = 0; k < K; ++k) {
        squares = squares + share[k] * (share[k] / maximum(classes[k].probability, Real(1e-30F)));
        total = total + share[k];
    }
    return maximum(squares - total, Real(0)) / maximum(trials, Real(1e-6F));
}

} // namespace detail

/// Radiance of pixels, with the glints of a law, counted on the grids by an interpolation, and with the effects of
/// effects<...>. As an object it holds their parameters; kernels of the same types differ in nothing else.
template <class Law, class Interpolation = blended_variates, class Effects = effects<>>
struct glint_kernel {
    [[no_unique_address]] Interpolation interpolation{}; ///< the interpolation, with its parameters
    [[no_unique_address]] Effects effect{};              ///< the effects, with their parameters

    static constexpr bool counts_nothing = std::is_same_v<Law, no_glints>;        ///< whether it is the smooth surface
    static constexpr bool has_half_vectors = Effects::template has<angular_grid>; ///< whether it needs half_vector
    static constexpr bool has_one_grid = Effects::template has<one_grid>; ///< whether it evaluates one grid of four
    static_assert(!has_one_grid || std::is_same_v<Interpolation, interpolated_counts>,
                  "one_grid is for interpolated_counts: blended variates have no other grids to leave out");

    /// Binomials that a pixel evaluates when `categories` of its K classes need one each: K - 1 if their probabilities sum
    /// to 1, else K.
    static constexpr std::size_t binomials(std::size_t categories) {
        using Vertices = grid_vertices<float, has_half_vectors ? 4 : 0, has_one_grid ? 1 : 4>;
        return counts_nothing ? 0 : categories * Interpolation::template evaluations<Vertices>;
    }

    /// `half_vector` is needed with angular_grid alone: of the light, or half of wo, in the surface's frame
    /// (shading_point::local). `seed` picks the realisation. Probabilities may sum to more than 1, where lights cover each
    /// other: they are scaled to 1 then, and the mean stays what it is.
    template <real_number Real, std::size_t K>
    MICA_HOST_DEVICE constexpr glint_radiance<Real>
    operator()(const shading_point<Real>& point, const glint_material& material,
               std::array<light_class<Real>, K> classes, vector3<Real> half_vector, std::uint32_t seed) const {
        rgb<Real> smooth{Real(0), Real(0), Real(0)};
        for (const auto& one : classes) smooth = smooth + one.smooth;
        if constexpr (counts_nothing) {
            return {smooth, smooth};
        } else {
            const auto pixel = make_footprint(point.derivatives);
            const Real trials = detail::facets_in(pixel, material);
            limit_to_one(classes);
            const Real counted = part_counted(classes, trials);
            if (!any(counted > Real(0))) return {smooth, smooth};
            const auto vertices = vertices_of(point, pixel, trials, half_vector, material, seed);
            const rgb<Real> glint = counted_radiance(vertices, trials, classes);
            if constexpr (!Effects::template has<smooth_where_dense>) return {glint, smooth};
            return {smooth + counted * (glint + Real(-1) * smooth), smooth};
        }
    }

  private:
    template <real_number Real, std::size_t K>
    MICA_HOST_DEVICE static constexpr void limit_to_one(std::array<light_class<Real>, K>& classes) {
        Real total = Real(0);
        for (const auto& one : classes) total = total + one.probability;
        const Real factor = Real(1) / maximum(total, Real(1));
        for (auto& one : classes) one.probability = one.probability * factor;
    }

    /// How much of the counted radiance is to be seen: 1, and less where the surface is dense, down to 0.
    template <real_number Real, std::size_t K>
    MICA_HOST_DEVICE constexpr Real part_counted(const std::array<light_class<Real>, K>& classes, Real trials) const {
        const Real some = select(trials > Real(0), Real(1), Real(0));
        if constexpr (Effects::template has<smooth_where_dense>) {
            const Real deviation = mica::sqrt(detail::relative_variance(classes, trials));
            const Real tolerance = Real(maximum(effect.tolerance, 1e-9F));
            return some * clamp(deviation / tolerance - Real(1), Real(0), Real(1));
        }
        return some;
    }

    template <real_number Real>
    MICA_HOST_DEVICE constexpr auto vertices_of(const shading_point<Real>& point, const footprint<Real>& pixel,
                                                Real trials, vector3<Real> half_vector, const glint_material& material,
                                                std::uint32_t seed) const {
        const Real scale = Real(material.footprint_scale);
        auto vertices = [&] {
            if constexpr (has_half_vectors) {
                const Real per_cell = Real(1 / effect.facet_roughness);
                const half_vector_point<Real> cell{half_vector.x * per_cell, half_vector.y * per_cell};
                if constexpr (has_one_grid)
                    return make_one_grid_vertices(pixel, point.uv, cell, trials, seed, choice(point), scale);
                else
                    return make_grid_vertices(pixel, point.uv, cell, trials, seed, scale);
            } else if constexpr (has_one_grid) {
                return make_one_grid_vertices(pixel, point.uv, trials, seed, choice(point), scale);
            } else {
                return make_grid_vertices(pixel, point.uv, trials, seed, scale);
            }
        }();
        if constexpr (Effects::template has<varied_density>)
            return with_varied_density(vertices, Real(effect.deviation));
        else
            return vertices;
    }

    /// A uniform for one_grid, of the pixel and the frame.
    template <real_number Real>
    MICA_HOST_DEVICE constexpr Real choice(const shading_point<Real>& point) const {
        using Index = index_of<Real>;
        const auto bits = [](Real x) { return convert<Index>(reinterpret<bits_of<Real>>(x)); };
        const Index place = mix(mix(bits(point.uv.u)) ^ bits(point.uv.v));
        return uniform_stream<Real>(place, Index(effect.frame))();
    }

    /// How many equal flashes would vary as much as those that were counted: (sum b_k M_k)^2 / sum b_k^2 M_k, b_k the
    /// brightness of a flash. 0 in a dark pixel.
    template <real_number Real, std::size_t K>
    MICA_HOST_DEVICE static constexpr Real flashes_seen(const std::array<Real, K>& counts,
                                                        const std::array<light_class<Real>, K>& classes) {
        const auto share = detail::luminance_shares(classes);
        Real sum = Real(0), squares = Real(0);
        for (std::size_t k = 0; k < K; ++k) {
            const Real brightness = share[k] / maximum(classes[k].probability, Real(1e-18F));
            sum = sum + brightness * counts[k];
            squares = squares + brightness * (brightness * counts[k]);
        }
        const auto some = squares > Real(0);
        return select(some, sum * (sum / select(some, squares, Real(1))), Real(0));
    }

    template <class Vertices, std::size_t K>
    MICA_HOST_DEVICE constexpr rgb<typename Vertices::number>
    counted_radiance(const Vertices& vertices, typename Vertices::number trials,
                     const std::array<light_class<typename Vertices::number>, K>& classes) const {
        using Real = typename Vertices::number;
        std::array<Real, K> probabilities;
        for (std::size_t k = 0; k < K; ++k) probabilities[k] = classes[k].probability;
        const auto counts = distributed_multinomial<K, Law, Interpolation>{interpolation}(vertices, probabilities);
        rgb<Real> glint{Real(0), Real(0), Real(0)};
        for (std::size_t k = 0; k < K; ++k) {
            // Too few to be counted, in binary32, are at their mean.
            const Real expected = trials * probabilities[k];
            const auto counted = expected >= Real(1e-30F);
            const Real ratio = select(counted, counts[k] / select(counted, expected, Real(1)), Real(1));
            glint = glint + ratio * classes[k].smooth;
        }
        if constexpr (Effects::template has<tinted_glints>)
            glint = detail::tint_of(vertices, flashes_seen(counts, classes), Real(effect.strength)) * glint;
        return glint;
    }
};

} // namespace mica
