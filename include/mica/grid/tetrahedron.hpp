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
#include <cmath>
#include <cstdint>

#include "../numeric/elementary.hpp"
#include "footprint.hpp"

namespace mica {

/// One grid of the lattice, and its part in a pixel.
template <scalar_number Real>
struct tetrahedron_vertex {
    int level;       ///< l: cells are 2^l wide, in uv
    int log2_ratio;  ///< cells are 2^log2_ratio times as long as wide
    int orientation; ///< index of the orientation of the long side, 0 .. orientations(log2_ratio) - 1
    Real weight;     ///< barycentric weight, >= 0; the four sum to 1
    Real share;      ///< part of the pixel's trials, w a / sum w a with the cell areas a; the four sum to 1
};

/// Orientations per half turn of the grids of a ratio.
MICA_HOST_DEVICE constexpr int orientations(int log2_ratio) { return log2_ratio == 0 ? 1 : 4 << log2_ratio; }

/// Levels stop here: cells 2^-40 .. 2^40 uv wide. Nothing smaller can be told apart in float texture coordinates.
inline constexpr int smallest_level = -40;
inline constexpr int largest_level = 40;

namespace detail {

/// A vertex of the lattice's base: a grid without its level.
struct ring_vertex {
    int log2_ratio;
    int orientation;
};

template <scalar_number Real>
struct prism {
    ring_vertex vertex[3]; ///< in the order in which they move to the next level
    Real weight[3];        ///< barycentric in the triangle
};

/// The triangle of the base that holds (ratio, orientation).
template <scalar_number Real>
MICA_HOST_DEVICE prism<Real> enclosing_prism(Real ratio, Real orientation) {
    const int ring = std::ilogb(ratio);
    const Real lower_ratio = std::scalbn(Real(1), ring);
    const Real rho = clamp((ratio - lower_ratio) / lower_ratio, Real(0), Real(1));

    // The lower ring's orientations; in the centre, where it has one, those of the upper ring.
    const int count = orientations(ring == 0 ? 1 : ring);
    const Real position = orientation * static_cast<Real>(count);
    const int bin = minimum(static_cast<int>(position), count - 1);
    const int next = (bin + 1) % count;
    const Real t = clamp(position - static_cast<Real>(bin), Real(0), Real(1));

    if (ring == 0) {
        const ring_vertex a{1, bin}, b{0, 0}, c{1, next};
        return {{b, c, a}, {1 - rho, rho * t, rho * (1 - t)}};
    }
    const int upper_count = 2 * count;
    const ring_vertex b{ring, bin}, d{ring, next};
    const ring_vertex a{ring + 1, 2 * bin}, c{ring + 1, 2 * bin + 1}, e{ring + 1, (2 * bin + 2) % upper_count};
    if (2 * t < rho) return {{b, c, a}, {1 - rho, 2 * t, rho - 2 * t}};
    if (2 - 2 * t < rho) return {{d, e, c}, {1 - rho, rho - (2 - 2 * t), 2 - 2 * t}};
    const Real d_weight = maximum(Real(0), t - rho / 2);
    return {{d, b, c}, {d_weight, maximum(Real(0), 1 - rho - d_weight), rho}};
}

} // namespace detail

/// The four grids around a footprint.
///
/// scale S > 0: how large a glint is drawn, in pixels (1 aliases, 1.5 is the published default); it moves the level
/// only. A footprint of size 0 takes the smallest level.
template <scalar_number Real>
MICA_HOST_DEVICE std::array<tetrahedron_vertex<Real>, 4> enclosing_tetrahedron(const footprint<Real>& pixel,
                                                                               Real scale) {
    const detail::prism<Real> base = detail::enclosing_prism(pixel.ratio, pixel.orientation);

    const Real lambda =
        clamp(mica::log2(pixel.sigma_min) + mica::log2(scale), Real(smallest_level), Real(largest_level));
    const Real floor_lambda = mica::floor(lambda);
    const int level = static_cast<int>(floor_lambda);
    const Real fraction = lambda - floor_lambda;

    // The prism's vertices have moved up when the fraction has passed their weights, one after the other: of the
    // four vertices of the tetrahedron three are ends of the moved or unmoved edges, and one edge has both ends.
    const auto vertex = [&](int i, int up, Real weight) {
        return tetrahedron_vertex<Real>{level + up, base.vertex[i].log2_ratio, base.vertex[i].orientation,
                                        maximum(weight, Real(0)), 0};
    };
    const Real first = base.weight[0], second = base.weight[1], third = base.weight[2];
    std::array<tetrahedron_vertex<Real>, 4> result =
        fraction <= first ? std::array{vertex(0, 0, first - fraction), vertex(0, 1, fraction), vertex(1, 0, second),
                                       vertex(2, 0, third)}
        : fraction <= first + second ? std::array{vertex(0, 1, first), vertex(1, 0, second - (fraction - first)),
                                                  vertex(1, 1, fraction - first), vertex(2, 0, third)}
                                     : std::array{vertex(0, 1, first), vertex(1, 1, second), vertex(2, 0, 1 - fraction),
                                                  vertex(2, 1, fraction - (first + second))};

    // Cell areas r 4^l, in units of the smallest of them.
    Real total = 0;
    for (auto& v : result) {
        v.share = v.weight * std::scalbn(Real(1), v.log2_ratio - std::ilogb(pixel.ratio) + 2 * (v.level - level));
        total += v.share;
    }
    for (auto& v : result) v.share /= total;
    return result;
}

} // namespace mica
