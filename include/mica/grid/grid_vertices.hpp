// mica/grid/grid_vertices.hpp: everything on the surface that has a part in a pixel.
//
// Four grids share a pixel (tetrahedron.hpp); in each the pixel lies between three vertices (simplex.hpp), and under a
// light from one direction each of these has four cells of half vectors (angular.hpp): 12 or 48 seeds. They are found once
// per pixel and shared by all lights and categories that are counted in it; of lights from several directions the cells of
// half vectors alone are found for each (with_half_vector).
//
// Domain, in binary32: footprints of ratio up to 2^16 (2^18 orientations, told apart to 1/16), levels -40 .. 40 (cells
// 2^-40 .. 2^40 uv wide), uv within 2^18 cells of the origin (placed to 1/6 of a cell at the edge, rms 1/48, and in
// proportion to the distance within: 1/48 at 2^15), half vectors within 2^18 of their cells (to 1/64). Beyond and for NaN
// `resolved` is false, and what is counted is the mean: the smooth surface.
#pragma once

#include "angular.hpp"

namespace mica {

/// One vertex of a grid, and its part in the pixel. HalfVectors is the number of its cells of half vectors, 0 or 4.
template <real_number Real, std::size_t HalfVectors = 0>
struct grid_vertex {
    index_of<Real> seed;                                 ///< equal for every pixel that it has a part in
    Real trials;                                         ///< the facets of its grid in the pixel
    Real weight;                                         ///< of its count in its grid; the three sum to 1
    Real variate_weight;                                 ///< of its blended variates in its grid
    std::array<angular_vertex<Real>, HalfVectors> cells; ///< of half vectors
};

/// One of the grids of a pixel. A normal variate of every vertex (or of every cell of half vectors, blended with the
/// cells' weights), weighted with variate_weight of its vertex and of its grid, is a standard normal variate of the pixel.
template <real_number Real, std::size_t HalfVectors = 0>
struct pixel_grid {
    Real variate_weight;                                    ///< of its blended variates among the grids
    std::array<grid_vertex<Real, HalfVectors>, 3> vertices; ///< the triangle around the pixel
};

/// The vertices of a pixel. `trials` are kept as they come; what counts takes them as a law does (binomial_law.hpp).
template <real_number Real, std::size_t HalfVectors = 0, std::size_t Grids = 4>
struct grid_vertices {
    using number = Real; ///< the number type
    /// All vertices, or all cells of half vectors.
    static constexpr std::size_t seeds = Grids * 3 * (HalfVectors == 0 ? 1 : HalfVectors);

    Real trials;                                            ///< the facets in the pixel
    mask_of<Real> resolved;                                 ///< whether the pixel lies in the domain of the grids
    std::array<pixel_grid<Real, HalfVectors>, Grids> grids; ///< that share the pixel
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

/// Size of a glint, in pixels. With it the autocorrelation of blended variates falls to one half at 0.67 to 0.95 pixels, for
/// all ratios, orientations and levels (tests/blended_test.cpp); published is 1.5, which is wider than a pixel.
inline constexpr float default_footprint_scale = 1.25F;

/// Footprints of a larger ratio are not resolved.
inline constexpr float largest_grid_ratio = 0x1p16F;

/// Pixels farther from the origin of uv, in widths of the footprint, are not resolved; nor are half vectors farther from
/// theirs, in facet roughnesses.
inline constexpr float largest_distance = 0x1p18F;

namespace detail {

/// What makes the squares of the weights sum to 1: the blend of independent standard normal variates is one, too.
template <class Vertices>
MICA_HOST_DEVICE constexpr auto inverse_norm(const Vertices& vertices) {
    auto squares = vertices[0].weight * vertices[0].weight;
    for (std::size_t i = 1; i < vertices.size(); ++i) squares = squares + vertices[i].weight * vertices[i].weight;
    return inverse_sqrt_in<2>(squares); // 5e-6
}

template <std::size_t Grids, real_number Real>
MICA_HOST_DEVICE constexpr grid_vertices<Real, 0, Grids>
vertices_of_grids(const std::array<tetrahedron_vertex<Real>, Grids>& grids, const footprint<Real>& pixel,
                  uv_point<Real> uv, Real trials, std::uint32_t seed, Real footprint_scale) {
    using Index = index_of<Real>;
    const Real level = footprint_level(pixel, footprint_scale);
    const Real farthest = Real(largest_distance) * pixel.sigma_min * footprint_scale;
    grid_vertices<Real, 0, Grids> result;
    result.trials = trials;
    result.resolved = pixel.ratio <= Real(largest_grid_ratio) && level >= Real(smallest_level) &&
                      level <= Real(largest_level) && mica::abs(uv.u) <= farthest &&
                      mica::abs(uv.v) <= farthest; // each: the larger of NaN and 0 is 0
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
    return detail::vertices_of_grids(enclosing_tetrahedron(pixel, footprint_scale), pixel, uv, trials, seed,
                                     footprint_scale);
}

/// The vertices of a pixel under a light from one direction: every vertex of the surface with its cells of half vectors.
/// Lights from several directions share the surface's vertices, which take most of the time.
template <real_number Real, std::size_t Grids>
MICA_HOST_DEVICE constexpr grid_vertices<Real, 4, Grids> with_half_vector(const grid_vertices<Real, 0, Grids>& surface,
                                                                          half_vector_point<Real> half_vector) {
    grid_vertices<Real, 4, Grids> result;
    result.trials = surface.trials;
    result.resolved = surface.resolved && mica::abs(half_vector.x) <= Real(largest_distance) &&
                      mica::abs(half_vector.y) <= Real(largest_distance);
    for (std::size_t g = 0; g < Grids; ++g) {
        result.grids[g].variate_weight = surface.grids[g].variate_weight;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& from = surface.grids[g].vertices[c];
            auto& to = result.grids[g].vertices[c];
            to.seed = from.seed;
            to.trials = from.trials;
            to.weight = from.weight;
            find_enclosing_square(half_vector, from.seed, to.cells);
            to.variate_weight = from.variate_weight * detail::inverse_norm(to.cells);
        }
    }
    return result;
}

/// The same from the footprint on.
template <real_number Real>
MICA_HOST_DEVICE constexpr grid_vertices<Real, 4>
make_grid_vertices(const footprint<Real>& pixel, uv_point<Real> uv, half_vector_point<Real> half_vector,
                   std::type_identity_t<Real> trials, std::uint32_t seed,
                   std::type_identity_t<Real> footprint_scale = Real(default_footprint_scale)) {
    return with_half_vector(make_grid_vertices(pixel, uv, trials, seed, footprint_scale), half_vector);
}

/// The vertices of one of the four grids, with all the trials: a quarter of the work, for interpolated counts, whose mean
/// it leaves. `choice` is a uniform in (0,1) that picks the grid; as one per pixel it trades the blend between grids for
/// noise.
///
/// A grid is picked with the probability of its share w a / sum w a of the trials, a the area of its cells, where choosing
/// a vertex of the tetrahedron at random suggests its barycentric weight w, as DB23 blends. The mean is N p by either, but
/// of what the four together show a grid has its share, and so the frames average to that picture: of two levels the
/// larger has four times as many facets in a cell.
template <real_number Real>
MICA_HOST_DEVICE constexpr grid_vertices<Real, 0, 1>
make_one_grid_vertices(const footprint<Real>& pixel, uv_point<Real> uv, std::type_identity_t<Real> trials,
                       std::uint32_t seed, std::type_identity_t<Real> choice,
                       std::type_identity_t<Real> footprint_scale = Real(default_footprint_scale)) {
    return detail::vertices_of_grids(detail::chosen_grid(enclosing_tetrahedron(pixel, footprint_scale), choice), pixel,
                                     uv, trials, seed, footprint_scale);
}

/// The same under a light from one direction.
template <real_number Real>
MICA_HOST_DEVICE constexpr grid_vertices<Real, 4, 1>
make_one_grid_vertices(const footprint<Real>& pixel, uv_point<Real> uv, half_vector_point<Real> half_vector,
                       std::type_identity_t<Real> trials, std::uint32_t seed, std::type_identity_t<Real> choice,
                       std::type_identity_t<Real> footprint_scale = Real(default_footprint_scale)) {
    return with_half_vector(make_one_grid_vertices(pixel, uv, trials, seed, choice, footprint_scale), half_vector);
}

} // namespace mica
