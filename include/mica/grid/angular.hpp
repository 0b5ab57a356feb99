// mica/grid/angular.hpp: the grid of half vectors, for lights from one direction: a facet that flashes under one half
// vector does not under another that is more than its own spread away.
#pragma once

#include "simplex.hpp"

namespace mica {

/// A half vector as the angular grid sees it: tangent and bitangent component over R, the facets' own roughness, the
/// angular size of one facet's flash.
template <real_number Real>
struct half_vector_point {
    Real x; ///< along the tangent
    Real y; ///< along the bitangent
};

/// A cell of the angular grid around a half vector.
template <real_number Real>
struct angular_vertex {
    index_of<Real> seed; ///< equal for every pixel that sees the cell
    Real weight;         ///< bilinear, >= 0; the four sum to 1
};

/// Finds the four cells around a half vector in the angular grid of the surface vertex with this seed, which is shifted
/// by the bits of the seed, so that the cells of neighbouring vertices do not change together (DB23 Sec. 6.3). Signed
/// coordinates: with |h.xy|, as published, glints are mirrored across tangent and bitangent.
template <real_number Real>
MICA_HOST_DEVICE constexpr void find_enclosing_square(half_vector_point<Real> half_vector, index_of<Real> seed,
                                                      std::array<angular_vertex<Real>, 4>& cells) {
    using Index = index_of<Real>;
    using Integer = integer_of<Real>;
    const auto offset = [](Index sixteen_bits) {
        return convert<Real>(convert<Integer>(sixteen_bits)) * Real(0x1p-16F);
    };
    const Real x = clamp(half_vector.x, Real(-largest_cell), Real(largest_cell)) + offset(seed >> 16);
    const Real y = clamp(half_vector.y, Real(-largest_cell), Real(largest_cell)) + offset(seed & Index(0xffffU));
    const auto [whole_x, fx] = detail::split_at_integer(x);
    const auto [whole_y, fy] = detail::split_at_integer(y);
    const Index i = detail::hashable<Real>(whole_x), j = detail::hashable<Real>(whole_y);
    const Real gx = Real(1) - fx, gy = Real(1) - fy;
    // Multiples of the two fractions that lie most evenly in the square (the plastic number's, after Roberts): cells near
    // each other have numbers far apart. Whoever draws hashes them.
    const Index step_x(0xc13fa9a9U), step_y(0x91e10da5U);
    const Index cell = seed + i * step_x + j * step_y;
    cells[0] = {cell, gx * gy};
    cells[1] = {cell + step_x, fx * gy};
    cells[2] = {cell + step_y, gx * fy};
    cells[3] = {cell + step_x + step_y, fx * fy};
}

} // namespace mica
