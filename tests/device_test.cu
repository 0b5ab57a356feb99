// Compiles for a GPU what claims to run on one. Only compiled: the suite needs no device.
#include <mica/grid/distributed.hpp>
#include <mica/law/dual_gated.hpp>
#include <mica/shade/environment_glints.hpp>

__global__ void sample_binomials(const float* trials, const float* probabilities, float* successes, unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    successes[i] =
        mica::dual_gated_binomial{}(trials[i], probabilities[i], mica::uniform_stream<float>(1U, i)).successes;
}

__global__ void count_glints(const mica::uv_derivatives<float>* derivatives, const mica::uv_point<float>* uv,
                             std::array<float, 4> levels, std::array<float, 4> indicators, float* ratio,
                             unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    const auto pixel = mica::make_footprint(derivatives[i]);
    const float trials = 1e6F * pixel.area;
    const auto vertices = mica::make_grid_vertices(pixel, uv[i], trials, 1U);
    ratio[i] = mica::glint_ratio<mica::dual_gated_binomial>(vertices, trials, levels, indicators, 0.9F);
}
