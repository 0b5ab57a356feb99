// bench/grids.cpp: a pixel from derivatives to counts, by interpolated counts and by blended variates.
#include <mica/grid/distributed.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>
#include <mica/numeric/pack.hpp>

#include "suites.hpp"

namespace {

using law = mica::quantile_binomial<4>;
using mica::blended_variates;
using mica::half_vector_point;
using mica::interpolated_counts;
using mica::softened_variates;
using mica::uv_point;

/// Pixels of slightly different shapes at random places of one surface, each 50.5 facets.
constexpr std::size_t pixels = 1024;

const std::vector<float>& coordinates() {
    static const auto values = [] {
        std::vector<float> result(2 * pixels);
        mica::uniform_stream<float> xi(1);
        for (auto& x : result) x = xi();
        return result;
    }();
    return values;
}

template <class Real>
Real load(std::size_t i) {
    if constexpr (mica::scalar_number<Real>)
        return coordinates()[i];
    else
        return Real::load(&coordinates()[i]);
}

template <class Real, class Count>
MICA_FLATTEN void count_pixels(const Count& count, std::vector<float>& counts) {
    for (std::size_t i = 0; i < pixels; i += mica::lanes_of<Real>) {
        const Real u = load<Real>(i), v = load<Real>(i + pixels);
        const mica::uv_derivatives<Real> m{Real(0.01F) + v * Real(0.001F), Real(0.002F) * u, Real(-0.001F),
                                           Real(0.004F)};
        const Real drawn = count(mica::make_footprint(m), uv_point<Real>{u, v});
        if constexpr (mica::scalar_number<Real>)
            counts[i] = drawn;
        else
            drawn.store(&counts[i]);
    }
}

template <class Real, class Count>
void register_count(const std::string& name, Count count) {
    streams::measure(name, pixels, [count, counts = std::vector<float>(pixels)]() mutable {
        count_pixels<Real>(count, counts);
        benchmark::DoNotOptimize(counts.data());
    });
}

template <class Real>
void register_pixels(const std::string& suite) {
    using Point = uv_point<Real>;
    using Footprint = mica::footprint<Real>;
    const auto surface = [](const Footprint& pixel, Point uv) {
        return mica::make_grid_vertices(pixel, uv, Real(50.5F), 1U);
    };
    const auto half_vectors = [](const Footprint& pixel, Point uv) {
        return mica::make_grid_vertices(pixel, uv, half_vector_point<Real>{uv.v * Real(3), uv.u}, Real(50.5F), 1U);
    };
    const auto binomial = [&](const std::string& name, auto vertices, auto distributed) {
        register_count<Real>(suite + name, [=](const Footprint& pixel, Point uv) {
            return distributed(vertices(pixel, uv), Real(0.02F));
        });
    };
    binomial("counts", surface, mica::distributed_binomial<law, interpolated_counts>{});
    binomial("variates", surface, mica::distributed_binomial<law, blended_variates>{});
    binomial("variates_smooth", surface, mica::distributed_binomial<mica::smooth_quantile_binomial<4>>{});
    binomial("variates_softened", surface, mica::distributed_binomial<law, softened_variates>{});
    binomial("counts_half_vectors", half_vectors, mica::distributed_binomial<law, interpolated_counts>{});
    binomial("variates_half_vectors", half_vectors, mica::distributed_binomial<law, blended_variates>{});
    const auto multinomial = [&](const std::string& name, auto distributed) {
        register_count<Real>(suite + name, [=](const Footprint& pixel, Point uv) {
            const std::array<Real, 3> p{Real(0.02F), Real(0.01F), Real(0.03F)};
            const auto counts = distributed(surface(pixel, uv), p);
            return counts[0] + counts[1] + counts[2];
        });
    };
    multinomial("counts_multinomial_3", mica::distributed_multinomial<3, law, interpolated_counts>{});
    multinomial("variates_multinomial_3", mica::distributed_multinomial<3, law, blended_variates>{});
}

} // namespace

void suites::register_grids() {
    register_pixels<float>("grid_scalar/");
    register_pixels<mica::pack<float, mica::native_lanes<float>>>("grid/");
}
