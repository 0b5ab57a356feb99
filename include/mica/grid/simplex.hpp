// mica/grid/simplex.hpp: cells of a grid, and the triangle of them around a point.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "../random/hash.hpp"
#include "tetrahedron.hpp"

namespace mica {

/// A point in texture space, or in the coordinates of a grid.
template <scalar_number Real>
struct uv_point {
    Real u, v;
};

/// uv in the coordinates of a grid, where its cells are unit squares: turned so that the long side becomes +v, divided
/// by 2^level, v also by the ratio (DB23 Eq. 12).
template <scalar_number Real>
MICA_HOST_DEVICE uv_point<Real> grid_coordinates(uv_point<Real> uv, const tetrahedron_vertex<Real>& grid) {
    constexpr Real pi = Real(3.14159265358979323846);
    const Real angle = pi * static_cast<Real>(grid.orientation) / static_cast<Real>(orientations(grid.log2_ratio));
    const Real sine = std::sin(angle), cosine = std::cos(angle);
    const Real across = uv.u * cosine + uv.v * sine;
    const Real along = uv.v * cosine - uv.u * sine;
    return {std::scalbn(across, -grid.level), std::scalbn(along, -grid.level - grid.log2_ratio)};
}

/// A vertex of the simplex grid and its weight at a point.
template <scalar_number Real>
struct simplex_vertex {
    std::int32_t i, j;
    Real weight; ///< barycentric, >= 0; the three sum to 1
};

/// Cells are numbered -2^30 .. 2^30; everything farther out (and NaN) lies in the outermost one.
inline constexpr float largest_cell = 0x1p30F;

/// The triangle around a point: the square lattice skewed to equilateral triangles, (u - v/sqrt3, 2v/sqrt3)
/// (Perlin 2001, DB23 Sec. 6.2).
template <scalar_number Real>
MICA_HOST_DEVICE std::array<simplex_vertex<Real>, 3> enclosing_simplex(uv_point<Real> point) {
    constexpr Real one_over_sqrt3 = Real(0.57735026918962576451);
    const Real x = clamp(point.u - point.v * one_over_sqrt3, -Real(largest_cell), Real(largest_cell));
    const Real y = clamp(point.v * (2 * one_over_sqrt3), -Real(largest_cell), Real(largest_cell));
    const Real floor_x = mica::floor(x), floor_y = mica::floor(y);
    const auto i = static_cast<std::int32_t>(floor_x);
    const auto j = static_cast<std::int32_t>(floor_y);
    const Real fx = x - floor_x, fy = y - floor_y;
    const Real rest = 1 - fx - fy;
    if (rest > 0) return {{{i, j, rest}, {i, j + 1, fy}, {i + 1, j, fx}}};
    return {{{i + 1, j + 1, -rest}, {i + 1, j, 1 - fy}, {i, j + 1, 1 - fx}}};
}

/// The seed of a grid: equal for every pixel that uses it.
template <scalar_number Real>
MICA_HOST_DEVICE constexpr std::uint32_t grid_seed(std::uint32_t seed, const tetrahedron_vertex<Real>& grid) {
    return hash(seed, static_cast<std::uint32_t>(grid.level), static_cast<std::uint32_t>(grid.log2_ratio),
                static_cast<std::uint32_t>(grid.orientation));
}

/// The seed of a vertex of a grid. Row and column are hashed apart: chained, two columns whose hashes agree in their
/// upper bits would share all their seeds.
MICA_HOST_DEVICE constexpr std::uint32_t cell_seed(std::uint32_t grid, std::int32_t i, std::int32_t j) {
    return mix(hash(grid, static_cast<std::uint32_t>(i)) ^
               hash(grid + golden_increment, static_cast<std::uint32_t>(j)));
}

} // namespace mica
