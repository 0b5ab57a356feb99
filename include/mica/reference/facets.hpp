// mica/reference/facets.hpp: facets that really exist, counted one by one. Slow on purpose, and shares nothing with grid/.
//
// The unit square of uv, repeated in both directions, holds facets with positions and slopes. A pixel sees those in an
// ellipse, the image of a disc in pixel space; a facet flashes where its slope lies close enough to that of the half vector.
// Not for devices; allocates. Not included by mica.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "../config.hpp"
#include "../numeric/number.hpp"

/// Slow truths that the rest is tested against.
namespace mica::reference {

/// One facet: its place in uv, and the slopes of its normal along u and v.
struct facet {
    double u, v;             ///< its place, in [0, 1)
    double slope_u, slope_v; ///< each standard normal over all facets
};

/// How facets lie on the surface.
enum class facet_positions {
    uniform, ///< independent: the number in a footprint is Poisson distributed (but for the finite whole)
    jittered ///< one in every cell of a square lattice: the number in a footprint hardly varies
};

/// The ellipse M d with d in a disc of `radius` pixels around a centre. M has the columns duv/dx and duv/dy, in uv per
/// pixel. A disc of radius 1/sqrt(pi) has the area of a pixel, |det M| in uv.
struct ellipse {
    double u, v;                            ///< the centre
    double du_dx, dv_dx, du_dy, dv_dy;      ///< the entries of M
    double radius = 0.56418958354775628695; ///< in pixels; 1/sqrt(pi), a pixel's area
};

/// Whether a facet's slope lies within `reach` of (slope_u, slope_v).
struct flash {
    double slope_u = 0, slope_v = 0; ///< of a facet that flashes with no reach at all
    double reach;                    ///< > 0

    /// Whether the facet flashes.
    bool operator()(const facet& f) const { return std::hypot(f.slope_u - slope_u, f.slope_v - slope_v) < reach; }

    /// The flash towards the mean slope 0 of which a facet has a given probability in [0, 1].
    static flash with_probability(double probability) { return {0, 0, std::sqrt(-2 * std::log1p(-probability))}; }
};

/// What a footprint holds.
struct facet_counts {
    std::size_t facets, flashes; ///< all, and those that flash
};

/// The facets of the unit square.
class facet_set {
  public:
    /// `per_side`^2 facets, with slopes that are standard normal along u and along v (a Beckmann distribution of roughness
    /// sqrt 2, in whose units `flash` counts).
    facet_set(std::size_t per_side, facet_positions positions, std::uint32_t seed)
        : per_side_(static_cast<std::ptrdiff_t>(per_side)), first_(per_side * per_side + 1, 0) {
        if (per_side < 1 || per_side > 16384) MICA_FAIL("per_side", per_side, "in 1..16384");
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> unit(0, 1);
        std::normal_distribution<double> slope;
        std::vector<facet> unsorted(per_side * per_side);
        for (std::size_t i = 0; i < unsorted.size(); ++i) {
            const double in_u = unit(random), in_v = unit(random);
            const double slope_u = slope(random), slope_v = slope(random);
            const bool jittered = positions == facet_positions::jittered;
            const auto side = static_cast<double>(per_side);
            const std::size_t column = i % per_side, row = i / per_side;
            unsorted[i] = {jittered ? (static_cast<double>(column) + in_u) / side : in_u,
                           jittered ? (static_cast<double>(row) + in_v) / side : in_v, slope_u, slope_v};
        }
        // By the square of the lattice in which they lie, so that a footprint finds its own.
        for (const auto& f : unsorted) ++first_[square_of(f) + 1];
        for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
        facets_.resize(unsorted.size());
        auto next = first_;
        for (const auto& f : unsorted) facets_[next[square_of(f)]++] = f;
    }

    /// Facets per unit of uv^2.
    double density() const { return static_cast<double>(facets_.size()); }

    /// Counts what an ellipse of any size, ratio and orientation holds; parts beyond the unit square see its repetitions. One
    /// of rank one, or with NaN or infinity in it, holds nothing. One that reaches beyond 2^20 fails: nobody would wait for it.
    template <class Flashes>
    facet_counts count(const ellipse& seen, const Flashes& flashes) const {
        const double determinant = seen.du_dx * seen.dv_dy - seen.du_dy * seen.dv_dx;
        facet_counts result{0, 0};
        const double half_u = seen.radius * std::hypot(seen.du_dx, seen.du_dy);
        const double half_v = seen.radius * std::hypot(seen.dv_dx, seen.dv_dy);
        const double farthest = (std::max)(std::abs(seen.u) + half_u, std::abs(seen.v) + half_v);
        if (!(std::abs(determinant) > 0) || !is_finite(half_u + half_v + std::abs(seen.u) + std::abs(seen.v)))
            return result;
        if (!(farthest <= 0x1p20)) MICA_FAIL("ellipse", farthest, "within 2^20 of the origin");
        const double squares = static_cast<double>(per_side_);
        const auto square = [squares](double x) { return static_cast<std::ptrdiff_t>(std::floor(x * squares)); };
        for (std::ptrdiff_t j = square(seen.v - half_v); j <= square(seen.v + half_v); ++j) {
            for (std::ptrdiff_t i = square(seen.u - half_u); i <= square(seen.u + half_u); ++i) {
                const auto index = static_cast<std::size_t>(wrapped(j) * per_side_ + wrapped(i));
                const double shift_u = std::floor(static_cast<double>(i) / squares);
                const double shift_v = std::floor(static_cast<double>(j) / squares);
                for (std::size_t k = first_[index]; k < first_[index + 1]; ++k) {
                    const double u = facets_[k].u + shift_u - seen.u, v = facets_[k].v + shift_v - seen.v;
                    const double x = (seen.dv_dy * u - seen.du_dy * v) / determinant;
                    const double y = (seen.du_dx * v - seen.dv_dx * u) / determinant;
                    if (x * x + y * y > seen.radius * seen.radius) continue;
                    ++result.facets;
                    result.flashes += flashes(facets_[k]);
                }
            }
        }
        return result;
    }

  private:
    std::ptrdiff_t wrapped(std::ptrdiff_t i) const { return ((i % per_side_) + per_side_) % per_side_; }

    std::size_t square_of(const facet& f) const {
        const auto at = [this](double x) {
            return (std::min)(static_cast<std::ptrdiff_t>(x * static_cast<double>(per_side_)), per_side_ - 1);
        };
        return static_cast<std::size_t>(at(f.v) * per_side_ + at(f.u));
    }

    std::ptrdiff_t per_side_;
    std::vector<facet> facets_;
    std::vector<std::size_t> first_; ///< of every square, in facets_; one more at the end
};

} // namespace mica::reference
