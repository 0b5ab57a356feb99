// tests/quantile_test.cpp: quantile_binomial against the binomial, computed and not sampled.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include <gtest/gtest.h>

#include <mica/law/quantile.hpp>
#include <mica/random/uniform_stream.hpp>

#include "enumeration.hpp"
#include "scripted_uniforms.hpp"
#include "stated_grid.hpp"

namespace {

using enumeration::deviation_of;
using enumeration::last_uniform;
using enumeration::uniform_number;
using mica::quantile_binomial;

/// Successes at one uniform; the second, for the rounding of real trials, rounds down.
template <class Law>
double successes_at(float trials, float probability, uniform_number number) {
    return static_cast<double>(enumeration::outcome_at<Law>(trials, probability, last_uniform, number).successes);
}

template <int Gates>
void expect_deviation_at_most(double total_variation, double mean, double variance) {
    stated_grid::worst_case worst;
    stated_grid::each(
        [&](float trials, float p) {
            const auto found = stated_grid::deviation_of<quantile_binomial<Gates>>(trials, p);
            EXPECT_TRUE(found.total_variation <= total_variation) << trials << ' ' << p << ' ' << found.total_variation;
            EXPECT_TRUE(found.mean <= mean) << trials << ' ' << p << ' ' << found.mean;
            EXPECT_TRUE(found.variance <= variance) << trials << ' ' << p << ' ' << found.variance;
            worst.see(found);
        },
        1.1);
    std::printf("%d gates: total variation %.2g, mean %.2g, variance %.2g\n", Gates, worst.total_variation, worst.mean,
                worst.variance);
}

TEST(QuantileBinomial, OneGateIsAsCloseAsStated) { expect_deviation_at_most<1>(5e-3, 5e-2, 1.5e-1); }
TEST(QuantileBinomial, TwoGatesAreAsCloseAsStated) { expect_deviation_at_most<2>(6e-4, 4e-3, 1.9e-2); }
TEST(QuantileBinomial, ThreeGatesAreAsCloseAsStated) { expect_deviation_at_most<3>(2e-4, 4e-4, 2.6e-3); }
TEST(QuantileBinomial, FourGatesAreAsCloseAsStated) { expect_deviation_at_most<4>(1e-4, 5e-5, 4e-4); }
TEST(QuantileBinomial, EightGatesAreAsCloseAsStated) { expect_deviation_at_most<8>(3e-5, 3e-5, 1.5e-4); }
TEST(QuantileBinomial, SixteenGatesAreAsCloseAsStated) { expect_deviation_at_most<16>(1e-5, 3e-5, 1.5e-4); }

/// Two gates less, or a rounded Gaussian, is seen by the same measure.
struct rounded_gaussian {
    static constexpr bool integer_counts = true;

    template <class Xi>
    mica::counts<float> operator()(float n, float p, Xi&& xi) const {
        const float z = -mica::normal_quantile(xi());
        const float drawn = mica::clamp(mica::floor(n * p + std::sqrt(n * p * (1 - p)) * z + 0.5F), 0.F, n);
        return {drawn, n - drawn};
    }
};

TEST(QuantileBinomial, TheMeasureSeesWorseLaws) {
    EXPECT_TRUE(deviation_of<quantile_binomial<2>>(1e5F, 4e-6F).total_variation >= 2e-4);
    EXPECT_TRUE(deviation_of<rounded_gaussian>(1000, 0.003F).total_variation >= 0.05);
}

TEST(QuantileBinomial, KeepsTheMeanOfRareEvents) {
    for (const float trials : {1.F, 5.F, 1e4F, 1e12F, 1e16F}) {
        const auto mean_error = [&](double mean) {
            const auto p = static_cast<float>(mean / static_cast<double>(trials));
            return std::abs(deviation_of<quantile_binomial<4>>(trials, p).mean - 1);
        };
        EXPECT_TRUE(mean_error(1e-6) <= 1e-3) << trials << ' ' << mean_error(1e-6);
        EXPECT_TRUE(mean_error(1e-8) <= 5e-2) << trials << ' ' << mean_error(1e-8);
    }
}

/// boostorg/random #81; and N = 5e10, p = 5e-17, whose mean is 2.5e-6.
TEST(QuantileBinomial, KeepsTheMeanOfHugeTrials) {
    const auto mean = [](float n, float p) { return enumeration::enumerate<quantile_binomial<4>>::of(n, p).mean(); };
    EXPECT_TRUE(std::abs(mean(6.4e16F, 6.27e-17F) - 4.013) <= 0.04) << mean(6.4e16F, 6.27e-17F);
    EXPECT_TRUE(std::abs(mean(5e10F, 5e-17F) / 2.5e-6 - 1) <= 1e-3) << mean(5e10F, 5e-17F);
    for (const float p : {1e-16F, 1e-10F, 1e-4F, 0.3F, 0.5F, 0.9F}) {
        const auto found = deviation_of<quantile_binomial<4>>(1e16F, p);
        EXPECT_TRUE(std::abs(found.mean - 1) <= 1.2e-3) << p << ' ' << found.mean;
        // From a mean of 2^24 on counts are rounded, by more than the spread where the mean is beyond 2^48.
        if (1e16F * p <= 0x1p40F) {
            EXPECT_TRUE(std::abs(found.variance - 1) <= 9e-3) << p << ' ' << found.variance;
        }
    }
}

/// Where 1 - xi rounds to 1 the rarer failures are at their fewest, not at all N (which, at a probability of 3e-8, was
/// once +20 % of the variance at N = 1e7).
TEST(QuantileBinomial, KeepsToTheTailsOfManyTrials) {
    for (const float trials : {100.F, 1e4F, 1e6F, 1e7F})
        for (const float p : {0.1F, 0.4F, 0.5F, 0.6F, 0.9F}) {
            const double mean = static_cast<double>(trials) * static_cast<double>(p);
            const double deviation = std::sqrt(mean * (1 - static_cast<double>(p)));
            for (const uniform_number number : {uniform_number{0}, uniform_number{1}, last_uniform}) {
                const double z = (successes_at<quantile_binomial<4>>(trials, p, number) - mean) / deviation;
                EXPECT_TRUE(std::abs(z) >= 3 && std::abs(z) <= 8) << trials << ' ' << p << ' ' << number << ' ' << z;
            }
            const auto found = deviation_of<quantile_binomial<4>>(trials, p);
            EXPECT_TRUE(std::abs(found.variance - 1) <= 1e-3) << trials << ' ' << p << ' ' << found.variance;
        }
}

/// In xi, N and p, so that neighbouring pixels with the same uniform agree: random places and steps of every size.
template <int Gates>
void expect_monotone() {
    const auto at = [](float trials, float probability, float xi) {
        return quantile_binomial<Gates>{}(trials, probability, scripted_uniforms<float, 2>{{xi, 0.5F}}).successes;
    };
    for (std::uint32_t i = 0; i < 400'000; ++i) {
        mica::uniform_stream<float> choose{41U, i};
        const float trials = std::floor(std::exp2(20 * choose() * choose())) + static_cast<float>(i % 7);
        const float p = i % 3 ? choose() : std::exp2(-20 * choose());
        const float xi = choose();
        const float here = at(trials, p, xi);
        EXPECT_TRUE(here <= at(trials + 1, p, xi)) << trials << ' ' << p << ' ' << xi;
        const float larger = std::min(1.F, p * (1 + 0.1F * choose() * choose()));
        EXPECT_TRUE(here <= at(trials, larger, xi)) << trials << ' ' << p << ' ' << larger << ' ' << xi;
        const float later = std::min(largest_uniform<float>, xi * (1 + 0.1F * choose()));
        EXPECT_TRUE(here >= at(trials, p, later)) << trials << ' ' << p << ' ' << xi << ' ' << later;
    }
}

TEST(QuantileBinomial, IsMonotone) {
    expect_monotone<1>();
    expect_monotone<4>();
    expect_monotone<8>();
}

TEST(QuantileBinomial, CountsAreIntegersThatSumToTheTrials) {
    for (const float trials : {0.F, 0.05F, 0.999F, 1.F, 2.5F, 17.F, 1e4F, 0x1p24F})
        for (const float p : {0.F, 1e-38F, 1e-16F, 0.3F, 0.5F, 0.50001F, 1 - 0x1p-24F, 1.F})
            each_extreme_pair<float>([&](float xi, float rounding) {
                const auto [successes, failures] =
                    quantile_binomial<4>{}(trials, p, scripted_uniforms<float, 2>{{xi, rounding}});
                const float whole = std::floor(trials);
                EXPECT_EQ(successes, std::floor(successes));
                EXPECT_EQ(successes + failures, whole + (rounding < trials - whole ? 1.F : 0.F)) << trials << ' ' << p;
            });
}

TEST(QuantileBinomial, RealTrialsHaveTheirMean) {
    for (const float trials : {0.05F, 0.5F, 0.999F, 1.5F, 2.5F, 7.3F, 1000.4F})
        for (const float p : {0.002F, 0.05F, 0.3F, 0.5F, 0.8F}) {
            const auto found = deviation_of<quantile_binomial<4>>(trials, p);
            EXPECT_TRUE(std::abs(found.mean - 1) <= 1.3e-3) << trials << ' ' << p << ' ' << found.mean;
            EXPECT_TRUE(found.total_variation <= 8e-4) << trials << ' ' << p << ' ' << found.total_variation;
        }
}

} // namespace
