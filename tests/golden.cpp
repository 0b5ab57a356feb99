// Prints digests of what must stay the same to the last bit: tests/data/golden.txt holds what it printed when a version was
// made. A difference is a value-breaking change, for the changelog (docs/reproducibility.md).
//
//     build/gcc/tests/golden > tests/data/golden.txt

#include <bit>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include <mica/mica.hpp>

#include "law_names.hpp"

namespace {

/// FNV-1a of the bits of numbers.
class digest {
  public:
    template <class Number>
    void add(Number value) {
        if constexpr (std::is_floating_point_v<Number>) {
            using bits = std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>;
            add(std::bit_cast<bits>(value));
        } else {
            for (std::size_t i = 0; i < sizeof(Number); ++i) {
                hash_ ^= static_cast<std::uint64_t>(value >> (8 * i)) & 0xff;
                hash_ *= 0x100000001b3;
            }
        }
    }

    void print(const std::string& name) const { std::printf("%-44s %016" PRIx64 "\n", name.c_str(), hash_); }

  private:
    std::uint64_t hash_ = 0xcbf29ce484222325;
};

template <class Real>
const char* const real_name = sizeof(Real) == 4 ? "float" : "double";

/// Calls body(x) with so many numbers of [low, high], evenly in the exponent.
template <class Real, class Body>
void sweep(Real low, Real high, const Body& body) {
    mica::uniform_stream<Real> xi{1, 2};
    for (int i = 0; i < 4096; ++i) {
        // Products of exact powers of two and uniforms: the same everywhere.
        Real x = low;
        while (x < high && xi() < Real(0.95)) x *= Real(2);
        body((x < high ? x : high) * (Real(0.5) + Real(0.5) * xi()));
    }
}

template <class Real>
void numbers() {
    const auto row = [](const char* name, Real low, Real high, const auto& function) {
        digest d;
        sweep<Real>(low, high, [&](Real x) { d.add(function(x)); });
        d.print(std::string("numeric.") + name + "." + real_name<Real>);
    };
    row("log", Real(1e-30), Real(1e30), [](Real x) { return mica::log(x); });
    row("exp", Real(1e-6), Real(80), [](Real x) { return mica::exp(-x); });
    row("expm1", Real(1e-6), Real(80), [](Real x) { return mica::expm1(-x); });
    row("sqrt", Real(1e-30), Real(1e30), [](Real x) { return mica::sqrt(x); });
    row("normal_quantile", Real(1e-30), Real(1), [](Real x) { return mica::normal_quantile(x); });
    digest stream;
    mica::uniform_stream<Real> xi{2026, 7};
    for (int i = 0; i < 4096; ++i) stream.add(xi());
    stream.print(std::string("random.uniform_stream.") + real_name<Real>);
}

constexpr double trials[] = {0, 0.5, 1, 3.7, 8, 20, 60, 150, 1e4, 1e6 + 1, 1e9, 1e12};
constexpr double probabilities[] = {0, 1e-16, 1e-9, 1e-3, 0.02, 0.3, 0.5, 0.97, 1};

template <class Real, class Law>
void law(Law draw) {
    digest d;
    std::uint32_t index = 0;
    for (const double n : trials)
        for (const double p : probabilities)
            for (int i = 0; i < 200; ++i) {
                mica::uniform_stream<Real> xi{11, index++};
                const auto counts = draw(static_cast<Real>(n), static_cast<Real>(p), xi);
                d.add(counts.successes);
                d.add(counts.failures);
            }
    d.print("law." + law_name(draw) + "." + real_name<Real>);
}

template <class Law>
void both(Law draw) {
    law<float>(draw);
    law<double>(draw);
}

template <class Law>
void batch(Law draw) {
    std::vector<float> n, p;
    for (const double a : trials)
        for (const double b : probabilities) {
            n.push_back(static_cast<float>(a));
            p.push_back(static_cast<float>(b));
        }
    std::vector<float> successes(n.size());
    digest d;
    for (std::uint32_t seed = 0; seed < 16; ++seed) {
        mica::sample(draw, n, p, seed, successes);
        for (const float x : successes) d.add(x);
    }
    d.print("batch." + law_name(draw));
}

template <class Law>
void multinomial(Law draw) {
    digest d;
    std::uint32_t index = 0;
    for (const double n : trials)
        for (int i = 0; i < 32; ++i) {
            mica::uniform_stream<float> xi{5, index++};
            const std::array<float, 4> p{0.1F, 1e-3F, 0.6F, 0.02F};
            for (const float count : mica::multinomial<4, Law>{}(static_cast<float>(n), p, xi)) d.add(count);
        }
    d.print("multinomial." + law_name(draw));
}

/// Pixels of a plane seen at an angle, from dense to sparse.
template <class Body>
void pixels(const Body& body) {
    for (int y = 1; y <= 24; ++y)
        for (int x = 0; x < 24; ++x) {
            const float far = static_cast<float>(y) / 512;
            mica::shading_point<float> point{};
            point.normal = {0, 0, 1};
            point.tangent = {1, 0, 0};
            point.wo = {0, -0.6F, 0.8F};
            point.position = {static_cast<float>(x - 12) / 8, static_cast<float>(y) / 8, 0};
            point.uv = {0.37F + static_cast<float>(x) * far, 0.11F + static_cast<float>(y) * far * far};
            point.derivatives = {far, far * 0.25F, -0.5F * far, 3 * far * far};
            body(point);
        }
}

template <class Law, class Interpolation>
void grid(const char* name) {
    digest d;
    pixels([&](const mica::shading_point<float>& point) {
        const auto footprint = mica::make_footprint<float>(point.derivatives);
        const auto vertices = mica::make_grid_vertices(footprint, point.uv, 1e5F * footprint.area, 3);
        for (const float p : {1e-3F, 0.1F, 0.5F}) d.add(mica::distributed_binomial<Law, Interpolation>{}(vertices, p));
    });
    d.print(std::string("grid.") + name);
}

template <class Light>
void light(const char* name, const Light& shining) {
    const mica::microfacet_table table;
    digest d;
    pixels([&](const mica::shading_point<float>& point) {
        d.add(respond(shining, point, mica::ggx<float>{0.2F, 0.1F}, {1, 1, 1}, table).probability);
        d.add(respond(shining, point, mica::beckmann<float>{0.3F, 0.3F}, {1, 1, 1}, table).probability);
    });
    d.print(std::string("light.") + name);
}

template <class Effects>
void kernel(const char* name) {
    mica::glint_material material;
    material.log_density = 11;
    const std::array<mica::light_class<float>, 3> classes{
        {{{1, 2, 3}, 1e-3F}, {{0.5F, 0.25F, 0.125F}, 0.2F}, {{7, 8, 9}, 1e-6F}}};
    digest d;
    pixels([&](const mica::shading_point<float>& point) {
        const auto seen = mica::glint_kernel<mica::quantile_binomial<4>, mica::blended_variates, Effects>{}(
            point, material, classes, {0.1F, 0.2F, 0.97F}, 17);
        for (const float x : {seen.glint.r, seen.glint.g, seen.glint.b, seen.smooth.g}) d.add(x);
    });
    d.print(std::string("kernel.") + name);
}

void standard_distributions() {
    std::mt19937_64 generator(2026);
    digest d;
    for (int i = 0; i < 4096; ++i)
        d.add(static_cast<std::uint64_t>(mica::binomial_distribution<long long>(1LL << (i % 40), 0.3)(generator)));
    mica::multinomial_distribution<long long> three(1000, {0.2, 0.3, 0.1});
    for (int i = 0; i < 1024; ++i)
        for (const long long count : three(generator)) d.add(static_cast<std::uint64_t>(count));
    d.print("distribution.std");
}

} // namespace

int main() {
    numbers<float>();
    numbers<double>();
    both(mica::gaussian_binomial{});
    both(mica::bernoulli_sum_binomial{});
    both(mica::floored_gated_binomial{});
    both(mica::gated_binomial{});
    both(mica::dual_gated_binomial{});
    both(mica::quantile_binomial<2>{});
    both(mica::quantile_binomial<4>{});
    both(mica::quantile_binomial<8>{});
    both(mica::smooth_quantile_binomial<4>{});
    both(mica::exact_binomial{});
    batch(mica::dual_gated_binomial{});
    batch(mica::quantile_binomial<4>{});
    batch(mica::exact_binomial{});
    multinomial(mica::quantile_binomial<4>{});
    multinomial(mica::exact_binomial{});
    standard_distributions();
    grid<mica::quantile_binomial<4>, mica::blended_variates>("variates");
    grid<mica::quantile_binomial<4>, mica::interpolated_counts>("counts");
    grid<mica::smooth_quantile_binomial<4>, mica::blended_variates>("variates.smooth");
    light("sun", mica::sun_light{{0.36F, 0.48F, 0.8F}, {1, 1, 1}, 0.02F});
    light("rectangle", mica::rectangle_light{{0, 5, 2}, {-1, 0, 0}, {0, 0, -1}, {1, 1, 1}});
    light("disk", mica::disk_light{{0, 5, 2}, {0, -1, 0}, 1, {1, 1, 1}});
    kernel<mica::effects<>>("plain");
    kernel<mica::effects<mica::angular_grid>>("angular_grid");
    kernel<mica::effects<mica::varied_density, mica::tinted_glints>>("varied_density.tinted_glints");
}
