// tests/multinomial_test.cpp: multinomial counts. With exact_binomial the joint law against Boost.Math, category by
// category and together; with both laws what holds in every outcome, rare and impossible categories, and bad input.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "mica/law/dual_gated.hpp"
#include "mica/law/exact.hpp"
#include "mica/law/multinomial.hpp"
#include "mica/numeric/pack.hpp"
#include "mica/random/uniform_stream.hpp"

#include "statistics.hpp"

namespace {

using mica::dual_gated_binomial;
using mica::exact_binomial;
using mica::multinomial;
using mica::uniform_stream;

/// Probabilities proportional to 1, 2, 3, 1, 2, 3, ..., as multiples of 2^-20, so that every sum is exact; they add up
/// to exactly 1.
template <class Real, std::size_t K>
std::array<Real, K> dyadic_probabilities() {
    std::array<Real, K> p{};
    Real total = 0;
    for (std::size_t k = 0; k + 1 < K; ++k) {
        p[k] = std::floor(Real(k % 3 + 1) * Real(0x1p20) / Real(2 * K + 1)) * Real(0x1p-20);
        total += p[k];
    }
    p[K - 1] = 1 - total;
    return p;
}

template <class Counts>
double total(const Counts& counts) {
    double sum = 0;
    for (const auto count : counts) sum += static_cast<double>(count);
    return sum;
}

/// The outcome of the dynamic multinomial.
template <class Law, class Real, std::size_t K, class Uniform>
std::array<Real, K> drawn_dynamically(Real trials, const std::array<Real, K>& p, Uniform&& xi) {
    std::array<Real, K> counts{};
    multinomial<std::dynamic_extent, Law>{}(trials, std::span<const Real>(p), xi, std::span<Real>(counts));
    return counts;
}

// what holds in every outcome

template <std::size_t K, class Real>
void expect_sum_is_trials() {
    const auto p = dyadic_probabilities<Real, K>();
    for (const Real n : {Real(0), Real(1), Real(2), Real(17), Real(1000), Real(1e6), Real(0x1p24)}) {
        for (std::uint32_t i = 0; i < 200; ++i) {
            const auto counts = multinomial<K, exact_binomial>{}(n, p, uniform_stream<Real>{1U, i});
            EXPECT_EQ(total(counts), static_cast<double>(n)) << "K = " << K;
            for (const Real count : counts) EXPECT_TRUE(count >= 0 && count == std::floor(count)) << count;
        }
    }
}

template <class Real>
void expect_sum_is_trials_for_every_size() {
    expect_sum_is_trials<1, Real>();
    expect_sum_is_trials<2, Real>();
    expect_sum_is_trials<3, Real>();
    expect_sum_is_trials<4, Real>();
    expect_sum_is_trials<5, Real>();
    expect_sum_is_trials<8, Real>();
    expect_sum_is_trials<16, Real>();
}

TEST(Multinomial, CountsSumToIntegerTrials) {
    expect_sum_is_trials_for_every_size<float>();
    expect_sum_is_trials_for_every_size<double>();
}

/// Sums to the one or the other neighbouring integer, with mean N.
TEST(Multinomial, CountsSumToRoundedRealTrials) {
    constexpr int draws = 1 << 17;
    const auto p = dyadic_probabilities<double, 5>();
    for (const double n : {0.05, 0.5, 1.5, 7.3}) {
        double more = 0;
        for (std::uint32_t i = 0; i < draws; ++i) {
            const double sum = total(multinomial<5, exact_binomial>{}(n, p, uniform_stream<double>{2U, i}));
            EXPECT_TRUE(sum == std::floor(n) || sum == std::floor(n) + 1) << n << ": " << sum;
            if (sum > n) more += 1;
        }
        EXPECT_TRUE(statistics::passes(statistics::binomial_p_value(more, draws, n - std::floor(n))))
            << n << ": " << more / draws;
    }
}

template <std::size_t K, class Law, class Real>
void expect_same_statically_and_dynamically() {
    auto p = dyadic_probabilities<Real, K>();
    for (const Real scale : {Real(1), Real(0.75)}) {
        for (Real& probability : p) probability *= scale;
        for (const Real n : {Real(0), Real(0.7), Real(1.5), Real(2), Real(37), Real(1e6), Real(1e9)}) {
            for (std::uint32_t i = 0; i < 64; ++i) {
                const auto fixed = multinomial<K, Law>{}(n, p, uniform_stream<Real>{3U, i});
                EXPECT_EQ(fixed, (drawn_dynamically<Law>(n, p, uniform_stream<Real>{3U, i}))) << K << ' ' << n;
            }
        }
    }
}

template <class Law, class Real>
void expect_same_statically_and_dynamically_for_every_size() {
    expect_same_statically_and_dynamically<1, Law, Real>();
    expect_same_statically_and_dynamically<2, Law, Real>();
    expect_same_statically_and_dynamically<3, Law, Real>();
    expect_same_statically_and_dynamically<4, Law, Real>();
    expect_same_statically_and_dynamically<5, Law, Real>();
    expect_same_statically_and_dynamically<8, Law, Real>();
    expect_same_statically_and_dynamically<16, Law, Real>();
}

TEST(Multinomial, IsTheSameForStaticAndDynamicSizes) {
    expect_same_statically_and_dynamically_for_every_size<exact_binomial, float>();
    expect_same_statically_and_dynamically_for_every_size<exact_binomial, double>();
    expect_same_statically_and_dynamically_for_every_size<dual_gated_binomial, float>();
    expect_same_statically_and_dynamically_for_every_size<dual_gated_binomial, double>();
}

/// Lanes with trials and probabilities of their own; some sum to 1, some to less, some to a little more.
template <std::size_t K, class Law, class Pack>
void expect_lanes_equal_scalars() {
    using Real = typename Pack::value_type;
    using Bits = mica::bits_of<Real>;
    using Index = mica::index_of<Pack>;
    constexpr int lanes = mica::lanes_of<Pack>;
    constexpr Real scales[] = {Real(1), Real(0.5), Real(1) + std::numeric_limits<Real>::epsilon(), Real(0)};
    constexpr Real sizes[] = {Real(1000), Real(0.5), Real(3), Real(1.25), Real(1e9), Real(17.5), Real(0)};
    for (std::uint32_t i = 0; i < 256; ++i) {
        Pack trials(0);
        std::array<Pack, K> packed{};
        std::array<std::array<Real, K>, lanes> scalar{};
        for (int j = 0; j < lanes; ++j) {
            const auto lane = static_cast<std::size_t>(j);
            trials.set(j, sizes[(i + lane) % std::size(sizes)]);
            scalar[lane] = dyadic_probabilities<Real, K>();
            for (std::size_t k = 0; k < K; ++k) {
                scalar[lane][k] *= scales[(i / 7 + lane) % std::size(scales)];
                packed[k].set(j, scalar[lane][k]);
            }
        }
        const uniform_stream<Pack> xi{Index(4U), Index::iota(i)};
        const auto together = multinomial<K, Law>{}(trials, packed, uniform_stream<Pack>(xi));
        for (int j = 0; j < lanes; ++j) {
            const uniform_stream<Real> of_lane{4U, i + static_cast<std::uint32_t>(j)};
            const auto alone =
                multinomial<K, Law>{}(trials[j], scalar[static_cast<std::size_t>(j)], uniform_stream<Real>(of_lane));
            for (std::size_t k = 0; k < K; ++k)
                EXPECT_EQ(std::bit_cast<Bits>(together[k][j]), std::bit_cast<Bits>(alone[k]))
                    << "K = " << K << ", index " << i << ", lane " << j << ": " << together[k][j] << ", " << alone[k];
        }
    }
}

template <class Law>
void expect_lanes_equal_scalars_for_every_pack() {
    expect_lanes_equal_scalars<1, Law, mica::pack<float, 4>>();
    expect_lanes_equal_scalars<4, Law, mica::pack<float, 4>>();
    expect_lanes_equal_scalars<3, Law, mica::pack<float, 8>>();
    expect_lanes_equal_scalars<8, Law, mica::pack<float, 8>>();
    expect_lanes_equal_scalars<5, Law, mica::pack<double, 4>>();
}

TEST(Multinomial, GivesInEveryLaneWhatItGivesForScalars) {
    expect_lanes_equal_scalars_for_every_pack<exact_binomial>();
    expect_lanes_equal_scalars_for_every_pack<dual_gated_binomial>();
}

// categories that receive nothing

/// A category of probability 0 in every position, next to others whose probabilities sum to `sum`.
template <std::size_t K, class Law, class Real>
void expect_nothing_in_a_zero_category(Real sum) {
    for (std::size_t empty = 0; empty < K; ++empty) {
        std::array<Real, K> p{};
        Real rest = sum;
        for (std::size_t k = 0; k < K; ++k) {
            if (k == empty) continue;
            p[k] = rest / 2;
            rest -= p[k];
        }
        p[empty == 0 ? 1 : 0] += rest;
        for (const Real n : {Real(0.5), Real(1), Real(1.7), Real(3), Real(40), Real(1e6), Real(1e12)}) {
            for (std::uint32_t i = 0; i < 128; ++i) {
                const auto counts = multinomial<K, Law>{}(n, p, uniform_stream<Real>{5U, i});
                EXPECT_EQ(counts[empty], 0) << "category " << empty << " of " << K << ", N = " << n;
            }
        }
    }
}

template <class Law, class Real>
void expect_nothing_in_zero_categories() {
    for (const Real sum : {Real(1), Real(0.625), Real(1) + std::numeric_limits<Real>::epsilon()}) {
        expect_nothing_in_a_zero_category<2, Law>(sum);
        expect_nothing_in_a_zero_category<3, Law>(sum);
        expect_nothing_in_a_zero_category<5, Law>(sum);
        expect_nothing_in_a_zero_category<8, Law>(sum);
    }
}

TEST(Multinomial, GivesNothingToACategoryOfProbabilityZero) {
    expect_nothing_in_zero_categories<exact_binomial, float>();
    expect_nothing_in_zero_categories<exact_binomial, double>();
    expect_nothing_in_zero_categories<dual_gated_binomial, float>();
    expect_nothing_in_zero_categories<dual_gated_binomial, double>();
}

/// All in one category: every other one stays empty, and that one receives all.
TEST(Multinomial, GivesEverythingToACertainCategory) {
    for (std::size_t certain = 0; certain < 8; ++certain) {
        std::array<float, 8> p{};
        p[certain] = 1;
        std::array<float, 8> expected{};
        expected[certain] = 1000;
        for (std::uint32_t i = 0; i < 128; ++i) {
            EXPECT_EQ((multinomial<8, exact_binomial>{}(1000.F, p, uniform_stream<float>{6U, i})), expected);
            EXPECT_EQ((multinomial<8, dual_gated_binomial>{}(1000.F, p, uniform_stream<float>{6U, i})), expected);
        }
    }
}

template <class Law, class Real>
void expect_all_zero() {
    constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();
    constexpr std::array<Real, 4> zeros{};
    for (std::uint32_t i = 0; i < 128; ++i) {
        const uniform_stream<Real> xi{7U, i};
        const auto draw = [&](Real n, const std::array<Real, 4>& p) {
            return multinomial<4, Law>{}(n, p, uniform_stream<Real>(xi));
        };
        EXPECT_EQ(draw(Real(1000), {0, 0, 0, 0}), zeros);
        EXPECT_EQ(draw(Real(1000), {-1, -1, 0, -1}), zeros);
        EXPECT_EQ(draw(Real(1000), {nan, nan, nan, nan}), zeros);
        EXPECT_EQ(draw(nan, {0.25, 0.25, 0.25, 0.25}), zeros);
        EXPECT_EQ(draw(Real(-5), {0.25, 0.25, 0.25, 0.25}), zeros);
        EXPECT_EQ(draw(Real(0), {0.25, 0.25, 0.25, 0.25}), zeros);
    }
}

TEST(Multinomial, GivesNothingWhereThereIsNothingToGive) {
    expect_all_zero<exact_binomial, float>();
    expect_all_zero<exact_binomial, double>();
    expect_all_zero<dual_gated_binomial, float>();
    expect_all_zero<dual_gated_binomial, double>();
}

template <class Law, class Real>
void expect_bad_input_as_documented() {
    using limits = std::numeric_limits<Real>;
    using probabilities = std::array<Real, 4>;
    for (std::uint32_t i = 0; i < 128; ++i) {
        for (const Real n : {Real(0.5), Real(1.5), Real(100), Real(1e9)}) {
            const auto draw = [&](const probabilities& p) {
                const auto counts = multinomial<4, Law>{}(n, p, uniform_stream<Real>{8U, i});
                EXPECT_EQ(counts, (drawn_dynamically<Law>(n, p, uniform_stream<Real>{8U, i})));
                return counts;
            };
            const probabilities good{Real(0.25), 0, Real(0.5), 0};
            EXPECT_EQ(draw({Real(0.25), limits::quiet_NaN(), Real(0.5), -limits::infinity()}), draw(good));
            EXPECT_EQ(draw({Real(0.25), -1, Real(0.5), -limits::denorm_min()}), draw(good));
            EXPECT_EQ(draw({0, limits::infinity(), 0, 0}), draw({0, 1, 0, 0}));
        }
        for (const Real n : {limits::infinity(), (limits::max)()}) {
            const auto counts = multinomial<4, Law>{}(n, probabilities{Real(0.25), Real(0.25), Real(0.25), Real(0.125)},
                                                      uniform_stream<Real>{8U, i});
            for (const Real count : counts) EXPECT_TRUE(std::isfinite(count) && count >= 0) << n << ' ' << count;
        }
    }
}

TEST(Multinomial, TreatsBadInputAsDocumented) {
    expect_bad_input_as_documented<exact_binomial, float>();
    expect_bad_input_as_documented<exact_binomial, double>();
    expect_bad_input_as_documented<dual_gated_binomial, float>();
    expect_bad_input_as_documented<dual_gated_binomial, double>();
}

/// A quotient of 1 + 5e-9 has hung a real library (WireCell #26), float probabilities that sum to more than 1 have
/// been refused by another (numpy #8317).
TEST(Multinomial, BearsASumSlightlyAboveOne) {
    const std::array<double, 3> above{0.5, 0.25, 0.25 + 5e-9};
    const std::array<double, 3> alone{0, 1 + 5e-9, 0};
    const float ulp = std::numeric_limits<float>::epsilon();
    const std::array<float, 3> above_in_float{0.5F, 0.25F, 0.25F + 3 * ulp};
    for (const double n : {1., 100., 1e6}) {
        for (std::uint32_t i = 0; i < 500; ++i) {
            EXPECT_EQ(total(multinomial<3, exact_binomial>{}(n, above, uniform_stream<double>{9U, i})), n);
            EXPECT_EQ(total(multinomial<3, exact_binomial>{}(n, alone, uniform_stream<double>{9U, i})), n);
            const auto counts =
                multinomial<3, exact_binomial>{}(static_cast<float>(n), above_in_float, uniform_stream<float>{9U, i});
            EXPECT_EQ(total(counts), n);
        }
    }
}

// the law, with exact_binomial

constexpr int fit_draws = 1 << 18;

/// The smallest error of a probability that the fits are sure to see, in standard deviations of one draw.
constexpr double smallest_effect = 0.04;

/// Each category on its own is binomial, whatever its place in the tree and whether there is a "none".
template <std::size_t K>
void expect_binomial_categories(double trials, const std::array<double, K>& p, std::uint32_t seed) {
    std::vector<statistics::binomial_cells> cells;
    std::vector<statistics::histogram> counts;
    for (const double probability : p) {
        cells.emplace_back(trials, probability);
        counts.push_back(cells.back().empty());
        const double off = probability + smallest_effect * std::sqrt(probability * (1 - probability) / trials);
        EXPECT_TRUE(statistics::chance_of_missing(cells.back().probabilities(), cells.back().of(off), fit_draws) <=
                    1e-3)
            << "N = " << trials << ", p = " << probability;
    }
    for (std::uint32_t i = 0; i < fit_draws; ++i) {
        const auto drawn = multinomial<K, exact_binomial>{}(trials, p, uniform_stream<double>{seed, i});
        for (std::size_t k = 0; k < K; ++k) counts[k].add(drawn[k]);
    }
    for (std::size_t k = 0; k < K; ++k) {
        const auto fit = statistics::goodness_of_fit(cells[k], counts[k]);
        EXPECT_TRUE(statistics::passes(fit.p_value))
            << "N = " << trials << ", category " << k << " of " << K << ", p = " << p[k] << ", uniform_stream<double>{"
            << seed << ", 0.." << fit_draws << "}: p-value " << fit.p_value << ", worst at "
            << cells[k].start_of(fit.worst_cell);
    }
}

TEST(Multinomial, EveryCategoryIsBinomial) {
    expect_binomial_categories<4>(12, {0.5, 0.25, 0.125, 0.125}, 10U);
    expect_binomial_categories<5>(400, {0.0625, 0.5, 0.1875, 0.125, 0.125}, 11U);
}

TEST(Multinomial, LeftoverGoesToNoCategory) {
    expect_binomial_categories<1>(30, {0.3}, 12U);
    expect_binomial_categories<3>(30, {0.25, 0.0625, 0.125}, 13U);
}

/// The same three categories in every order: each keeps its law.
TEST(Multinomial, OrderOfCategoriesChangesNothing) {
    expect_binomial_categories<3>(20, {0.625, 0.3125, 0.0625}, 14U);
    expect_binomial_categories<3>(20, {0.3125, 0.0625, 0.625}, 15U);
    expect_binomial_categories<3>(20, {0.0625, 0.625, 0.3125}, 16U);
    expect_binomial_categories<3>(20, {0.0625, 0.3125, 0.625}, 17U);
}

/// N small enough that every outcome (a, b) with c = N - a - b gets draws; the cells in the order of a, then b.
constexpr int joint_trials = 5;
constexpr std::size_t joint_cells = (joint_trials + 1) * (joint_trials + 1);

std::size_t joint_cell(int a, int b) { return static_cast<std::size_t>(a * (joint_trials + 1) + b); }

std::vector<double> joint_probabilities(const std::array<double, 3>& p) {
    std::vector<double> result(joint_cells, 0.);
    for (int a = 0; a <= joint_trials; ++a) {
        for (int b = 0; a + b <= joint_trials; ++b) {
            const int c = joint_trials - a - b;
            const auto factorial = [](int k) { return std::tgamma(k + 1.); };
            const double orders = factorial(joint_trials) / (factorial(a) * factorial(b) * factorial(c));
            result[joint_cell(a, b)] = orders * std::pow(p[0], a) * std::pow(p[1], b) * std::pow(p[2], c);
        }
    }
    return result;
}

TEST(Multinomial, HasTheJointLaw) {
    constexpr std::array<double, 3> p{0.5, 0.3125, 0.1875};
    const auto probabilities = joint_probabilities(p);
    const double step = smallest_effect * std::sqrt(p[0] * (1 - p[0]) / joint_trials);
    const auto off = joint_probabilities({p[0] - step, p[1] + step, p[2]});
    EXPECT_TRUE(statistics::chance_of_missing(probabilities, off, fit_draws) <= 1e-3);

    std::vector<double> observed(joint_cells, 0.);
    for (std::uint32_t i = 0; i < fit_draws; ++i) {
        const auto drawn = multinomial<3, exact_binomial>{}(double(joint_trials), p, uniform_stream<double>{18U, i});
        observed[joint_cell(static_cast<int>(drawn[0]), static_cast<int>(drawn[1]))] += 1;
    }
    const auto fit = statistics::goodness_of_fit(probabilities, observed);
    EXPECT_TRUE(statistics::passes(fit.p_value)) << fit.p_value << ", worst cell " << fit.worst_cell;
}

/// Negative control: categories drawn one by one, each exactly binomial, do not have the joint law.
TEST(NegativeControl, IndependentCategories) {
    constexpr std::array<double, 3> p{0.5, 0.3125, 0.1875};
    std::vector<double> observed(joint_cells, 0.);
    for (std::uint32_t i = 0; i < fit_draws; ++i) {
        uniform_stream<double> xi{19U, i};
        const auto a = static_cast<int>(exact_binomial{}(double(joint_trials), p[0], xi).successes);
        const auto b = static_cast<int>(exact_binomial{}(double(joint_trials), p[1], xi).successes);
        if (a + b <= joint_trials) observed[joint_cell(a, b)] += 1;
    }
    EXPECT_TRUE(statistics::goodness_of_fit(joint_probabilities(p), observed).p_value < statistics::significance());
}

/// Cov(n_i, n_j) = -N p_i p_j. The standard error of a covariance of nearly normal variables is
/// sqrt((v_i v_j + cov^2) / draws): a covariance off by 2 % of the deviations is sure to be seen.
TEST(Multinomial, HasTheCovariancesOfTheLaw) {
    constexpr std::size_t size = 5;
    constexpr double n = 400;
    constexpr std::array<double, size> p{0.0625, 0.5, 0.1875, 0.125, 0.0625};
    std::array<std::array<statistics::running_covariance, size>, size> covariances;
    for (std::uint32_t i = 0; i < fit_draws; ++i) {
        const auto drawn = multinomial<size, exact_binomial>{}(n, p, uniform_stream<double>{20U, i});
        for (std::size_t a = 0; a < size; ++a)
            for (std::size_t b = 0; b < a; ++b) covariances[a][b].add(drawn[a], drawn[b]);
    }
    for (std::size_t a = 0; a < size; ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            const double expected = -n * p[a] * p[b];
            const double variances = n * p[a] * (1 - p[a]) * n * p[b] * (1 - p[b]);
            const double error = std::sqrt((variances + expected * expected) / fit_draws);
            const double found = covariances[a][b].covariance();
            EXPECT_TRUE(statistics::passes(statistics::normal_p_value((found - expected) / error)))
                << a << ' ' << b << ": " << found << " instead of " << expected;
        }
    }
}

// rare categories

/// A category of probability 1e-9 keeps its mean next to a likely one, in every position: as the complement of the
/// likely one it would be 0 in float. N p = 4.29, and
/// 2^17 draws are sure to see an error of 1.5 %.
template <std::size_t K>
void expect_rare_category_keeps_its_mean(std::uint32_t seed) {
    constexpr float trials = 0x1p32F;
    constexpr float rare = 1e-9F;
    constexpr double mean = static_cast<double>(trials) * static_cast<double>(rare);
    for (std::size_t position = 0; position < K; ++position) {
        std::array<float, K> p{};
        p.fill(1.F / static_cast<float>(K - 1));
        p[position] = rare;
        statistics::running_moments sample;
        for (std::uint32_t i = 0; i < (1U << 17); ++i) {
            const auto drawn = multinomial<K, exact_binomial>{}(trials, p, uniform_stream<float>{seed, i});
            sample.add(static_cast<double>(drawn[position]));
        }
        EXPECT_TRUE(statistics::passes(statistics::mean_p_value(sample, mean, std::sqrt(mean))))
            << "position " << position << " of " << K << ": " << sample.mean() << " instead of " << mean;
    }
}

TEST(Multinomial, KeepsTheMeanOfARareCategory) {
    expect_rare_category_keeps_its_mean<2>(21U);
    expect_rare_category_keeps_its_mean<5>(22U);
}

// with dual_gated_binomial

/// Inner nodes below two trials are dithered, so only the mean of the sum is N; below two trials, where the law has
/// the exact mean, every category has the mean N p_k too.
TEST(Multinomial, DualGatedKeepsTheMeansBelowTwoTrials) {
    constexpr std::array<double, 3> p{0.5, 0.3125, 0.1875};
    for (const double n : {0.25, 0.5, 1., 1.5}) {
        std::array<statistics::running_moments, 3> samples;
        statistics::running_moments sums;
        bool sum_varies = false;
        for (std::uint32_t i = 0; i < fit_draws; ++i) {
            const auto drawn = multinomial<3, dual_gated_binomial>{}(n, p, uniform_stream<double>{24U, i});
            for (std::size_t k = 0; k < 3; ++k) samples[k].add(drawn[k]);
            sums.add(total(drawn));
            sum_varies = sum_varies || total(drawn) != n;
        }
        EXPECT_EQ(sum_varies, n != 1) << n;
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_TRUE(
                statistics::passes(statistics::mean_p_value(samples[k], n * p[k], std::sqrt(samples[k].variance()))))
                << n << ", category " << k << ": " << samples[k].mean();
        const double deviation = std::sqrt(sums.variance());
        if (deviation > 0) {
            EXPECT_TRUE(statistics::passes(statistics::mean_p_value(sums, n, deviation))) << n << ": " << sums.mean();
        }
    }
}

/// 2^15 draws know the mean of the sum to 0.006 of its deviations; 0.05 are sure to be seen.
TEST(Multinomial, DualGatedSumsToTheTrialsOnAverage) {
    const auto p = dyadic_probabilities<double, 8>();
    for (const double n : {2.5, 10., 1000.}) {
        statistics::running_moments sums;
        for (std::uint32_t i = 0; i < (1U << 15); ++i)
            sums.add(total(multinomial<8, dual_gated_binomial>{}(n, p, uniform_stream<double>{25U, i})) - n);
        const double deviation = (std::max)(std::sqrt(sums.variance()), 1e-9);
        EXPECT_TRUE(statistics::passes(statistics::mean_p_value(sums, 0, deviation)))
            << n << ": " << sums.mean() << " off";
    }
}

// the stream

/// Whatever a law draws, the caller's stream has moved by one fork.
TEST(Multinomial, MovesAStreamByOneFork) {
    const auto p = dyadic_probabilities<float, 8>();
    for (const float n : {0.F, 1.5F, 1000.F}) {
        uniform_stream<float> exact{26U, 1U};
        uniform_stream<float> dual_gated{26U, 1U};
        uniform_stream<float> dynamic{26U, 1U};
        uniform_stream<float> forked{26U, 1U};
        multinomial<8, exact_binomial>{}(n, p, exact);
        multinomial<8, dual_gated_binomial>{}(n, p, dual_gated);
        drawn_dynamically<exact_binomial>(n, p, dynamic);
        forked.fork();
        const auto expected = forked.next_bits();
        EXPECT_EQ(exact.next_bits(), expected);
        EXPECT_EQ(dual_gated.next_bits(), expected);
        EXPECT_EQ(dynamic.next_bits(), expected);
    }
}

/// A source that cannot fork is drawn from in the order of the nodes: two uniforms for each of K - 1 nodes where the
/// probabilities sum to 1, and two more where they do not.
TEST(Multinomial, TakesAPlainCallable) {
    const auto count_draws = [](const std::array<double, 4>& p) {
        uniform_stream<double> stream{27U};
        int drawn = 0;
        multinomial<4, dual_gated_binomial>{}(100., p, [&] {
            ++drawn;
            return stream();
        });
        return drawn;
    };
    EXPECT_EQ(count_draws({0.25, 0.25, 0.25, 0.25}), 6);
    EXPECT_EQ(count_draws({0.25, 0.25, 0.25, 0.125}), 8);
}

TEST(Multinomial, DynamicTakesTheShorterSpan) {
    const std::array<double, 3> p{0.5, 0.5, 0};
    std::array<double, 4> longer{-1, -1, -1, -1};
    multinomial<std::dynamic_extent, exact_binomial>{}(10., std::span<const double>(p), uniform_stream<double>{28U},
                                                       std::span<double>(longer));
    EXPECT_EQ(longer[0] + longer[1], 10);
    EXPECT_EQ(longer[2], 0);
    EXPECT_EQ(longer[3], -1);

    std::array<double, 2> shorter{-1, -1};
    multinomial<std::dynamic_extent, exact_binomial>{}(10., std::span<const double>(p), uniform_stream<double>{28U},
                                                       std::span<double>(shorter));
    EXPECT_EQ(shorter[0] + shorter[1], 10);

    multinomial<std::dynamic_extent, exact_binomial>{}(10., std::span<const double>(), uniform_stream<double>{28U},
                                                       std::span<double>());
}

/// Spans of floats and vectors, and trials of any type that converts.
TEST(Multinomial, TakesWhatAUserHasAtHand) {
    std::vector<float> probabilities{0.25F, 0.5F, 0.25F}, counts(3);
    using dynamic = mica::multinomial<std::dynamic_extent, mica::exact_binomial>;
    dynamic{}(10.F, std::span<float>(probabilities), mica::uniform_stream<float>{3}, std::span<float>(counts));
    const auto fixed = mica::multinomial<3, mica::exact_binomial>{}(10, std::array{0.25F, 0.5F, 0.25F},
                                                                    mica::uniform_stream<float>{3});
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(counts[k], fixed[k]);
    EXPECT_EQ(counts[0] + counts[1] + counts[2], 10);
}

} // namespace
