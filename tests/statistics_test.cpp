// tests/statistics_test.cpp: the tester tested. Its statistics against published values, and the negative controls: draws
// that are wrong by as little as the suite claims to see, each of which must fail.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "mica/law/dual_gated.hpp"
#include "mica/law/exact.hpp"
#include "mica/random/uniform_stream.hpp"

#include "binomial_fit.hpp"

namespace {

using mica::exact_binomial;
using mica::uniform_stream;
using statistics::binomial_case;
using statistics::significance;

/// Abramowitz & Stegun, table 26.8.
TEST(Statistics, ChiSquareAgreesWithPublishedQuantiles) {
    struct quantile {
        int degrees;
        double upper_tail;
        double chi_square;
    };
    for (const quantile& known : {quantile{1, 0.05, 3.84146}, quantile{1, 0.001, 10.828}, quantile{10, 0.05, 18.3070},
                                  quantile{10, 0.005, 25.1882}, quantile{30, 0.01, 50.8922},
                                  quantile{100, 0.05, 124.342}, quantile{100, 0.001, 149.449}}) {
        const double p_value = statistics::chi_square_p_value(known.chi_square, known.degrees);
        EXPECT_TRUE(std::abs(p_value / known.upper_tail - 1) <= 1e-3) << known.degrees << ' ' << p_value;
    }
}

TEST(Statistics, SidakSharesMultiplyToTheFamilyError) {
    EXPECT_TRUE(std::abs(statistics::sidak_share(1e-6, 1) / 1e-6 - 1) <= 1e-12);
    EXPECT_TRUE(std::abs(statistics::sidak_share(0.19, 2) / 0.1 - 1) <= 1e-12);
    EXPECT_TRUE(std::abs(statistics::sidak_share(1e-6, 2000) / 5e-10 - 1) <= 1e-5);
    EXPECT_TRUE(std::abs(statistics::sidak_smallest(statistics::sidak_share(1e-6, 700), 700) / 1e-6 - 1) <= 1e-9);
}

TEST(Statistics, PoolsEachTailOnItsOwn) {
    const std::vector<double> probabilities{0.001, 0.004, 0.02, 0.4, 0.55, 0.02, 0.005};
    const auto pools = statistics::pooled(probabilities, 1000, 10);
    ASSERT_EQ(pools.size(), 4U);
    EXPECT_EQ(pools.front().last, 3U);
    EXPECT_EQ(pools.back().first, 5U);
}

/// Table of Kolmogorov's limiting distribution (Smirnov 1948): 5 % at 1.3581, 1 % at 1.6276, .1 % at 1.9495.
TEST(Statistics, KolmogorovAgreesWithPublishedQuantiles) {
    for (const auto& [t, tail] : {std::pair{1.3581, 0.05}, {1.6276, 0.01}, {1.9495, 0.001}}) {
        const double p_value = statistics::kolmogorov_p_value(t / 100, 1e4);
        EXPECT_TRUE(std::abs(p_value / tail - 1) <= 1e-3) << t << ' ' << p_value;
    }
    EXPECT_EQ(statistics::kolmogorov_p_value(0, 1e4), 1);
    EXPECT_EQ(statistics::kolmogorov_p_value(std::numeric_limits<double>::quiet_NaN(), 1e4), 0);
}

/// Against sums over the probabilities of every count.
TEST(Statistics, MomentsOfTheBinomialAreItsSums) {
    for (const auto& [whole, part, p] : {std::array{0., 0.3, 0.4}, {1., 0., 0.2}, {7., 0.25, 0.7}, {60., 0.5, 0.1}}) {
        const auto found = statistics::binomial_moments(whole + part, p);
        double variance = 0, fourth = 0;
        for (int k = 0; k <= static_cast<int>(whole) + 1; ++k) {
            const auto at = [&, p = p](double n) { return statistics::binomial_probability(n, p, k); };
            const double d = k - found.mean, mass = (1 - part) * at(whole) + part * at(whole + 1);
            variance += mass * d * d;
            fourth += mass * d * d * d * d;
        }
        EXPECT_TRUE(std::abs(found.mean - (whole + part) * p) <= 1e-12);
        EXPECT_TRUE(std::abs(found.variance / variance - 1) <= 1e-10) << whole << ' ' << part;
        EXPECT_TRUE(std::abs(found.fourth / fourth - 1) <= 1e-10) << whole << ' ' << part;
    }
}

TEST(Statistics, MomentsAreThoseOfTheSample) {
    statistics::running_moments sample;
    for (const double x : {2., 4., 4., 4., 5., 5., 7., 9.}) sample.add(x);
    EXPECT_TRUE(std::abs(sample.mean() - 5) <= 1e-14);
    EXPECT_TRUE(std::abs(sample.variance() - 32. / 7) <= 1e-14);
}

// negative controls

constexpr binomial_case control{40, 0.5};

/// Whether draws that change(draw, i) made of exact ones are taken for binomial.
template <class Change>
bool passes_changed(double probability, Change change) {
    const auto fit = statistics::fit_of(control, [&](std::uint32_t i) {
        const uniform_stream<double> xi{7U, i};
        return change(exact_binomial{}(control.trials, probability, uniform_stream<double>(xi)).successes, i);
    });
    return fit.p_value >= significance();
}

double unchanged(double drawn, std::uint32_t) { return drawn; }

TEST(NegativeControl, UnchangedDrawsPass) { EXPECT_TRUE(passes_changed(control.probability, unchanged)); }

/// The designed effect: probabilities of the counts wrong by 1 % RMS, mean and variance hardly changed.
TEST(NegativeControl, ProbabilitiesOffByTheSmallestError) {
    const statistics::binomial_cells cells(control.trials, control.probability);
    const auto wrong = statistics::with_error(cells.probabilities(), statistics::smallest_error);
    std::vector<double> below;
    double sum = 0;
    for (const double probability : wrong) below.push_back(sum += probability);
    const auto fit = statistics::fit_of(control, [&](std::uint32_t i) {
        const double u = uniform_stream<double>{8U, i}() * sum;
        const auto cell = std::upper_bound(below.begin(), below.end(), u) - below.begin();
        return cells.start_of(static_cast<std::size_t>(cell));
    });
    EXPECT_TRUE(fit.p_value < significance());
}

/// A success probability that moves the mean by 1 % of a deviation.
TEST(NegativeControl, ProbabilityOffByTheEffect) {
    const double step = 0.01 * std::sqrt(control.probability * (1 - control.probability) / control.trials);
    EXPECT_TRUE(!passes_changed(control.probability + step, unchanged));
}

TEST(NegativeControl, SwappedSuccessesAndFailures) {
    EXPECT_TRUE(!passes_changed(0.499, [](double drawn, std::uint32_t) { return control.trials - drawn; }));
}

TEST(NegativeControl, OffByOne) {
    EXPECT_TRUE(!passes_changed(control.probability, [](double drawn, std::uint32_t) { return drawn + 1; }));
}

TEST(NegativeControl, Constant) {
    EXPECT_TRUE(!passes_changed(control.probability, [](double, std::uint32_t) { return 20.; }));
}

TEST(NegativeControl, NotANumber) {
    EXPECT_TRUE(!passes_changed(control.probability, [](double drawn, std::uint32_t i) {
        return i == 1000 ? std::numeric_limits<double>::quiet_NaN() : drawn;
    }));
}

TEST(NegativeControl, DroppedCell) {
    EXPECT_TRUE(
        !passes_changed(control.probability, [](double drawn, std::uint32_t) { return drawn == 11 ? 12 : drawn; }));
}

/// The lower tail moved to the upper one: what pooling in order of size cannot see.
TEST(NegativeControl, TailMovedToTheOtherSide) {
    EXPECT_TRUE(!passes_changed(
        control.probability, [](double drawn, std::uint32_t) { return drawn <= 9 ? control.trials - drawn : drawn; }));
}

TEST(NegativeControl, OutsideTheSupport) {
    for (const double outside : {-1., 41., 20.5})
        EXPECT_TRUE(!passes_changed(control.probability,
                                    [&](double drawn, std::uint32_t i) { return i == 1000 ? outside : drawn; }));
}

/// Every hundredth draw repeats the one before: each draw on its own is exact.
TEST(NegativeControl, NeighboursThatDependOnEachOther) {
    double before = 20;
    EXPECT_TRUE(!passes_changed(control.probability, [&](double drawn, std::uint32_t i) {
        if (i % 100 == 0) return before;
        return before = drawn;
    }));
}

/// One draw among a million in a cell of probability 1e-17: pooled with its neighbours it moves no chi-square; it is
/// seen as the farthest cell reached.
TEST(NegativeControl, OneImpossiblyFarDraw) {
    const std::vector<double> probabilities{0.5, 0.5 - 1e-4, 1e-4, 1e-17};
    const std::vector<double> possible{500'000, 499'900, 100, 0};
    const std::vector<double> impossible{500'000, 499'900, 99, 1};
    EXPECT_TRUE(statistics::goodness_of_fit(probabilities, possible).p_value >= significance());
    EXPECT_TRUE(statistics::goodness_of_fit(probabilities, impossible).p_value < significance());
}

/// A small shift of every one of many cells in the same direction: nothing to chi-square, which has a thousand degrees
/// of freedom to lose it in.
TEST(NegativeControl, ADriftAcrossManyCells) {
    constexpr std::size_t cells = 1000;
    const std::vector<double> even(cells, 1. / cells);
    std::vector<double> drifting(cells);
    for (std::size_t i = 0; i < cells; ++i) drifting[i] = std::round(1000 + 20 * (static_cast<double>(i) / 499.5 - 1));
    EXPECT_TRUE(statistics::goodness_of_fit(even, std::vector<double>(cells, 1000.)).p_value >= significance());
    EXPECT_TRUE(statistics::goodness_of_fit(even, drifting).p_value < significance());
}

/// The dual-gated law is no binomial; a fit that accepted it would see nothing.
TEST(NegativeControl, DualGatedLaw) {
    const auto fit = statistics::fit_of({16, 0.0625}, [](std::uint32_t i) {
        return std::round(mica::dual_gated_binomial{}(16., 0.0625, uniform_stream<double>{7U, i}).successes);
    });
    EXPECT_TRUE(fit.p_value < significance());
}

TEST(NegativeControl, MeansAndVariancesOfAnotherLaw) {
    constexpr int draws = 1 << 18;
    statistics::running_moments sample;
    for (std::uint32_t i = 0; i < draws; ++i)
        sample.add(exact_binomial{}(40., 0.5, uniform_stream<double>{8U, i}).successes);
    auto law = statistics::binomial_moments(40, 0.5);
    EXPECT_TRUE(statistics::mean_p_value(sample, law) >= significance());
    EXPECT_TRUE(statistics::variance_p_value(sample, law) >= significance());
    EXPECT_TRUE(statistics::variance_p_value(sample, 10) >= significance());
    law.mean += 0.04 * std::sqrt(10.);
    law.variance *= 1.04;
    EXPECT_TRUE(statistics::mean_p_value(sample, law) < significance());
    EXPECT_TRUE(statistics::variance_p_value(sample, law) < significance());
    EXPECT_TRUE(statistics::variance_p_value(sample, 10 * 1.04) < significance());
    EXPECT_TRUE(statistics::mean_p_value(sample, std::numeric_limits<double>::quiet_NaN(), 1) == 0);
}

} // namespace
