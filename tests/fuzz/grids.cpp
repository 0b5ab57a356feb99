// Footprints, places, materials and directions of any bits: the footprint is what its header defines, a pixel that the grids
// do not resolve has the mean, and the radiance of a pixel is finite.
#include <array>
#include <cmath>

#include <mica/law/quantile.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/shade/glint_kernel.hpp>

#include "input.hpp"

namespace {

template <class Real>
mica::uv_derivatives<Real> take_derivatives(input& bytes) {
    return {bytes.take<Real>(), bytes.take<Real>(), bytes.take<Real>(), bytes.take<Real>()};
}
template <class Real>
mica::vector3<Real> take_vector(input& bytes) {
    return {bytes.take<Real>(), bytes.take<Real>(), bytes.take<Real>()};
}

template <class Real>
void require_footprint(const mica::uv_derivatives<Real>& m, const mica::footprint<Real>& pixel) {
    const bool finite =
        std::isfinite(m.du_dx) && std::isfinite(m.dv_dx) && std::isfinite(m.du_dy) && std::isfinite(m.dv_dy);
    for (const Real size : {pixel.area, pixel.sigma_max, pixel.sigma_min})
        require(size >= 0 && std::isfinite(size) && (finite || size == 0), "a size is finite, 0 for no footprint",
                static_cast<double>(size));
    require(pixel.ratio >= 1 && pixel.ratio <= Real(1.000001) * Real(mica::largest_footprint_ratio),
            "a ratio is in its range", static_cast<double>(pixel.ratio));
    require(pixel.orientation >= 0 && pixel.orientation < 1, "an orientation is in [0, 1)",
            static_cast<double>(pixel.orientation));
}

/// Weights of a resolved pixel are barycentric, and a count is in its support or, where nothing is resolved, the mean. The
/// density of a vertex is up to `densest` times that of the pixel.
template <class Vertices, class Real = typename Vertices::number>
void require_counts(const Vertices& vertices, Real probability, Real densest = 1) {
    const auto [n, p] = mica::detail::in_domain(vertices.trials, probability);
    const Real most = std::ceil(n);
    const Real blended = mica::distributed_binomial<mica::quantile_binomial<4>>{}(vertices, probability);
    const Real interpolated =
        mica::distributed_binomial<mica::quantile_binomial<4>, mica::interpolated_counts>{}(vertices, probability);
    const Real softened =
        mica::distributed_binomial<mica::quantile_binomial<4>, mica::softened_variates>{}(vertices, probability);
    if (!vertices.resolved) {
        for (const Real count : {blended, interpolated, softened})
            require(count == n * p, "unresolved is the mean", static_cast<double>(count), static_cast<double>(n * p));
        return;
    }
    for (const auto& grid : vertices.grids) {
        Real sum = 0;
        for (const auto& vertex : grid.vertices) {
            require(vertex.weight >= 0, "a weight is at least 0", static_cast<double>(vertex.weight));
            sum += vertex.weight;
        }
        require(std::abs(sum - 1) < Real(1e-4), "the weights of a triangle sum to 1", static_cast<double>(sum));
        require(std::isfinite(grid.variate_weight), "the weight of a grid is finite",
                static_cast<double>(grid.variate_weight));
    }
    require(blended >= 0 && blended <= most, "a count is in [0, ceil N]", static_cast<double>(blended),
            static_cast<double>(n));
    require(softened >= 0 && std::isfinite(softened), "an expected count is finite", static_cast<double>(softened),
            static_cast<double>(n));
    // Rounded up in each of 12 vertices.
    require(interpolated >= 0 && interpolated <= (densest * n + 12) * Real(1.0001),
            "an interpolated count is in [0, N + 12]", static_cast<double>(interpolated), static_cast<double>(n));
}

template <class Real>
void count(input bytes) {
    const auto m = take_derivatives<Real>(bytes);
    const auto pixel = mica::make_footprint(m);
    require_footprint(m, pixel);
    const mica::uv_point<Real> uv{bytes.take<Real>(), bytes.take<Real>()};
    const Real trials = bytes.take<Real>(), probability = bytes.take<Real>();
    const mica::half_vector_point<Real> half_vector{bytes.take<Real>(), bytes.take<Real>()};
    const auto seed = bytes.take<std::uint32_t>();
    const Real choice = bytes.take<Real>(), deviation = bytes.take<Real>(), scale = bytes.take<Real>();

    const auto vertices = mica::make_grid_vertices(pixel, uv, trials, seed);
    require_counts(vertices, probability);
    require_counts(mica::with_half_vector(vertices, half_vector), probability);
    require_counts(mica::make_one_grid_vertices(pixel, uv, trials, seed, choice), probability);
    constexpr Real densest = 4000; // exp(4 - 1/2) over exp(-4 - 1/2)
    require_counts(mica::with_varied_density(vertices, deviation), probability, densest);
    require_counts(mica::make_grid_vertices(pixel, uv, trials, seed, scale), probability);
}

/// Four pixels side by side are those alone. Their derivatives are those of the first, in turn.
void require_lanes(input bytes) {
    using Pack = mica::pack<float, 4>;
    const auto m = take_derivatives<float>(bytes);
    const auto u = bytes.take<float>(), v = bytes.take<float>(), trials = bytes.take<float>();
    const auto probability = bytes.take<float>();
    const auto seed = bytes.take<std::uint32_t>();
    const std::array<float, 6> turn{m.du_dx, m.dv_dx, m.du_dy, m.dv_dy, u, v};
    std::array<std::array<float, 4>, 6> lanes{};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 6; ++j) lanes[j][i] = turn[(i + j) % 6];
    const auto packed = [&lanes](std::size_t j) { return Pack::load(lanes[j].data()); };
    const auto side_by_side = mica::distributed_binomial<mica::quantile_binomial<4>>{}(
        mica::make_grid_vertices(
            mica::make_footprint(mica::uv_derivatives<Pack>{packed(0), packed(1), packed(2), packed(3)}),
            mica::uv_point<Pack>{packed(4), packed(5)}, Pack(trials), seed),
        Pack(probability));
    for (std::size_t i = 0; i < 4; ++i) {
        const auto alone = mica::distributed_binomial<mica::quantile_binomial<4>>{}(
            mica::make_grid_vertices(
                mica::make_footprint(mica::uv_derivatives<float>{lanes[0][i], lanes[1][i], lanes[2][i], lanes[3][i]}),
                mica::uv_point<float>{lanes[4][i], lanes[5][i]}, trials, seed),
            probability);
        const float lane = side_by_side[static_cast<int>(i)];
        require(same_bits(lane, alone), "a lane is a scalar", static_cast<double>(lane), static_cast<double>(alone));
    }
}

/// Point and material of any bits; radiances and probabilities of the classes in their domain.
template <class Kernel>
void shade(const Kernel& kernel, input bytes) {
    mica::shading_point<float> point;
    point.derivatives = take_derivatives<float>(bytes);
    point.uv = {bytes.take<float>(), bytes.take<float>()};
    const auto half_vector = take_vector<float>(bytes);
    mica::glint_material material;
    material.log_density = bytes.take<float>();
    material.footprint_scale = bytes.take<float>();
    std::array<mica::light_class<float>, 3> classes{};
    for (auto& one : classes)
        one = {{bytes.within(0, 1e6F), bytes.within(0, 1e6F), bytes.within(0, 1e6F)}, bytes.within(0, 1)};
    const auto seed = bytes.take<std::uint32_t>();
    const auto seen = kernel(point, material, classes, half_vector, seed);
    for (const float band : {seen.glint.r, seen.glint.g, seen.glint.b, seen.smooth.r, seen.smooth.g, seen.smooth.b})
        require(band >= 0 && std::isfinite(band), "a radiance is finite", static_cast<double>(band));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const input bytes(data, size);
    count<float>(bytes);
    count<double>(bytes);
    require_lanes(bytes);
    shade(mica::glint_kernel<mica::quantile_binomial<4>>{}, bytes);
    shade(mica::glint_kernel<
              mica::quantile_binomial<4>, mica::blended_variates,
              mica::effects<mica::angular_grid, mica::varied_density, mica::tinted_glints, mica::smooth_where_dense>>{},
          bytes);
    shade(mica::glint_kernel<mica::quantile_binomial<4>, mica::interpolated_counts, mica::effects<mica::one_grid>>{},
          bytes);
    return 0;
}
