// mica/grid/distributed.hpp: binomial and multinomial counts that stay where they are on a surface.
//
// A pixel's trials are shared by the four grids around its footprint; in each, the outcomes at the three vertices of
// the triangle around the pixel are interpolated (DB23 Eq. 10 and 14 without the angular grid, KK25 Eq. 10):
//
//     count = sum_i sum_j v_ij law(N_i, p; seed_ij),   i = 1..4, j = 1..3
//
// The outcomes belong to the vertices, so neighbouring pixels and frames agree. The mean is exactly that of the law.
// The variance is not: interpolation of independent outcomes multiplies it by sum v^2, 1/2 on average over a triangle.
#pragma once

#include "../law/multinomial.hpp"
#include "../random/uniform_stream.hpp"
#include "simplex.hpp"

namespace mica {

/// One vertex at which a law is evaluated.
template <scalar_number Real>
struct grid_vertex {
    std::uint32_t seed;
    Real trials;
    Real weight; ///< of its outcome in the pixel; the three of one grid sum to 1
};

/// All vertices of a pixel: four grids of three. Shared by everything that is counted in the pixel.
template <scalar_number Real>
using grid_vertices = std::array<grid_vertex<Real>, 12>;

/// Published size of a glint, in pixels.
inline constexpr float default_footprint_scale = 1.5F;

/// The vertices around a pixel at `uv`, with its `trials` (real, >= 0) shared among the grids.
template <scalar_number Real>
MICA_HOST_DEVICE grid_vertices<Real> make_grid_vertices(const footprint<Real>& pixel, uv_point<Real> uv, Real trials,
                                                        std::uint32_t seed,
                                                        Real footprint_scale = Real(default_footprint_scale)) {
    grid_vertices<Real> result{};
    std::size_t next = 0;
    for (const auto& grid : enclosing_tetrahedron(pixel, footprint_scale)) {
        const std::uint32_t seed_of_grid = grid_seed(seed, grid);
        for (const auto& corner : enclosing_simplex(grid_coordinates(uv, grid)))
            result[next++] = {cell_seed(seed_of_grid, corner.i, corner.j), trials * grid.share, corner.weight};
    }
    return result;
}

/// The interpolated number of successes in a pixel, real, with mean N p.
template <class Law>
struct distributed_binomial {
    template <scalar_number Real>
        requires(binomial_law<Law, Real>)
    MICA_HOST_DEVICE Real operator()(const grid_vertices<Real>& vertices, Real probability) const {
        Real sum = 0;
        for (const auto& vertex : vertices)
            sum += vertex.weight * Law{}(vertex.trials, probability, uniform_stream<Real>(vertex.seed)).successes;
        return sum;
    }
};

/// The interpolated counts of K categories in a pixel, real, with means N p_k. Probabilities as for multinomial.
template <std::size_t K, class Law>
struct distributed_multinomial {
    template <scalar_number Real>
        requires(binomial_law<Law, Real>)
    MICA_HOST_DEVICE std::array<Real, K>
    operator()(const grid_vertices<Real>& vertices, const std::array<Real, K>& probabilities) const {
        std::array<Real, K> sum{};
        for (const auto& vertex : vertices) {
            const auto outcome = multinomial<K, Law>{}(vertex.trials, probabilities, uniform_stream<Real>(vertex.seed));
            for (std::size_t k = 0; k < K; ++k) sum[k] += vertex.weight * outcome[k];
        }
        return sum;
    }
};

} // namespace mica
