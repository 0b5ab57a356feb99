// Compiles for a GPU what claims to run on one. Only compiled: the suite needs no device.
#include <mica/grid/distributed.hpp>
#include <mica/law/bernoulli_sum.hpp>
#include <mica/law/dual_gated.hpp>
#include <mica/law/floored_gated.hpp>
#include <mica/law/gated.hpp>
#include <mica/law/gaussian.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>
#include <mica/shade/environment_glints.hpp>

template <class Law>
__global__ void sample_binomials(const float* trials, const float* probabilities, float* successes, unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    successes[i] = Law{}(trials[i], probabilities[i], mica::uniform_stream<float>(1U, i)).successes;
}

// Every law but the exact one, which is for hosts.
template __global__ void sample_binomials<mica::gaussian_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::bernoulli_sum_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::floored_gated_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::gated_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::dual_gated_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::quantile_binomial<4>>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::quantile_binomial<8>>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::smooth_quantile_binomial<4>>(const float*, const float*, float*,
                                                                             unsigned);

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
