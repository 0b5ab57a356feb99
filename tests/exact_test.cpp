// tests/exact_test.cpp: exact_binomial against Boost.Math's binomial, with draws and, for the probability of every count,
// without.
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include <gtest/gtest.h>

#include "mica/law/exact.hpp"
#include "mica/numeric/pack.hpp"
#include "mica/random/uniform_stream.hpp"

#include "binomial_fit.hpp"
#include "enumeration.hpp"
#include "scripted_uniforms.hpp"

namespace {

using mica::exact_binomial;
using mica::uniform_stream;
using statistics::binomial_case;

constexpr int fit_draws = statistics::fit_draws;

template <class Real>
void expect_exact_law(binomial_case c, std::uint32_t seed) {
    const Real trials = static_cast<Real>(c.trials), probability = static_cast<Real>(c.probability);
    const binomial_case given{static_cast<double>(trials), static_cast<double>(probability)};
    statistics::binomial_sample sample(given);
    EXPECT_TRUE(sample.chance_of_missing_an_error(statistics::smallest_error, fit_draws) <= 1e-3) << c;
    for (std::uint32_t i = 0; i < fit_draws; ++i)
        sample.add(static_cast<double>(exact_binomial{}(trials, probability, uniform_stream<Real>{seed, i}).successes));
    const auto fit = sample.judge();
    EXPECT_TRUE(statistics::passes(fit.p_value))
        << c << ": p-value " << fit.p_value << ", worst at " << sample.cells().start_of(fit.worst_cell)
        << "; reproduced by " << fit_draws << " draws exact_binomial{}(" << c.trials << ", " << c.probability
        << ", uniform_stream<" << (sizeof(Real) == 4 ? "float" : "double") << ">{" << seed << ", i})";
}

/// Inversion (N min(p, q) < 10) and BTRS, both sides of the switch between them and of 1/2, and cases on which real
/// libraries went wrong (MS STL #1001 and #1530).
constexpr binomial_case integer_cases[] = {{1, 0.5},         {1, 0.01},          {2, 0.3},
                                           {3, 0.999},       {10, 0.5},          {19, 0.5},
                                           {20, 0.5},        {21, 0.5},          {25, 0.9996},
                                           {40, 0.5},        {40, 0.2499},       {40, 0.2501},
                                           {64, 1. / 64},    {100, 0.0999},      {100, 0.1001},
                                           {100, 0.9},       {100, 0.9001},      {1000, 0.001238},
                                           {1000, 0.5001},   {1000, 0.25},       {1000, 0.99},
                                           {10'000, 0.002},  {100'000, 0.00009}, {1'000'000, 1e-6},
                                           {1'000'000, 0.5}, {1'000'000, 0.3},   {1'000'000, 0.999989}};

TEST(ExactBinomial, FollowsTheBinomialInDouble) {
    for (const binomial_case& c : integer_cases) expect_exact_law<double>(c, 1U);
}

TEST(ExactBinomial, FollowsTheBinomialInFloat) {
    for (const binomial_case& c : integer_cases) expect_exact_law<float>(c, 2U);
}

/// Real N: the mixture of floor(N) and floor(N) + 1 trials with mean N.
constexpr binomial_case real_cases[] = {{0.05, 0.3}, {0.5, 0.5},  {0.5, 0.9}, {1.5, 0.2},
                                        {1.5, 0.8},  {2.5, 0.75}, {7.3, 0.4}, {7.3, 0.95}};

TEST(ExactBinomial, MixesTheNeighbouringIntegersAtRealTrials) {
    for (const binomial_case& c : real_cases) expect_exact_law<double>(c, 3U);
    for (const binomial_case& c : real_cases) expect_exact_law<float>(c, 4U);
}

TEST(ExactBinomial, FollowsTheBinomialInEveryLane) {
    using Pack = mica::pack<float, 8>;
    statistics::binomial_sample sample({60, 0.375});
    for (std::uint32_t i = 0; i < fit_draws; i += 8) {
        uniform_stream<Pack> xi{mica::index_of<Pack>(5U), mica::index_of<Pack>::iota(i)};
        const auto drawn = exact_binomial{}(Pack(60), Pack(0.375F), xi);
        for (int j = 0; j < 8; ++j) sample.add(static_cast<double>(drawn.successes[j]));
    }
    EXPECT_TRUE(statistics::passes(sample.judge().p_value));
}

/// Consecutive draws of one stream, as std::-style generators are used, instead of consecutive indices.
TEST(ExactBinomial, FollowsTheBinomialAlongOneStream) {
    for (const binomial_case& c : {binomial_case{12, 0.4}, binomial_case{300, 0.4}}) {
        uniform_stream<double> xi{6U};
        const auto fit = statistics::fit_of(
            c, [&](std::uint32_t) { return exact_binomial{}(c.trials, c.probability, xi).successes; });
        EXPECT_TRUE(statistics::passes(fit.p_value)) << c << ": " << fit.p_value;
    }
}

/// The probability of every count, found by bisection and quadrature over the uniforms and not by draws: inversion to
/// the resolution of the uniforms, rejection to that of the quadrature.
TEST(ExactBinomial, HasTheProbabilityOfEveryCount) {
    double worst = 0;
    for (const auto& [trials, probability] : {std::pair{1.F, 0.5F},
                                              {3.F, 0.999F},
                                              {25.F, 0.3F},
                                              {40.F, 0.2499F},
                                              {40.F, 0.2501F},
                                              {40.F, 0.5F},
                                              {100.F, 0.9F},
                                              {1000.F, 0.003F},
                                              {1000.F, 0.25F},
                                              {1000.F, 0.99F},
                                              {1e5F, 1e-4F},
                                              {1e5F, 2e-4F},
                                              {1e9F, 3e-8F}}) {
        const auto found = enumeration::deviation_of<exact_binomial>(trials, probability);
        EXPECT_TRUE(found.total_variation <= 1e-8) << trials << ' ' << probability << ": " << found.total_variation;
        worst = std::fmax(worst, found.total_variation);
    }
    std::printf("largest total variation %.2g\n", worst);
}

/// From the count of uniforms: constant expected time at every N, in either of the two algorithms.
TEST(ExactBinomial, CostDoesNotGrowWithTheTrials) {
    const auto draws_at = [](double trials, double probability) {
        constexpr int samples = 1 << 16;
        uniform_stream<double> stream{23U};
        double drawn = 0;
        for (int i = 0; i < samples; ++i)
            exact_binomial{}(trials, probability, [&] {
                drawn += 1;
                return stream();
            });
        return drawn / samples;
    };
    for (const double trials : {1e3, 1e4, 1e6, 1e9, 1e12, 1e15}) {
        EXPECT_EQ(draws_at(trials, 5 / trials), 1) << trials;
        EXPECT_TRUE(draws_at(trials, 0.3) <= 1.05 * draws_at(100, 0.3)) << trials << ": " << draws_at(trials, 0.3);
        EXPECT_TRUE(draws_at(trials, 50 / trials) <= 1.05 * draws_at(100, 0.5)) << trials;
    }
    EXPECT_TRUE(draws_at(100, 0.3) < 3) << draws_at(100, 0.3);
}

// exact_binomial where Boost.Math is slow or has no digits

constexpr std::uint32_t moment_draws = 1 << 18;

/// With 2^18 draws the mean is known to 0.002 deviations, the variance to 0.3 %; seen for sure are 0.02 and 3 %.
TEST(ExactBinomial, HasTheMomentsOfHugeTrials) {
    for (const binomial_case& c : {binomial_case{1e9, 0.5},
                                   {1e9, 0.999},
                                   {1e12, 0.3},
                                   {1e12, 1e-10},
                                   {1e15, 0.5},
                                   {1e15, 0.7},
                                   {1e15, 1e-13},
                                   {0x1p53, 0.25}}) {
        const double variance = c.trials * c.probability * (1 - c.probability);
        statistics::running_moments sample;
        for (std::uint32_t i = 0; i < moment_draws; ++i) {
            const auto drawn = exact_binomial{}(c.trials, c.probability, uniform_stream<double>{9U, i});
            EXPECT_EQ(drawn.successes + drawn.failures, c.trials);
            // From the mean, because 1e15 and its square leave no digits for a variance.
            sample.add(drawn.successes - c.trials * c.probability);
        }
        EXPECT_TRUE(statistics::passes(statistics::mean_p_value(sample, 0, std::sqrt(variance))))
            << c << ": mean off by " << sample.mean() / std::sqrt(variance) << " deviations";
        EXPECT_TRUE(statistics::passes(statistics::variance_p_value(sample, variance)))
            << c << ": variance " << sample.variance() / variance << " of that of the law";
    }
}

TEST(ExactBinomial, FollowsTheBinomialAtHugeTrials) {
    expect_exact_law<double>({1e9, 1e-8}, 10U);
    expect_exact_law<double>({1e9, 0.4}, 11U);
    expect_exact_law<float>({4294967296., 1e-9}, 12U);
}

/// boostorg/random #81: a mean of 4.013 from more trials than a double counts.
TEST(ExactBinomial, KeepsTheMeanOfMoreThan2To53Trials) {
    expect_exact_law<double>({6.4e16, 6.27e-17}, 13U);
    const auto drawn = exact_binomial{}(std::numeric_limits<double>::max(), 0.25, uniform_stream<double>{13U});
    EXPECT_TRUE(drawn.successes > 0 && drawn.failures > drawn.successes); // and it ends
}

/// The successes at xi = uniform_from_bits(bits), for a law that reads one uniform.
template <class Law>
float successes_at(std::uint32_t bits, float trials, float probability) {
    scripted_uniforms<float, 1> xi{{mica::uniform_from_bits<float>(bits)}};
    const float successes = Law{}(trials, probability, xi).successes;
    EXPECT_EQ(xi.drawn, 1U);
    return successes;
}

/// How many of the 2^32 equally likely patterns of bits give at least k successes: they are the smallest.
template <class Law>
std::uint32_t patterns_with_at_least(float k, float trials, float probability) {
    std::uint32_t low = 0;
    std::uint32_t high = 0xffffffffU;
    while (low < high) {
        const std::uint32_t middle = low + (high - low) / 2;
        if (successes_at<Law>(middle, trials, probability) >= k)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/// All float uniforms there are, by bisection: the mean at N p = 1e-6 to the resolution of the stream, half of 2^-31.
/// Among them N = 5e10, p = 5e-17, and tiny p, in whose inversion a real library looped for ever (rand #1324).
TEST(ExactBinomial, KeepsTheMeanOfRareEvents) {
    for (const binomial_case& c : {binomial_case{1, 1e-6},
                                   {1000, 1e-9},
                                   {1e9, 1e-15},
                                   {5e10, 5e-17},
                                   {1e15, 1e-21},
                                   {1e6, 1e-14},
                                   {1e15, 1e-30}}) {
        const auto trials = static_cast<float>(c.trials);
        const auto probability = static_cast<float>(c.probability);
        const double mean = static_cast<double>(trials) * static_cast<double>(probability);
        double found = 0;
        for (int k = 1; k <= 3; ++k)
            found += patterns_with_at_least<exact_binomial>(static_cast<float>(k), trials, probability) * 0x1p-32;
        EXPECT_TRUE(std::abs(found - mean) <= 0x1p-31) << c << ": " << found;
    }
}

TEST(ExactBinomial, NearlyCertainSuccessIsNearlyCertain) {
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const auto drawn = exact_binomial{}(1e15, 1 - 0x1p-53, uniform_stream<double>{14U, i});
        EXPECT_TRUE(drawn.failures <= 5) << drawn.failures;
        EXPECT_EQ(drawn.successes + drawn.failures, 1e15);
    }
}

// exact_binomial: what holds in every outcome

TEST(ExactBinomial, CountsAreIntegersThatSumToTheTrials) {
    for (const double n : {0., 1., 2., 7.3, 39.5, 1000.25, 1e6}) {
        for (const double p : {0., 1e-9, 0.1, 0.5, 0.9, 1.}) {
            for (std::uint32_t i = 0; i < 2000; ++i) {
                const auto [successes, failures] = exact_binomial{}(n, p, uniform_stream<double>{15U, i});
                const double sum = successes + failures;
                EXPECT_TRUE(successes >= 0 && failures >= 0 && successes == std::floor(successes)) << n << ' ' << p;
                EXPECT_TRUE(sum == std::floor(n) || sum == std::ceil(n)) << n << ' ' << p << ' ' << sum;
            }
        }
    }
}

/// Rejection may read any number of uniforms; the caller's stream moves by one all the same.
TEST(ExactBinomial, MovesAStreamByOneDraw) {
    for (const binomial_case& c : {binomial_case{0, 0.5}, {10, 0}, {7.3, 0.4}, {1000, 0.4}, {1e6, 1}}) {
        uniform_stream<float> used{16U, 3U};
        uniform_stream<float> moved{16U, 3U};
        exact_binomial{}(static_cast<float>(c.trials), static_cast<float>(c.probability), used);
        moved();
        EXPECT_EQ(used.next_bits(), moved.next_bits()) << c;

        uniform_stream<double> used_double{16U, 3U};
        uniform_stream<double> forked{16U, 3U};
        exact_binomial{}(c.trials, c.probability, used_double);
        forked.fork();
        EXPECT_EQ(used_double.next_bits(), forked.next_bits()) << c;
    }
}

/// A plain callable that returns packs: lane i of every draw.
TEST(ExactBinomial, TakesACallableOfPacks) {
    using Pack = mica::pack<float, 4>;
    const auto constant = [] { return Pack::iota(0) * Pack(0.25F) + Pack(0.125F); };
    const auto packed = exact_binomial{}(Pack(10), Pack(0.5F), constant);
    for (int i = 0; i < 4; ++i) {
        const float u = static_cast<float>(i) * 0.25F + 0.125F;
        EXPECT_EQ(packed.successes[i], exact_binomial{}(10.F, 0.5F, [u] { return u; }).successes);
    }
}

/// Constant uniforms never satisfy the rejection; the law ends all the same.
TEST(ExactBinomial, EndsOnScriptedUniforms) {
    for (const float constant : {0x1p-32F, 0x1p-24F, 0.5F, 1 - 0x1p-24F})
        for (const float trials : {1.F, 100.F, 1000.F, 1e7F}) {
            const auto counts = exact_binomial{}(trials, 0.3F, [&] { return constant; });
            EXPECT_TRUE(counts.successes >= 0 && counts.failures >= 0);
            EXPECT_EQ(counts.successes + counts.failures, trials);
        }
}

} // namespace
