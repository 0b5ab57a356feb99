// bench/streams.hpp: the parameters on which everything is measured, and how a measurement is registered.
//
// All benchmarks report items_per_second; an item is one binomial or one whole multinomial. The parameters are fresh for
// every item (streams longer than what branch predictors remember) or, where the name says so, fixed. Results are
// written to memory.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace streams {

inline constexpr std::size_t size = 1 << 14;

struct binomial {
    std::vector<float> trials, probabilities;
};

/// N log-uniform from 1 to 2^20, p from 2^-15 to 1; N an integer, for the peers that know no other.
inline const binomial& mixed() {
    static const binomial stream = [] {
        binomial result;
        std::mt19937 generator(1);
        std::uniform_real_distribution<double> log_trials(0, 20), log_probability(-15, 0);
        for (std::size_t i = 0; i < size; ++i) {
            result.trials.push_back(static_cast<float>(std::floor(std::exp2(log_trials(generator)))));
            result.probabilities.push_back(static_cast<float>(std::exp2(log_probability(generator))));
        }
        return result;
    }();
    return stream;
}

inline binomial fixed(float trials, float probability) {
    return {std::vector<float>(size, trials), std::vector<float>(size, probability)};
}

/// K categories whose probabilities sum to 1, likewise mixed: ratios up to 2^8 between them.
struct multinomial {
    std::vector<float> trials;
    std::vector<std::vector<float>> probabilities; ///< [category][item]
};

inline multinomial mixed_multinomial(std::size_t categories) {
    multinomial result{mixed().trials, std::vector(categories, std::vector<float>(size))};
    std::mt19937 generator(2);
    std::uniform_real_distribution<double> log_share(-8, 0);
    for (std::size_t i = 0; i < size; ++i) {
        std::vector<double> share(categories);
        double total = 0;
        for (double& one : share) total += one = std::exp2(log_share(generator));
        for (std::size_t k = 0; k < categories; ++k) result.probabilities[k][i] = static_cast<float>(share[k] / total);
    }
    return result;
}

/// How many passes each benchmark makes, if MICA_PASSES says so: to count instructions, whose difference between two
/// numbers of passes is that of the passes alone.
inline int passes() {
    const char* const asked = std::getenv("MICA_PASSES");
    return asked ? static_cast<int>(std::strtol(asked, nullptr, 10)) : 0;
}

/// Registers pass(), which draws `items` items, under a name.
template <class Pass>
void measure(const std::string& name, std::size_t items, Pass pass) {
    const auto registered = benchmark::RegisterBenchmark(name.c_str(), [items, pass](benchmark::State& state) mutable {
        for (auto _ : state) {
            pass();
            benchmark::ClobberMemory();
        }
        state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
    });
    if (passes() > 0) registered->Iterations(passes());
}

/// Registers draw(N, p), one item a call.
template <class Draw>
void measure_each(const std::string& name, const binomial& stream, Draw draw) {
    measure(name, size, [&stream, counts = std::vector<float>(size), draw]() mutable {
        for (std::size_t i = 0; i < size; ++i)
            counts[i] = static_cast<float>(draw(stream.trials[i], stream.probabilities[i], i));
        benchmark::DoNotOptimize(counts.data());
    });
}

} // namespace streams
