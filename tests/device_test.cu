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
#include <mica/shade/lights.hpp>

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
                             std::array<mica::light_class<float>, 4> classes, float* radiance, unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    mica::shading_point<float> point{{0, 0, 1}, {0, 0, 1}, uv[i], derivatives[i], {1, 0, 0}, {0, 0, 0}};
    const mica::glint_kernel<mica::dual_gated_binomial> plain{};
    const mica::glint_kernel<mica::quantile_binomial<4>, mica::blended_variates,
                             mica::effects<mica::angular_grid, mica::varied_density, mica::tinted_glints>>
        adorned{};
    const auto sun = mica::respond(mica::sun_light{{0, 0, 1}, {1, 1, 1}}, point, mica::ggx<float>{0.1F, 0.2F}, {1, 1, 1});
    classes[3] = {sun.smooth, sun.probability};
    radiance[i] = mica::luminance(plain(point, {}, classes, {0, 0, 1}, 1U).glint) +
                  mica::luminance(adorned(point, {}, classes, {0, 0, 1}, 1U).glint);
}
