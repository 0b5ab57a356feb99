// Nanoseconds per sample of the laws, on mixed parameters: N log-uniform to 2^20, p to 2^-15, fresh at every call.
//
//     build/gcc/bench/law_benchmark
#include <array>
#include <cmath>

#include <benchmark/benchmark.h>

#include <mica/law/dual_gated.hpp>
#include <mica/law/exact.hpp>
#include <mica/law/multinomial.hpp>
#include <mica/numeric/normal.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/random/uniform_stream.hpp>

namespace {

using mica::index_of;
using mica::pack;
using mica::uniform_stream;

constexpr std::size_t parameter_sets = 4096;

struct parameters {
    std::array<float, parameter_sets> trials, probability;
};

const parameters& mixed_parameters() {
    static const parameters values = [] {
        parameters result{};
        uniform_stream<float> xi{1};
        for (std::size_t i = 0; i < parameter_sets; ++i) {
            result.trials[i] = std::exp2(20 * xi());
            result.probability[i] = std::exp2(-15 * xi());
        }
        return result;
    }();
    return values;
}

template <class Real>
Real load(const std::array<float, parameter_sets>& from, std::size_t i) {
    if constexpr (mica::scalar_number<Real>)
        return from[i];
    else
        return Real::load(&from[i]);
}

template <class Real>
uniform_stream<Real> stream_at(std::size_t i) {
    const auto index = static_cast<std::uint32_t>(i);
    if constexpr (mica::scalar_number<Real>)
        return uniform_stream<Real>(1U, index);
    else
        return uniform_stream<Real>(index_of<Real>(1U), index_of<Real>::iota(index));
}

/// Runs body(i) at every parameter set, and counts samples.
template <class Real, class Body>
void run(benchmark::State& state, const Body& body) {
    constexpr std::size_t lanes = mica::lanes_of<Real>;
    for (auto _ : state)
        for (std::size_t i = 0; i < parameter_sets; i += lanes) benchmark::DoNotOptimize(body(i));
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(parameter_sets));
}

/// What no law can be faster than: one uniform and its normal quantile.
template <class Real>
void normal_variate(benchmark::State& state) {
    run<Real>(state, [](std::size_t i) { return mica::normal_quantile(stream_at<Real>(i)()); });
}

template <class Law, class Real>
void binomial(benchmark::State& state) {
    const auto& from = mixed_parameters();
    run<Real>(state, [&](std::size_t i) {
        return Law{}(load<Real>(from.trials, i), load<Real>(from.probability, i), stream_at<Real>(i)).successes;
    });
}

template <std::size_t K, class Law, class Real>
void multinomial(benchmark::State& state) {
    const auto& from = mixed_parameters();
    run<Real>(state, [&](std::size_t i) {
        std::array<Real, K> probabilities;
        for (std::size_t k = 0; k < K; ++k)
            probabilities[k] = load<Real>(from.probability, (i + 16 * k) % parameter_sets) * Real(1.F / K);
        return mica::multinomial<K, Law>{}(load<Real>(from.trials, i), probabilities, stream_at<Real>(i));
    });
}

BENCHMARK(normal_variate<float>);
BENCHMARK(normal_variate<pack<float, 4>>);
BENCHMARK(binomial<mica::dual_gated_binomial, float>);
BENCHMARK(binomial<mica::dual_gated_binomial, pack<float, 4>>);
BENCHMARK(binomial<mica::exact_binomial, float>);
BENCHMARK(multinomial<3, mica::dual_gated_binomial, float>);
BENCHMARK(multinomial<7, mica::dual_gated_binomial, float>);
BENCHMARK(multinomial<7, mica::dual_gated_binomial, pack<float, 4>>);

} // namespace
