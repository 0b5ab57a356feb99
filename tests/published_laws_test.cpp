// The published laws follow their formulas, with the defects that were measured on them, and the gates theirs.
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/bernoulli_sum.hpp>
#include <mica/law/floored_gated.hpp>
#include <mica/law/gated.hpp>
#include <mica/law/gaussian.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/random/uniform_stream.hpp>

#include "enumeration.hpp"
#include "scripted_uniforms.hpp"

namespace {

double none_succeeds(float trials, float probability) {
    return std::exp(static_cast<double>(trials) * std::log1p(-static_cast<double>(probability)));
}

TEST(GatedBinomial, HasThePublishedMeanAndVariance) {
    struct row {
        float trials, probability;
        double mean, variance; // over N p and N p q, spec of the published defects
    };
    for (const row& r : {row{4, 0.25F, 1.239, 1.331}, row{16, 0.0625F, 1.298, 1.447}, row{64, 0.015625F, 1.312, 1.475},
                         row{1000, 0.001F, 1.317, 1.483}, row{1000, 0.05F, 1.019, 0.999}}) {
        const auto found = enumeration::deviation_of<mica::gated_binomial>(r.trials, r.probability);
        EXPECT_TRUE(std::abs(found.mean - r.mean) <= 6e-4) << r.trials << ' ' << found.mean;
        EXPECT_TRUE(std::abs(found.variance - r.variance) <= 6e-4) << r.trials << ' ' << found.variance;
    }
}

TEST(GatedBinomial, BelowOneTrialIsOneFacetThatMayBeThere) {
    for (const float xi : {smallest_uniform<float>, 0.1F, 0.14F, 0.16F, 0.6F, 0.64F, 0.66F, largest_uniform<float>}) {
        const auto counts = mica::gated_binomial{}(0.5F, 0.3F, [&] { return xi; });
        EXPECT_EQ(counts.successes, xi < 0.15F ? 1 : 0) << xi;
        EXPECT_EQ(counts.failures, xi >= 0.65F ? 1 : 0) << xi;
    }
}

/// What the headers say of the means, over N p.
TEST(PublishedLaws, HaveTheStatedMeanErrors) {
    const auto mean_is = [](const enumeration::deviation& found, double stated, double rounding) {
        EXPECT_TRUE(std::abs(found.mean - stated) <= rounding) << found.mean << " instead of " << stated;
    };
    mean_is(enumeration::deviation_of<mica::gaussian_binomial>(1000, 1e-3F), 1.08, 0.005);
    mean_is(enumeration::deviation_of<mica::gaussian_binomial>(1000, 1e-4F), 1.82, 0.005);
    mean_is(enumeration::deviation_of<mica::floored_gated_binomial>(1000, 3e-3F), 1.12, 0.006);
    mean_is(enumeration::deviation_of<mica::floored_gated_binomial>(1000, 3e-4F), 0.95, 0.006);
    mean_is(enumeration::deviation_of<mica::bernoulli_sum_binomial>(1000, 1e-3F), 0.68, 0.005);
}

/// DB23 Eq. 18 written down once more, in double.
double floored_gated_by_formula(double n, double p, double xi1, double z) {
    if (!(xi1 < 1 - std::pow(1 - p, n))) return 0;
    const double gaussian = (n - 1) * p + std::sqrt(std::fmax(0, (n - 1) * p * (1 - p))) * z;
    return std::fmin(1 + std::floor(std::fmin(std::fmax(gaussian, 0), n)), std::ceil(n));
}

TEST(FlooredGatedBinomial, FollowsItsFormula) {
    int different = 0;
    for (std::uint32_t i = 0; i < 20000; ++i) {
        mica::uniform_stream<float> choose{11, i};
        const float trials = std::floor(std::exp2(12 * choose())), p = choose();
        const std::array<float, 2> xi{choose(), choose()};
        std::size_t drawn = 0;
        const auto counts = mica::floored_gated_binomial{}(trials, p, [&] { return xi[drawn++]; });
        EXPECT_EQ(drawn, 2U);
        const double expected =
            floored_gated_by_formula(static_cast<double>(trials), static_cast<double>(p), static_cast<double>(xi[0]),
                                     statistics::normal_quantile(static_cast<double>(xi[1])));
        different += static_cast<double>(counts.successes) != expected; // next to a step, by rounding
        EXPECT_NEAR(static_cast<double>(counts.successes), expected, 1);
        EXPECT_EQ(counts.successes + counts.failures, trials);
    }
    EXPECT_LE(different, 20);
}

TEST(GaussianBinomial, FollowsItsFormula) {
    for (std::uint32_t i = 0; i < 20000; ++i) {
        mica::uniform_stream<float> choose{12, i};
        const float trials = std::exp2(20 * choose()), p = choose(), xi = choose();
        const auto counts = mica::gaussian_binomial{}(trials, p, [&] { return xi; });
        const double n = static_cast<double>(trials), mean = n * static_cast<double>(p);
        const double spread = std::sqrt(mean * (1 - static_cast<double>(p)));
        const double expected =
            std::fmin(std::fmax(mean + spread * statistics::normal_quantile(static_cast<double>(xi)), 0), n);
        EXPECT_NEAR(static_cast<double>(counts.successes), expected, 3e-6 * spread + 3e-7 * n);
        EXPECT_NEAR(counts.successes + counts.failures, trials, 1.2e-7F * trials); // one rounding
    }
}

TEST(BernoulliSumBinomial, IsExactForFewTrials) {
    for (const auto& [trials, p] : {std::pair{1.F, 0.3F}, {8.F, 0.3F}, {8.5F, 0.3F}, {16.F, 0.25F}, {16.F, 0.01F}}) {
        const auto found = enumeration::deviation_of<mica::bernoulli_sum_binomial>(trials, p);
        EXPECT_TRUE(found.total_variation <= 1e-7) << trials << ' ' << p << ' ' << found.total_variation;
    }
}

/// The floor takes half a count off the mean.
TEST(BernoulliSumBinomial, IsAFlooredGaussianBeyond) {
    for (const auto& [trials, p] : {std::pair{1000.F, 0.02F}, {17.F, 0.4F}, {16.F, 0.4F}}) {
        const auto table = enumeration::enumerate<mica::bernoulli_sum_binomial>::of(trials, p);
        const double expected = static_cast<double>(trials) * static_cast<double>(p) - 0.5;
        EXPECT_TRUE(std::abs(table.mean() - expected) <= 0.01) << trials << ' ' << p << ' ' << table.mean();
    }
}

template <class Gate>
double largest_error_of_none() {
    double worst = 0;
    for (double n = 1; n <= 1.0001e16; n *= 1.37)
        for (double p = 1e-16; p <= 1; p *= 1.13) {
            const auto trials = static_cast<float>(n), probability = static_cast<float>(p);
            const double found = static_cast<double>(Gate::none(trials, probability));
            worst = std::fmax(worst, std::abs(found - none_succeeds(trials, probability)));
        }
    return worst;
}

/// KK25 Fig. 5, and the default beside it.
TEST(Gates, HaveTheirPublishedErrors) {
    EXPECT_GE(largest_error_of_none<mica::naive_gate>(), 0.99);
    const double scaled = largest_error_of_none<mica::scaled_gate>();
    EXPECT_TRUE(scaled > 7e-5 && scaled < 9e-5) << scaled;
    EXPECT_LE(largest_error_of_none<mica::log1p_gate>(), 1e-7);
}

template <class Gate>
void expect_ends() {
    EXPECT_EQ(Gate::none(0.F, 0.3F), 1);
    EXPECT_EQ(Gate::none(5.F, 0.F), 1);
    EXPECT_EQ(Gate::none(0.5F, 1.F), 0);
    EXPECT_EQ(Gate::none(0.F, 1.F), 1);
    EXPECT_EQ(Gate::any(5.F, 0.F), 0);
    EXPECT_EQ(Gate::any(1e16F, 1.F), 1);
}

TEST(Gates, AreExactAtTheEnds) {
    expect_ends<mica::naive_gate>();
    expect_ends<mica::scaled_gate>();
    expect_ends<mica::log1p_gate>();
}

} // namespace
