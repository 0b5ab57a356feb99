// mica/grid/tetrahedron.hpp: the four grids that share a pixel.
//
// Grids exist for every level (cell width 2^l in uv), every ratio that is a power of two (cell r times as long) and
// for a number of orientations that grows with the ratio: 4r per half turn for r >= 2, one for r = 1, since a circle
// has no orientation. A footprint lies in a cell of this lattice with the coordinates
//
//     t    orientation, 0..1 between two neighbouring ones of the lower ring
//     rho  ratio, (r - r0) / r0, linear in r from ring r0 = 2^floor(log2 r) to ring 2 r0
//     L    level, the fraction of log2(sigma_min S)
//
// which is cut into tetrahedra: nine where r0 >= 2, three in the centre, r0 = 1. Its four vertices share the pixel.
// Source: DB23 Sec. 5.2, 6.1 and Fig. 7.
//
// Seen along L, the lower ring of a cell has vertices b (t=0) and d (t=1), the upper ring a (t=0), c (t=1/2) and
// e (t=1): three triangles abc, bcd, cde, or in the centre, where the lower ring is one point b, the one triangle abc.
// Each triangle is the base of a prism between two levels, and a prism is cut by the order in which its vertices move
// to the next level as L grows:
//
//     abc: b, c, a        bcd: d, b, c        cde: d, e, c        centre: b, c, a
//
// Lower ring before upper, later orientation before earlier: one order for all, so neighbouring prisms are cut alike
// along their common face, and no weight jumps.
#pragma once

#include <array>
#include <cstdint>

#include "footprint.hpp"

namespace mica {

/// One grid of the lattice, and its part in a pixel.
template <real_number Real>
struct tetrahedron_vertex {
    integer_of<Real> level;       ///< l: cells are 2^l wide, in uv
    integer_of<Real> log2_ratio;  ///< cells are 2^log2_ratio times as long as wide
    integer_of<Real> orientation; ///< index of that of the long side, 0 .. orientations(log2_ratio) - 1
    Real weight;                  ///< barycentric weight, >= 0; the four sum to 1
    Real share;                   ///< part of the pixel's trials, w a / sum w a with cell areas a; the four sum to 1
};

/// Orientations per half turn of the grids of a ratio.
MICA_HOST_DEVICE constexpr int orientations(int log2_ratio) { return log2_ratio == 0 ? 1 : 4 << log2_ratio; }

/// Levels stop here: cells 2^-40 .. 2^40 uv wide. Nothing smaller can be told apart in float texture coordinates.
inline constexpr int smallest_level = -40;
inline constexpr int largest_level = 40; ///< see smallest_level

namespace detail {

/// A vertex of the lattice's base: a grid without its level.
template <real_number Real>
struct ring_vertex {
    integer_of<Real> log2_ratio;
    integer_of<Real> orientation;
};

template <real_number Real>
MICA_HOST_DEVICE constexpr ring_vertex<Real> select_vertex(const mask_of<Real>& mask, const ring_vertex<Real>& if_true,
                                                           const ring_vertex<Real>& if_false) {
    return {select(mask, if_true.log2_ratio, if_false.log2_ratio),
            select(mask, if_true.orientation, if_false.orientation)};
}

template <real_number Real>
struct prism {
    ring_vertex<Real> vertex[3]; ///< in the order in which they move to the next level
    Real weight[3];              ///< barycentric in the triangle
};

/// The triangle of the base that holds (ratio, orientation).
template <real_number Real>
MICA_HOST_DEVICE constexpr prism<Real> enclosing_prism(Real ratio, Real orientation) {
    using Integer = integer_of<Real>;
    using Vertex = ring_vertex<Real>;
    const Integer ring = binary_exponent(ratio), next_ring = ring + Integer(1);
    const Real rho = clamp(ratio * power_of_two<Real>(-ring) - Real(1), Real(0), Real(1));

    // The lower ring's orientations; in the centre, where it has one, those of the upper ring.
    const auto centre = ring < Integer(1);
    const Real count = power_of_two<Real>(select(centre, Integer(3), ring + Integer(2)));
    const Real position = orientation * count;
    const Real bin_number = minimum(truncate(position), count - Real(1));
    const Integer bin = convert<Integer>(bin_number);
    const Integer next = select(bin_number < count - Real(1), bin + Integer(1), Integer(0));
    const Real t = clamp(position - bin_number, Real(0), Real(1));

    const Vertex b{ring, bin}, d{ring, next};
    const Vertex a{next_ring, bin + bin}, c{next_ring, bin + bin + Integer(1)}, e{next_ring, next + next};
    const Real low = Real(1) - rho;
    const Real twice = t + t, rest = Real(2) - twice;
    const auto left = twice < rho, right = rest < rho;
    const Real d_weight = maximum(Real(0), t - Real(0.5) * rho);
    const prism<Real> outer{{select_vertex<Real>(left, b, d),
                             select_vertex<Real>(left, c, select_vertex<Real>(right, e, b)),
                             select_vertex<Real>(left, a, c)},
                            {select(left || right, low, d_weight),
                             select(left, twice, select(right, rho - rest, maximum(Real(0), low - d_weight))),
                             select(left, rho - twice, select(right, rest, rho))}};
    const Vertex one{Integer(0), Integer(0)}, later{Integer(1), next}, earlier{Integer(1), bin};
    return {{select_vertex<Real>(centre, one, outer.vertex[0]), select_vertex<Real>(centre, later, outer.vertex[1]),
             select_vertex<Real>(centre, earlier, outer.vertex[2])},
            {select(centre, low, outer.weight[0]), select(centre, rho * t, outer.weight[1]),
             select(centre, rho * (Real(1) - t), outer.weight[2])}};
}

} // namespace detail

/// The level of a footprint, log2(sigma_min S) with its fraction, before it is limited.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real footprint_level(const footprint<Real>& pixel, Real scale) {
    return mica::log2(pixel.sigma_min) + mica::log2(scale);
}

/// The four grids around a footprint.
///
/// scale S > 0: how large a glint is drawn, in pixels (1 aliases, 1.5 is the published default); it moves the level
/// only. A footprint of size 0 takes the smallest level.
template <real_number Real>
MICA_HOST_DEVICE constexpr std::array<tetrahedron_vertex<Real>, 4> enclosing_tetrahedron(const footprint<Real>& pixel,
                                                                                         Real scale) {
    using Integer = integer_of<Real>;
    const detail::prism<Real> base = detail::enclosing_prism(pixel.ratio, pixel.orientation);

    const Real lambda = clamp(footprint_level(pixel, scale), Real(smallest_level), Real(largest_level));
    const Real floor_lambda = mica::floor(lambda);
    const Integer level = convert<Integer>(floor_lambda);
    const Real fraction = lambda - floor_lambda;

    // The prism's vertices have moved up when the fraction has passed their weights, one after the other: of the
    // four vertices of the tetrahedron three are ends of the moved or unmoved edges, and one edge has both ends.
    const Real first = base.weight[0], second = base.weight[1], third = base.weight[2];
    const auto none_moved = fraction <= first;
    const auto one_moved = fraction <= first + second;
    const auto vertex = [&](const mask_of<Real>& up, const detail::ring_vertex<Real>& at, Real weight) {
        return tetrahedron_vertex<Real>{level + select(up, Integer(1), Integer(0)), at.log2_ratio, at.orientation,
                                        maximum(weight, Real(0)), Real(0)};
    };
    using detail::select_vertex;
    const Real past_first = fraction - first, past_second = fraction - (first + second);
    std::array<tetrahedron_vertex<Real>, 4> result{
        vertex(!none_moved, base.vertex[0], select(none_moved, first - fraction, first)),
        vertex(none_moved || !one_moved, select_vertex<Real>(none_moved, base.vertex[0], base.vertex[1]),
               select(none_moved, fraction, select(one_moved, second - past_first, second))),
        vertex(!none_moved && one_moved, select_vertex<Real>(one_moved, base.vertex[1], base.vertex[2]),
               select(none_moved, second, select(one_moved, past_first, Real(1) - fraction))),
        vertex(!one_moved, base.vertex[2], select(one_moved, third, past_second))};

    // Cell areas r 4^l, in units of the smallest of them.
    const Integer smallest_ratio = binary_exponent(pixel.ratio);
    Real total = Real(0);
    for (auto& v : result) {
        const Integer up = v.level - level;
        v.share = v.weight * power_of_two<Real>(v.log2_ratio - smallest_ratio + up + up);
        total = total + v.share;
    }
    for (auto& v : result) v.share = v.share / total;
    return result;
}

} // namespace mica
