// Compiles for a GPU what claims to run on one: a kernel for every room. Only compiled: the suite needs no device, and
// examples/gpu compares results where there is one.
//
// For hosts alone are law/batch.hpp (spans filled at once), the distributions and streams for the standard library's
// generators, and in shade/ what runs once per scene: reading, parting and filtering an environment, building the table.
#include <mica/mica.hpp>

// numeric/ and random/

template <class Gate>
__device__ float gate(float trials, float probability) {
    return Gate::none(trials, probability) + Gate::any(trials, probability);
}

__global__ void elementary_functions(const float* x, float* result, unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    const float a = x[i];
    const auto [sine, cosine] = mica::half_turns(a);
    const auto numbers = mica::floor(a) + mica::truncate(a) + mica::clamp(a, 0.F, 1.F) + mica::abs(a);
    const auto elementary = mica::log(a) + mica::log2(a) + mica::log1p_neg(a) + mica::exp(a) + mica::exp2(a) +
                            mica::expm1(a) + mica::sqrt(a) + mica::inverse_sqrt(a);
    const auto normal = mica::normal_quantile(a) + mica::normal_cdf(a);
    const auto gates = gate<mica::log1p_gate>(7, a) + gate<mica::scaled_gate>(7, a) + gate<mica::naive_gate>(7, a);
    const auto angles = sine + cosine + mica::angle_in_turns(a, numbers);
    result[i] =
        mica::select(mica::is_nan(a) || !mica::is_finite(a), 0.F, numbers + elementary + normal + gates + angles);
}

__global__ void random_numbers(std::uint32_t seed, float* result, unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    mica::uniform_stream<float> xi(seed, i);
    const auto pair = mica::normal_pair_from_bits<float>(mica::hash(seed, i));
    result[i] = xi() + xi() + mica::uniform_from_bits<float>(mica::mix(i)) + pair.first + pair.second;
}

// law/

template <class Law>
__global__ void sample_binomials(const float* trials, const float* probabilities, float* successes, unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    successes[i] = Law{}(trials[i], probabilities[i], mica::uniform_stream<float>(1U, i)).successes;
}

template __global__ void sample_binomials<mica::exact_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::gaussian_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::bernoulli_sum_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::floored_gated_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::gated_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::dual_gated_binomial>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::quantile_binomial<1>>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::quantile_binomial<4>>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::quantile_binomial<8>>(const float*, const float*, float*, unsigned);
template __global__ void sample_binomials<mica::smooth_quantile_binomial<4>>(const float*, const float*, float*,
                                                                             unsigned);

template <std::size_t K, class Law>
__global__ void sample_multinomials(const float* trials, std::array<float, K> probabilities,
                                    std::array<float, K>* counts, std::span<float> counts_of_any_k) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    counts[i] = mica::multinomial<K, Law>{}(trials[i], probabilities, mica::uniform_stream<float>(1U, i));
    mica::multinomial<std::dynamic_extent, Law>{}(trials[i], std::span<const float>(probabilities),
                                                  mica::uniform_stream<float>(1U, i),
                                                  counts_of_any_k.subspan(i * K, K));
}

template __global__ void sample_multinomials<4, mica::quantile_binomial<4>>(const float*, std::array<float, 4>,
                                                                            std::array<float, 4>*, std::span<float>);
template __global__ void sample_multinomials<8, mica::dual_gated_binomial>(const float*, std::array<float, 8>,
                                                                           std::array<float, 8>*, std::span<float>);

// grid/

template <class Law, class Interpolation, class Vertices>
__device__ float counted(const Vertices& vertices, Interpolation interpolation = {}) {
    const auto flashes =
        mica::distributed_multinomial<3, Law, Interpolation>{interpolation}(vertices, {0.1F, 0.2F, 0.3F});
    return mica::distributed_binomial<Law, Interpolation>{interpolation}(vertices, 0.1F) + flashes[0] + flashes[2];
}

__global__ void count_on_grids(const mica::uv_derivatives<float>* derivatives, const mica::uv_point<float>* uv,
                               float* result, unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    const auto footprint = mica::make_footprint(derivatives[i]);
    const float facets = 1e6F * footprint.area;
    const mica::half_vector_point<float> half_vector{0.1F, 0.2F};
    const auto vertices = mica::make_grid_vertices(footprint, uv[i], facets, 1);
    const auto angular = mica::make_grid_vertices(footprint, uv[i], half_vector, facets, 1);
    const auto one_grid = mica::make_one_grid_vertices(footprint, uv[i], facets, 1, 0.5F);
    using integer = mica::quantile_binomial<4>;
    using smooth = mica::smooth_quantile_binomial<4>;
    result[i] = counted<integer, mica::blended_variates>(vertices) + counted<smooth, mica::blended_variates>(angular) +
                counted<mica::dual_gated_binomial, mica::interpolated_counts>(angular) +
                counted<integer, mica::interpolated_counts>(one_grid) +
                counted<integer>(vertices, mica::softened_variates{0.1F}) +
                counted<integer, mica::blended_variates>(mica::with_varied_density(vertices, 0.5F));
}

// shade/

template <class Facets>
__device__ float facet_terms(const Facets& facets, mica::vector3<float> wi, mica::vector3<float> wo) {
    const auto half_vector = mica::normalized(wi + wo);
    return facets.density(half_vector) + facets.facet_area() + facets.masking_shadowing(wi, wo);
}

__global__ void shade_lights(const mica::shading_point<float>* points, std::array<mica::light_class<float>, 4> classes,
                             const mica::microfacet_table* table, float* radiance, unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    const auto& point = points[i];
    const mica::glint_kernel<mica::dual_gated_binomial> plain{};
    const mica::glint_kernel<
        mica::quantile_binomial<4>, mica::blended_variates,
        mica::effects<mica::angular_grid, mica::varied_density, mica::tinted_glints, mica::smooth_where_dense>>
        adorned{};
    const mica::glint_kernel<mica::dual_gated_binomial, mica::interpolated_counts, mica::effects<mica::one_grid>>
        published{};
    const mica::ggx<float> ggx{0.1F, 0.2F};
    const mica::beckmann<float> beckmann{0.1F, 0.2F};
    const mica::rgb<float> f0{1, 1, 1};
    const auto directional = mica::respond(mica::directional_light{{0, 0, 1}, {1, 1, 1}}, point, beckmann, f0);
    const auto sun = mica::respond(mica::sun_light{{0, 0, 1}, {1, 1, 1}}, point, ggx, f0);
    const mica::rectangle_light window{{0, 0, 2}, {0, 1, 0}, {1, 0, 0}, {1, 1, 1}};
    const mica::disk_light lamp{{0, 0, 2}, {0, 0, -1}, 1, {1, 1, 1}};
    const auto rectangle = mica::respond(window, point, ggx, f0, *table);
    const auto disk = mica::respond(lamp, point, beckmann, f0, *table);
    classes[0] = {directional.smooth, directional.probability};
    classes[1] = {sun.smooth, sun.probability};
    classes[2] = {rectangle.smooth, rectangle.probability};
    classes[3] = {disk.smooth, disk.probability};
    const auto sum = plain(point, {}, classes, {0, 0, 1}, 1U).glint + adorned(point, {}, classes, {0, 0, 1}, 1U).glint +
                     published(point, {}, classes, {0, 0, 1}, 1U).glint;
    radiance[i] = mica::luminance(sum) + facet_terms(ggx, point.wo, point.normal) +
                  facet_terms(beckmann, point.wo, point.normal) + table->visible_fraction(0.5F, 0.1F);
}

template <std::size_t K>
__global__ void shade_environment(const mica::shading_point<float>* points, mica::prefiltered_classes_view<K> sky,
                                  const mica::microfacet_table* table, mica::rgb<float>* radiance, unsigned count) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    const mica::glint_kernel<mica::quantile_binomial<4>> kernel{};
    radiance[i] = mica::shade(kernel, points[i], mica::glint_material{}, sky, *table, 1).glint;
}

template __global__ void shade_environment<4>(const mica::shading_point<float>*, mica::prefiltered_classes_view<4>,
                                              const mica::microfacet_table*, mica::rgb<float>*, unsigned);
template __global__ void shade_environment<8>(const mica::shading_point<float>*, mica::prefiltered_classes_view<8>,
                                              const mica::microfacet_table*, mica::rgb<float>*, unsigned);
