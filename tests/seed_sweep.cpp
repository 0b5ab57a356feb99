// tests/seed_sweep.cpp: over many seeds p-values are uniform. Too slow for every day: the target full_sweep runs it.
//
// The suite runs with one seed. Were its p-values not uniform over seeds, its family error would not be what it says:
// too small ones would fail good code, too large ones pass bad.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/exact.hpp>
#include <mica/random/uniform_stream.hpp>

#include "binomial_fit.hpp"

namespace {

using mica::uniform_stream;

constexpr std::uint32_t seeds = 1000;
constexpr std::uint32_t draws = 1 << 16;

/// p-value of the hypothesis that p_value_of(seed), seed = 0, 1, ..., is uniform.
template <class Test>
double uniformity(const char* name, const Test& p_value_of) {
    std::vector<double> p_values(seeds);
    for (std::uint32_t seed = 0; seed < seeds; ++seed) p_values[seed] = p_value_of(seed);
    std::sort(p_values.begin(), p_values.end());
    double difference = 0;
    for (std::uint32_t i = 0; i < seeds; ++i) {
        difference = std::max(difference, std::abs(p_values[i] - static_cast<double>(i) / seeds));
        difference = std::max(difference, std::abs(p_values[i] - (i + 1.) / seeds));
    }
    const double result = statistics::kolmogorov_p_value(difference, seeds);
    std::printf("%-40s smallest of %u: %.2g, uniform: %.3g\n", name, seeds, p_values.front(), result);
    return result;
}

/// Of the chi-square lens alone, whose p-values are nearly continuous.
double chi_square_of_exact(const statistics::binomial_case& c, std::uint32_t seed) {
    const statistics::binomial_cells cells(c.trials, c.probability);
    auto counts = cells.empty();
    for (std::uint32_t i = 0; i < draws; ++i)
        counts.add(mica::exact_binomial{}(c.trials, c.probability, uniform_stream<double>{seed, i}).successes);
    const auto fit = statistics::goodness_of_fit(cells, counts);
    return statistics::chi_square_p_value(fit.chi_square, fit.degrees);
}

TEST(SeedSweep, PValuesOfTheExactLawAreUniform) {
    for (const statistics::binomial_case& c : {statistics::binomial_case{40, 0.5}, {1000, 0.005}, {1e6, 0.3}}) {
        char name[64];
        std::snprintf(name, sizeof name, "exact, N = %g, p = %g", c.trials, c.probability);
        EXPECT_TRUE(uniformity(name, [&](std::uint32_t seed) { return chi_square_of_exact(c, seed); }) >= 1e-6);
    }
}

TEST(SeedSweep, PValuesOfTheStreamAreUniform) {
    constexpr std::size_t cells = 256;
    const std::vector<double> probabilities(cells, 1. / cells);
    EXPECT_TRUE(uniformity("uniform_stream", [&](std::uint32_t seed) {
                    std::vector<double> observed(cells, 0.);
                    for (std::uint32_t i = 0; i < draws; ++i)
                        observed[static_cast<std::size_t>(uniform_stream<double>{seed, i}() * cells)] += 1;
                    const auto fit = statistics::goodness_of_fit(probabilities, observed);
                    return statistics::chi_square_p_value(fit.chi_square, fit.degrees);
                }) >= 1e-6);
}

} // namespace
