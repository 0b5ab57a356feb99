// mica/grid/grid_vertices.hpp: everything on the surface that has a part in a pixel.
//
// Four grids share a pixel (tetrahedron.hpp); in each the pixel lies between three vertices (simplex.hpp), and under a
// light from one direction each of these has four cells of half vectors (angular.hpp): 12 or 48 seeds. They are found once
// per pixel and shared by all lights and categories that are counted in it.
//
// Domain, in binary32: footprints of ratio up to 2^16 (2^18 orientations, told apart to 1/16), levels -40 .. 40 (cells
// 2^-40 .. 2^40 uv wide), and uv within 2^18 cells of the origin (placed to 1/64 of a cell). Beyond, `resolved` is false,
// and what is counted is the mean: the smooth surface.
#pragma once

#include "angular.hpp"

namespace mica {

/// One vertex of a grid, and its part in the pixel. HalfVectors is the number of its cells of half vectors, 0 or 4.
template <real_number Real, std::size_t HalfVectors = 0>
struct grid_vertex {
    index_of<Real> seed;
    Real trials;         ///< the facets of its grid in the pixel
    Real weight;         ///< of its count in its grid; the three sum to 1
    Real variate_weight; ///< of its blended variates in its grid
    std::array<angular_vertex<Real>, HalfVectors> cells;
};

/// One of the grids of a pixel. A normal variate of every vertex (or of every cell of half vectors, blended with the
/// cells' weights), weighted with variate_weight of its vertex and of its grid, is a standard normal variate of the pixel.
template <real_number Real, std::size_t HalfVectors = 0>
struct pixel_grid {
    Real variate_weight;
    std::array<grid_vertex<Real, HalfVectors>, 3> vertices;
};

/// The vertices of a pixel.
template <real_number Real, std::size_t HalfVectors = 0, std::size_t Grids = 4>
struct grid_vertices {
    using number = Real;
    static constexpr std::size_t seeds = Grids * 3 * (HalfVectors == 0 ? 1 : HalfVectors);

    Real trials;            ///< the facets in the pixel
    mask_of<Real> resolved; ///< whether the pixel lies in the domain of the grids
    std::array<pixel_grid<Real, HalfVectors>, Grids> grids;
};

/// The vertices of the pixel in lane i.
template <real_number Real, std::size_t HalfVectors, std::size_t Grids>
MICA_HOST_DEVICE constexpr grid_vertices<scalar_of<Real>, HalfVectors, Grids>
lane_of_vertices(const grid_vertices<Real, HalfVectors, Grids>& vertices, int i) {
    grid_vertices<scalar_of<Real>, HalfVectors, Grids> result{
        lane(vertices.trials, i), lane(select(vertices.resolved, Real(1), Real(0)), i) > 0, {}};
    for (std::size_t g = 0; g < Grids; ++g) {
        result.grids[g].variate_weight = lane(vertices.grids[g].variate_weight, i);
        for (std::size_t v = 0; v < 3; ++v) {
            const auto& from = vertices.grids[g].vertices[v];
            auto& to = result.grids[g].vertices[v];
            to = {lane(from.seed, i), lane(from.trials, i), lane(from.weight, i), lane(from.variate_weight, i), {}};
            for (std::size_t c = 0; c < HalfVectors; ++c)
                to.cells[c] = {lane(from.cells[c].seed, i), lane(from.cells[c].weight, i)};
        }
    }
    return result;
}

/// Size of a glint, in pixels. With it the autocorrelation of blended variates is as wide as that of facets seen through the
/// ellipse with semi-axes sigma, within a quarter where N p >= 1 (docs/grids.md); published is 1.5.
inline constexpr float default_footprint_scale = 1.4F;

/// Footprints of a larger ratio are not resolved.
inline constexpr float largest_grid_ratio = 0x1p16F;

/// Pixels farther from the origin of uv, in widths of the footprint, are not resolved.
inline constexpr float largest_distance = 0x1p18F;

namespace detail {

/// What makes the squares of the weights sum to 1: the blend of independent standard normal variates is one, too.
template <class Vertices>
MICA_HOST_DEVICE constexpr auto inverse_norm(const Vertices& vertices) {
    auto squares = vertices[0].weight * vertices[0].weight;
    for (std::size_t i = 1; i < vertices.size(); ++i) squares = squares + vertices[i].weight * vertices[i].weight;
    return inverse_sqrt_in<2>(squares); // 5e-6
}

/// A light from no direction in particular.
struct no_half_vector {};

template <class HalfVector>
inline constexpr std::size_t cells_per_vertex = std::is_same_v<HalfVector, no_half_vector> ? 0 : 4;

template <std::size_t Grids, real_number Real, class HalfVector>
MICA_HOST_DEVICE constexpr auto
vertices_of_grids(const std::array<tetrahedron_vertex<Real>, Grids>& grids, const footprint<Real>& pixel,
                  uv_point<Real> uv, HalfVector half_vector, Real trials, std::uint32_t seed, Real footprint_scale) {
    using Index = index_of<Real>;
    constexpr std::size_t half_vectors = cells_per_vertex<HalfVector>;
    const Real level = footprint_level(pixel, footprint_scale);
    const Real farthest = maximum(mica::abs(uv.u), mica::abs(uv.v));
    grid_vertices<Real, half_vectors, Grids> result;
    result.trials = trials;
    result.resolved = pixel.ratio <= Real(largest_grid_ratio) && level >= Real(smallest_level) &&
                      level <= Real(largest_level) &&
                      farthest <= Real(largest_distance) * pixel.sigma_min * footprint_scale;
    const Real grids_norm = inverse_norm(grids);
    for (std::size_t g = 0; g < Grids; ++g) {
        const Index seed_of_grid = grid_seed(seed, grids[g]);
        const auto corners = enclosing_simplex(grid_coordinates(uv, grids[g]));
        const auto row = [&](std::size_t c) { return row_hash(seed_of_grid, hashable<Real>(corners[c].i)); };
        const auto column = [&](std::size_t c) { return column_hash(seed_of_grid, hashable<Real>(corners[c].j)); };
        const Index shared_row = row(0), shared_column = column(0);
        const Index seeds[] = {shared_row ^ shared_column, shared_row ^ column(1), row(2) ^ shared_column};

        auto& grid = result.grids[g];
        grid.variate_weight = grids[g].weight * grids_norm * inverse_norm(corners);
        for (std::size_t c = 0; c < 3; ++c) {
            auto& vertex = grid.vertices[c];
            vertex.seed = seeds[c];
            vertex.trials = trials * grids[g].share;
            vertex.weight = vertex.variate_weight = corners[c].weight;
            if constexpr (half_vectors > 0) {
                find_enclosing_square(half_vector, seeds[c], vertex.cells);
                vertex.variate_weight = corners[c].weight * inverse_norm(vertex.cells);
            }
        }
    }
    return result;
}

/// One of four grids, each chosen with the probability of its share of the trials, for all the trials.
template <real_number Real>
MICA_HOST_DEVICE constexpr std::array<tetrahedron_vertex<Real>, 1>
chosen_grid(const std::array<tetrahedron_vertex<Real>, 4>& grids, Real choice) {
    tetrahedron_vertex<Real> result = grids[0];
    Real passed = grids[0].share;
    for (std::size_t i = 1; i < 4; ++i) {
        const auto further = choice > passed;
        result.level = select(further, grids[i].level, result.level);
        result.log2_ratio = select(further, grids[i].log2_ratio, result.log2_ratio);
        result.orientation = select(further, grids[i].orientation, result.orientation);
        passed = passed + grids[i].share;
    }
    result.weight = result.share = Real(1);
    return {result};
}

} // namespace detail

/// The vertices around a pixel at `uv`, with its `trials` (real, >= 0) shared among the grids.
template <real_number Real>
MICA_HOST_DEVICE constexpr grid_vertices<Real>
make_grid_vertices(const footprint<Real>& pixel, uv_point<Real> uv, std::type_identity_t<Real> trials,
                   std::uint32_t seed, std::type_identity_t<Real> footprint_scale = Real(default_footprint_scale)) {
    return detail::vertices_of_grids(enclosing_tetrahedron(pixel, footprint_scale), pixel, uv, detail::no_half_vector{},
                                     trials, seed, footprint_scale);
}

/// The same under a light from one direction: vertices of the surface and of half vectors.
template <real_number Real>
MICA_HOST_DEVICE constexpr grid_vertices<Real, 4>
make_grid_vertices(const footprint<Real>& pixel, uv_point<Real> uv, half_vector_point<Real> half_vector,
                   std::type_identity_t<Real> trials, std::uint32_t seed,
                   std::type_identity_t<Real> footprint_scale = Real(default_footprint_scale)) {
    return detail::vertices_of_grids(enclosing_tetrahedron(pixel, footprint_scale), pixel, uv, half_vector, trials,
                                     seed, footprint_scale);
}

/// The vertices of one of the four grids, with all the trials: a quarter of the work, for interpolated counts, whose mean
/// it leaves. `choice` is a uniform in (0,1) that picks the grid; as one per pixel it trades the blend between grids for
/// noise.
template <real_number Real>
MICA_HOST_DEVICE constexpr grid_vertices<Real, 0, 1>
make_one_grid_vertices(const footprint<Real>& pixel, uv_point<Real> uv, std::type_identity_t<Real> trials,
                       std::uint32_t seed, std::type_identity_t<Real> choice,
                       std::type_identity_t<Real> footprint_scale = Real(default_footprint_scale)) {
    return detail::vertices_of_grids(detail::chosen_grid(enclosing_tetrahedron(pixel, footprint_scale), choice), pixel,
                                     uv, detail::no_half_vector{}, trials, seed, footprint_scale);
}

/// The same under a light from one direction.
template <real_number Real>
MICA_HOST_DEVICE constexpr grid_vertices<Real, 4, 1>
make_one_grid_vertices(const footprint<Real>& pixel, uv_point<Real> uv, half_vector_point<Real> half_vector,
                       std::type_identity_t<Real> trials, std::uint32_t seed, std::type_identity_t<Real> choice,
                       std::type_identity_t<Real> footprint_scale = Real(default_footprint_scale)) {
    return detail::vertices_of_grids(detail::chosen_grid(enclosing_tetrahedron(pixel, footprint_scale), choice), pixel,
                                     uv, half_vector, trials, seed, footprint_scale);
}

} // namespace mica
