// bench/laws.cpp: mica's laws, one draw at a time and in batches; what no law can be faster than; gates.
#include <mica/law/batch.hpp>
#include <mica/law/bernoulli_sum.hpp>
#include <mica/law/dual_gated.hpp>
#include <mica/law/exact.hpp>
#include <mica/law/floored_gated.hpp>
#include <mica/law/gated.hpp>
#include <mica/law/gaussian.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>

#include "suites.hpp"

namespace {

using mica::uniform_stream;
using Number = mica::pack_pair<mica::pack<float, mica::native_lanes<float>>>; // what sample() draws with
using streams::measure;

template <class Law>
void batch(const std::string& name, const streams::binomial& stream, Law law) {
    measure(name, streams::size, [&stream, law, counts = std::vector<float>(streams::size)]() mutable {
        mica::sample(law, stream.trials, stream.probabilities, 1U, counts);
        benchmark::DoNotOptimize(counts.data());
    });
}

template <class Law>
void scalar(const std::string& name, const streams::binomial& stream, Law law) {
    streams::measure_each(name, stream, [law](float trials, float probability, std::size_t i) {
        return law(trials, probability, uniform_stream<float>{1U, static_cast<std::uint32_t>(i)}).successes;
    });
}

template <class Law>
void register_law(const std::string& name, Law law) {
    batch("mixed/" + name, streams::mixed(), law);
    scalar("mixed_scalar/" + name, streams::mixed(), law);
    measure("fixed/" + name, streams::size, [law, counts = std::vector<float>(streams::size)]() mutable {
        mica::sample(law, 1000.F, 0.01F, 1U, counts);
        benchmark::DoNotOptimize(counts.data());
    });
    for (const auto& [at, stream] : suites::curve_points()) batch(at + name, stream, law);
}

/// What a law cannot be faster than.
template <class Make>
void register_variate(const std::string& name, Make make) {
    measure("mixed/" + name, streams::size, [make, values = std::vector<float>(streams::size)]() mutable {
        using Index = mica::index_of<Number>;
        for (std::size_t i = 0; i < streams::size; i += mica::lanes_of<Number>)
            make(uniform_stream<Number>(Index(1U), Index::iota(static_cast<std::uint32_t>(i)))).store(&values[i]);
        benchmark::DoNotOptimize(values.data());
    });
}

template <class Gate>
void register_gate(const std::string& name, Gate) {
    measure("gate/" + name, streams::size, [values = std::vector<float>(streams::size)]() mutable {
        const auto& stream = streams::mixed();
        for (std::size_t i = 0; i < streams::size; i += mica::lanes_of<Number>)
            Gate::none(Number::load(&stream.trials[i]), Number::load(&stream.probabilities[i])).store(&values[i]);
        benchmark::DoNotOptimize(values.data());
    });
}

template <std::size_t K, class Law>
void register_multinomial(const std::string& name, Law) {
    struct state {
        streams::multinomial stream = streams::mixed_multinomial(K);
        std::vector<std::vector<float>> counts = std::vector(K, std::vector<float>(streams::size));
        std::array<std::span<const float>, K> from;
        std::array<std::span<float>, K> to;
    };
    const auto shared = std::make_shared<state>();
    for (std::size_t k = 0; k < K; ++k) {
        shared->from[k] = shared->stream.probabilities[k];
        shared->to[k] = shared->counts[k];
    }
    measure("multinomial_" + std::to_string(K) + "/" + name, streams::size, [shared] {
        mica::sample(mica::multinomial<K, Law>{}, shared->stream.trials, shared->from, 1U, shared->to);
    });
    measure("multinomial_scalar_" + std::to_string(K) + "/" + name, streams::size, [shared] {
        for (std::size_t i = 0; i < streams::size; ++i) {
            std::array<float, K> probabilities;
            for (std::size_t k = 0; k < K; ++k) probabilities[k] = shared->from[k][i];
            uniform_stream<float> xi{1U, static_cast<std::uint32_t>(i)};
            const auto drawn = mica::multinomial<K, Law>{}(shared->stream.trials[i], probabilities, xi);
            for (std::size_t k = 0; k < K; ++k) shared->to[k][i] = drawn[k];
        }
    });
}

template <class Law>
void register_multinomials(const std::string& name, Law law) {
    register_multinomial<2>(name, law);
    register_multinomial<4>(name, law);
    register_multinomial<8>(name, law);
    register_multinomial<16>(name, law);
}

} // namespace

void suites::register_laws() {
    register_variate("uniform", [](auto xi) { return xi(); });
    register_variate("normal", [](auto xi) { return mica::normal_quantile(xi()); });
    register_gate("naive", mica::naive_gate{});
    register_gate("scaled", mica::scaled_gate{});
    register_gate("log1p", mica::log1p_gate{});
    register_law("gaussian", mica::gaussian_binomial{});
    register_law("bernoulli_sum", mica::bernoulli_sum_binomial{});
    register_law("floored_gated", mica::floored_gated_binomial{});
    register_law("gated", mica::gated_binomial{});
    register_law("dual_gated", mica::dual_gated_binomial{});
    register_law("quantile_1", mica::quantile_binomial<1>{});
    register_law("quantile_2", mica::quantile_binomial<2>{});
    register_law("quantile_4", mica::quantile_binomial<4>{});
    register_law("quantile_8", mica::quantile_binomial<8>{});
    register_law("quantile_16", mica::quantile_binomial<16>{});
    register_law("smooth_quantile_4", mica::smooth_quantile_binomial<4>{});
    register_law("exact", mica::exact_binomial{});
    register_multinomials("dual_gated", mica::dual_gated_binomial{});
    register_multinomials("quantile_4", mica::quantile_binomial<4>{});
}
