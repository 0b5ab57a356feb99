// mica/grid/simplex.hpp: cells of a grid, and the triangle of them around a point.
#pragma once

#include <array>
#include <cstdint>

#include "../random/hash.hpp"
#include "tetrahedron.hpp"

namespace mica {

/// A point in texture space, or in the coordinates of a grid.
template <real_number Real>
struct uv_point {
    Real u, v; ///< the coordinates
};

/// uv in the coordinates of a grid, where its cells are unit squares: turned so that the long side becomes +v, divided
/// by 2^level, v also by the ratio (DB23 Eq. 12).
template <real_number Real>
MICA_HOST_DEVICE constexpr uv_point<Real> grid_coordinates(uv_point<Real> uv, const tetrahedron_vertex<Real>& grid) {
    using Integer = integer_of<Real>;
    const auto isotropic = grid.log2_ratio < Integer(1);
    const Real step = power_of_two<Real>(select(isotropic, Integer(0), Integer(-2) - grid.log2_ratio));
    const auto [sine, cosine] = half_turns(convert<Real>(grid.orientation) * step);
    const Real across = uv.u * cosine + uv.v * sine;
    const Real along = uv.v * cosine - uv.u * sine;
    return {across * power_of_two<Real>(-grid.level), along * power_of_two<Real>(-grid.level - grid.log2_ratio)};
}

/// A vertex of the simplex grid and its weight at a point.
template <real_number Real>
struct simplex_vertex {
    integer_of<Real> i, j; ///< row and column
    Real weight;           ///< barycentric, >= 0; the three sum to 1
};

/// Cells are numbered -2^20 .. 2^20, within which floats are a sixteenth of a cell apart; everything farther out (and NaN)
/// lies in the outermost one.
inline constexpr float largest_cell = 0x1p20F;

namespace detail {
/// The square lattice skewed to equilateral triangles (Perlin 2001, DB23 Sec. 6.2).
template <real_number Real>
MICA_HOST_DEVICE constexpr uv_point<Real> skewed(uv_point<Real> point) {
    constexpr auto one_over_sqrt3 = scalar_of<Real>(0.57735026918962576451);
    return {point.u - point.v * Real(one_over_sqrt3), point.v * Real(2 * one_over_sqrt3)};
}
} // namespace detail

/// The triangle around a point: the square lattice skewed to equilateral triangles, (u - v/sqrt3, 2v/sqrt3). The first two
/// share a row, the first and the third a column.
template <real_number Real>
MICA_HOST_DEVICE constexpr std::array<simplex_vertex<Real>, 3> enclosing_simplex(uv_point<Real> point) {
    using Integer = integer_of<Real>;
    const auto at = detail::skewed(point);
    const Real x = clamp(at.u, Real(-largest_cell), Real(largest_cell));
    const Real y = clamp(at.v, Real(-largest_cell), Real(largest_cell));
    const auto [i, fx] = detail::split_at_integer(x);
    const auto [j, fy] = detail::split_at_integer(y);
    const Real rest = Real(1) - fx - fy;
    const auto lower = rest > Real(0); // the triangle at (i, j), not that at (i + 1, j + 1)
    const Integer up = select(lower, Integer(0), Integer(1)), other = Integer(1) - up;
    const Real corner = select(lower, Real(0), Real(1));
    return {{{i + up, j + up, mica::abs(rest)},
             {i + up, j + other, mica::abs(corner - fy)},
             {i + other, j + up, mica::abs(corner - fx)}}};
}

namespace detail {
/// An integer as the hash takes it, modulo 2^32.
template <real_number Real>
MICA_HOST_DEVICE constexpr index_of<Real> hashable(integer_of<Real> value) {
    return convert<index_of<Real>>(value);
}
} // namespace detail

/// The seed of a grid: equal for every pixel that uses it. Level, ratio and orientation fit into 32 bits side by side, so
/// that grids of one seed have distinct seeds (ratios up to 2^17, which is one ring beyond the largest resolved).
template <real_number Real>
MICA_HOST_DEVICE constexpr index_of<Real> grid_seed(std::uint32_t seed, const tetrahedron_vertex<Real>& grid) {
    using Index = index_of<Real>;
    const Index level = detail::hashable<Real>(grid.level) & Index(0x7fU);
    const Index ratio = detail::hashable<Real>(grid.log2_ratio);
    return mix(Index(hash(seed)) ^ (detail::hashable<Real>(grid.orientation) ^ (ratio << 20) ^ (level << 25)));
}

/// The seed of a cell is the exclusive or of the hashes of its row and of its column in the grid; whoever draws with it
/// hashes it once more. Chained instead of apart, two columns whose hashes agree in their upper bits would share all
/// their seeds.
template <hash_index Index>
MICA_HOST_DEVICE constexpr Index row_hash(Index grid, std::type_identity_t<Index> i) {
    return mix(grid ^ i);
}
/// The hash of a column.
template <hash_index Index>
MICA_HOST_DEVICE constexpr Index column_hash(Index grid, std::type_identity_t<Index> j) {
    return mix(Index(grid * Index(golden_increment)) ^ j);
}
/// The seed of the cell in row i and column j.
template <hash_index Index>
MICA_HOST_DEVICE constexpr Index cell_seed(Index grid, std::type_identity_t<Index> i, std::type_identity_t<Index> j) {
    return row_hash(grid, i) ^ column_hash(grid, j);
}
/// The same for rows and columns with a sign.
MICA_HOST_DEVICE constexpr std::uint32_t cell_seed(std::uint32_t grid, std::int32_t i, std::int32_t j) {
    return cell_seed<std::uint32_t>(grid, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
}

} // namespace mica
