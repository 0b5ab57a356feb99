// tests/law_test.cpp: the binomial laws. exact_binomial against Boost.Math's binomial; dual_gated_binomial against its
// own statement, by deterministic integration over its two uniforms; both on bad input, at the ends and in packs.
// The statistics helper is tested here too, with its negative controls.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "mica/law/dual_gated.hpp"
#include "mica/law/exact.hpp"
#include "mica/numeric/pack.hpp"
#include "mica/random/uniform_stream.hpp"

#include "statistics.hpp"

namespace {

using mica::dual_gated_binomial;
using mica::exact_binomial;
using mica::uniform_stream;
using statistics::binomial_cells;

static_assert(mica::binomial_law<exact_binomial> && mica::binomial_law<exact_binomial, double>);
static_assert(mica::binomial_law<dual_gated_binomial> && mica::binomial_law<dual_gated_binomial, double>);
static_assert(mica::binomial_law<exact_binomial, mica::pack<float, 8>>);
static_assert(mica::binomial_law<dual_gated_binomial, mica::pack<double, 4>>);
static_assert(exact_binomial::integer_counts && !dual_gated_binomial::integer_counts);

/// Uniforms read from a list, which starts again at its end, and how many were read.
template <class Real, std::size_t Size>
struct scripted_uniforms {
    std::array<Real, Size> values;
    std::size_t drawn = 0;

    Real operator()() { return values[drawn++ % Size]; }
};

template <class Real>
constexpr Real smallest_uniform = sizeof(Real) == 4 ? Real(0x1p-32) : Real(0x1p-53);
template <class Real>
constexpr Real largest_uniform = sizeof(Real) == 4 ? Real(1 - 0x1p-24) : Real(1 - 0x1p-53);

// the helper itself

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

TEST(Statistics, MomentsAreThoseOfTheSample) {
    statistics::running_moments sample;
    for (const double x : {2., 4., 4., 4., 5., 5., 7., 9.}) sample.add(x);
    EXPECT_TRUE(std::abs(sample.mean() - 5) <= 1e-14);
    EXPECT_TRUE(std::abs(sample.variance() - 32. / 7) <= 1e-14);
}

// goodness of fit of exact_binomial

constexpr int fit_draws = 1 << 18;

/// The smallest error of the mean that every fit below is sure to see, in standard deviations of one draw.
constexpr double smallest_effect = 0.04;

/// A success probability whose mean is off by the smallest effect.
double off_by_the_effect(double trials, double probability) {
    const double fraction = trials - std::floor(trials);
    const double variance =
        trials * probability * (1 - probability) + fraction * (1 - fraction) * probability * probability;
    const double step = smallest_effect * std::sqrt(variance) / trials;
    return probability < 0.5 ? probability + step : probability - step;
}

/// Counts of `fit_draws` calls draw(i), i = 0, 1, ...
template <class Draw>
statistics::fit fit_of(const binomial_cells& cells, Draw draw) {
    auto counts = cells.empty();
    for (std::uint32_t i = 0; i < fit_draws; ++i) counts.add(draw(i));
    return statistics::goodness_of_fit(cells, counts);
}

struct binomial_case {
    double trials;
    double probability;
};

std::ostream& operator<<(std::ostream& out, const binomial_case& c) {
    return out << "N = " << c.trials << ", p = " << c.probability;
}

template <class Real>
void expect_exact_law(binomial_case c, std::uint32_t seed) {
    const Real trials = static_cast<Real>(c.trials);
    const Real probability = static_cast<Real>(c.probability);
    const binomial_cells cells(static_cast<double>(trials), static_cast<double>(probability));
    const auto off = cells.of(off_by_the_effect(static_cast<double>(trials), static_cast<double>(probability)));
    EXPECT_TRUE(statistics::chance_of_missing(cells.probabilities(), off, fit_draws) <= 1e-3) << c;

    const auto fit = fit_of(cells, [&](std::uint32_t i) {
        return static_cast<double>(exact_binomial{}(trials, probability, uniform_stream<Real>{seed, i}).successes);
    });
    EXPECT_TRUE(fit.p_value >= statistics::significance())
        << c << ", uniform_stream<" << (sizeof(Real) == 4 ? "float" : "double") << ">{" << seed << ", 0.." << fit_draws
        << "}: p-value " << fit.p_value << ", worst at " << cells.start_of(fit.worst_cell);
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
    const binomial_cells cells(60, 0.375);
    auto counts = cells.empty();
    for (std::uint32_t i = 0; i < fit_draws; i += 8) {
        uniform_stream<Pack> xi{mica::index_of<Pack>(5U), mica::index_of<Pack>::iota(i)};
        const auto drawn = exact_binomial{}(Pack(60), Pack(0.375F), xi);
        for (int j = 0; j < 8; ++j) counts.add(static_cast<double>(drawn.successes[j]));
    }
    EXPECT_TRUE(statistics::goodness_of_fit(cells, counts).p_value >= statistics::significance());
}

/// Consecutive draws of one stream, as std::-style generators are used, instead of consecutive indices.
TEST(ExactBinomial, FollowsTheBinomialAlongOneStream) {
    for (const binomial_case& c : {binomial_case{12, 0.4}, binomial_case{300, 0.4}}) {
        uniform_stream<double> xi{6U};
        const auto fit = fit_of(binomial_cells(c.trials, c.probability),
                                [&](std::uint32_t) { return exact_binomial{}(c.trials, c.probability, xi).successes; });
        EXPECT_TRUE(fit.p_value >= statistics::significance()) << c << ": " << fit.p_value;
    }
}

// negative controls: what the fits above must reject

constexpr binomial_case control{40, 0.5};

/// p-value of draws that change(draw, i) made of exact ones.
template <class Change>
double fit_of_changed(double probability, Change change) {
    return fit_of(binomial_cells(control.trials, control.probability),
                  [&](std::uint32_t i) {
                      const uniform_stream<double> xi{7U, i};
                      return change(exact_binomial{}(control.trials, probability, uniform_stream<double>(xi)).successes,
                                    i);
                  })
        .p_value;
}

double unchanged(double drawn, std::uint32_t) { return drawn; }

TEST(NegativeControl, UnchangedDrawsPass) {
    EXPECT_TRUE(fit_of_changed(control.probability, unchanged) >= statistics::significance());
}

TEST(NegativeControl, ProbabilityOffByTheEffect) {
    EXPECT_TRUE(fit_of_changed(off_by_the_effect(control.trials, control.probability), unchanged) <
                statistics::significance());
}

TEST(NegativeControl, SwappedSuccessesAndFailures) {
    const auto swapped = [](double drawn, std::uint32_t) { return control.trials - drawn; };
    EXPECT_TRUE(fit_of_changed(0.49, swapped) < statistics::significance());
}

TEST(NegativeControl, OffByOne) {
    const auto one_more = [](double drawn, std::uint32_t) { return drawn + 1; };
    EXPECT_TRUE(fit_of_changed(control.probability, one_more) < statistics::significance());
}

TEST(NegativeControl, Constant) {
    EXPECT_TRUE(fit_of_changed(control.probability, [](double, std::uint32_t) { return 20.; }) <
                statistics::significance());
}

TEST(NegativeControl, NotANumber) {
    const auto once_nan = [](double drawn, std::uint32_t i) {
        return i == 1000 ? std::numeric_limits<double>::quiet_NaN() : drawn;
    };
    EXPECT_TRUE(fit_of_changed(control.probability, once_nan) < statistics::significance());
}

TEST(NegativeControl, DroppedCell) {
    const auto never_fifteen = [](double drawn, std::uint32_t) { return drawn == 15 ? 16 : drawn; };
    EXPECT_TRUE(fit_of_changed(control.probability, never_fifteen) < statistics::significance());
}

/// The lower tail moved to the upper one: what pooling in order of size cannot see.
TEST(NegativeControl, TailMovedToTheOtherSide) {
    const auto mirrored_tail = [](double drawn, std::uint32_t) { return drawn <= 9 ? control.trials - drawn : drawn; };
    EXPECT_TRUE(fit_of_changed(control.probability, mirrored_tail) < statistics::significance());
}

/// One draw among a million in a cell of probability 1e-17: pooled with its neighbours it moves no chi-square; it is
/// seen as the farthest cell reached.
TEST(NegativeControl, OneImpossiblyFarDraw) {
    const std::vector<double> probabilities{0.5, 0.5 - 1e-4, 1e-4, 1e-17};
    const std::vector<double> possible{500'000, 499'900, 100, 0};
    const std::vector<double> impossible{500'000, 499'900, 99, 1};
    EXPECT_TRUE(statistics::goodness_of_fit(probabilities, possible).p_value >= statistics::significance());
    EXPECT_TRUE(statistics::goodness_of_fit(probabilities, impossible).p_value < statistics::significance());
}

TEST(NegativeControl, OutsideTheSupport) {
    for (const double outside : {-1., 41., 20.5}) {
        const auto once_outside = [&](double drawn, std::uint32_t i) { return i == 1000 ? outside : drawn; };
        EXPECT_TRUE(fit_of_changed(control.probability, once_outside) < statistics::significance());
    }
}

/// The dual-gated law is no binomial; a fit that accepted it would see nothing.
TEST(NegativeControl, DualGatedLaw) {
    const auto fit = fit_of(binomial_cells(16, 0.0625), [](std::uint32_t i) {
        return std::round(dual_gated_binomial{}(16., 0.0625, uniform_stream<double>{7U, i}).successes);
    });
    EXPECT_TRUE(fit.p_value < statistics::significance());
}

TEST(NegativeControl, MeansAndVariancesOfAnotherLaw) {
    statistics::running_moments sample;
    for (std::uint32_t i = 0; i < fit_draws; ++i)
        sample.add(exact_binomial{}(40., 0.5, uniform_stream<double>{8U, i}).successes);
    const double deviation = std::sqrt(10.);
    EXPECT_TRUE(statistics::mean_p_value(sample, 20 + smallest_effect * deviation, deviation) <
                statistics::significance());
    EXPECT_TRUE(statistics::variance_p_value(sample, 10 * 1.04) < statistics::significance());
    EXPECT_TRUE(statistics::mean_p_value(sample, std::numeric_limits<double>::quiet_NaN(), deviation) == 0);
}

// exact_binomial where Boost.Math is slow or has no digits

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
        for (std::uint32_t i = 0; i < fit_draws; ++i) {
            const auto drawn = exact_binomial{}(c.trials, c.probability, uniform_stream<double>{9U, i});
            EXPECT_EQ(drawn.successes + drawn.failures, c.trials);
            // From the mean, because 1e15 and its square leave no digits for a variance.
            sample.add(drawn.successes - c.trials * c.probability);
        }
        EXPECT_TRUE(statistics::mean_p_value(sample, 0, std::sqrt(variance)) >= statistics::significance())
            << c << ": mean off by " << sample.mean() / std::sqrt(variance) << " deviations";
        EXPECT_TRUE(statistics::variance_p_value(sample, variance) >= statistics::significance())
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

// every law: ends, bad input, packs

template <class Real>
using scripted_pair = scripted_uniforms<Real, 2>;

/// Both extremes of both uniforms, and the middle.
template <class Real, class Visit>
void each_extreme_pair(Visit visit) {
    for (const Real a : {smallest_uniform<Real>, Real(0.25), Real(0.5), Real(0.75), largest_uniform<Real>})
        for (const Real b : {smallest_uniform<Real>, Real(0.25), Real(0.5), Real(0.75), largest_uniform<Real>})
            visit(a, b);
}

template <class Law, class Real>
void expect_certainty() {
    const Real all[] = {Real(0), Real(1), Real(2), Real(3), Real(10), Real(1000), Real(1e6), Real(1e12), Real(1e15)};
    for (const Real n : all) {
        each_extreme_pair<Real>([&](Real a, Real b) {
            const auto never = Law{}(n, Real(0), scripted_pair<Real>{{a, b}});
            EXPECT_EQ(never.successes, 0) << "N = " << n << ", p = 0, xi = " << a << ", " << b;
            EXPECT_EQ(never.failures, n) << "N = " << n << ", p = 0, xi = " << a << ", " << b;
            const auto always = Law{}(n, Real(1), scripted_pair<Real>{{a, b}});
            EXPECT_EQ(always.successes, n) << "N = " << n << ", p = 1, xi = " << a << ", " << b;
            EXPECT_EQ(always.failures, 0) << "N = " << n << ", p = 1, xi = " << a << ", " << b;
        });
    }
}

TEST(EveryLaw, IsExactWhereNothingIsRandom) {
    expect_certainty<exact_binomial, float>();
    expect_certainty<exact_binomial, double>();
    expect_certainty<dual_gated_binomial, float>();
    expect_certainty<dual_gated_binomial, double>();
}

/// At real trials only the number of trials is random: p = 0 gives no success, p = 1 no failure.
template <class Law, class Real>
void expect_certainty_at_real_trials() {
    for (const Real n : {Real(0.05), Real(0.5), Real(0.95), Real(1.001), Real(1.5), Real(1.999), Real(7.25)}) {
        each_extreme_pair<Real>([&](Real a, Real b) {
            const auto never = Law{}(n, Real(0), scripted_pair<Real>{{a, b}});
            EXPECT_EQ(never.successes, 0) << n << ' ' << a << ' ' << b;
            EXPECT_TRUE(never.failures >= 0 && never.failures <= std::ceil(n)) << n << ' ' << a << ' ' << b;
            const auto always = Law{}(n, Real(1), scripted_pair<Real>{{a, b}});
            EXPECT_EQ(always.failures, 0) << n << ' ' << a << ' ' << b;
            EXPECT_TRUE(always.successes >= 0 && always.successes <= std::ceil(n)) << n << ' ' << a << ' ' << b;
        });
    }
}

TEST(EveryLaw, HasNoWrongOutcomeAtRealTrials) {
    expect_certainty_at_real_trials<exact_binomial, float>();
    expect_certainty_at_real_trials<exact_binomial, double>();
    expect_certainty_at_real_trials<dual_gated_binomial, float>();
    expect_certainty_at_real_trials<dual_gated_binomial, double>();
}

template <class Law, class Real>
void expect_bad_input_as_documented() {
    using limits = std::numeric_limits<Real>;
    const Real nan = limits::quiet_NaN();
    const Real infinity = limits::infinity();
    const auto law = [](Real n, Real p, std::uint32_t i) { return Law{}(n, p, uniform_stream<Real>{17U, i}); };
    for (std::uint32_t i = 0; i < 64; ++i) {
        for (const Real good : {Real(0), Real(0.3), Real(1)}) {
            for (const auto& outcome :
                 {law(nan, good, i), law(-nan, good, i), law(Real(10), nan, i), law(nan, nan, i), law(infinity, nan, i),
                  law(Real(-1), good, i), law(-infinity, good, i), law(limits::lowest(), good, i)}) {
                EXPECT_EQ(outcome.successes, 0);
                EXPECT_EQ(outcome.failures, 0);
            }
            const auto at_infinity = law(infinity, good, i);
            const auto at_largest = law((limits::max)(), good, i);
            EXPECT_EQ(at_infinity.successes, at_largest.successes);
            EXPECT_EQ(at_infinity.failures, at_largest.failures);
        }
        for (const Real n : {Real(0), Real(0.5), Real(1.5), Real(10), Real(1e9)}) {
            for (const Real above : {Real(1) + limits::epsilon(), Real(2), infinity, (limits::max)()}) {
                EXPECT_EQ(law(n, above, i).successes, law(n, Real(1), i).successes) << n << ' ' << above;
                EXPECT_EQ(law(n, above, i).failures, law(n, Real(1), i).failures) << n << ' ' << above;
            }
            for (const Real below : {-limits::denorm_min(), Real(-1), -infinity}) {
                EXPECT_EQ(law(n, below, i).successes, law(n, Real(0), i).successes) << n << ' ' << below;
                EXPECT_EQ(law(n, below, i).failures, law(n, Real(0), i).failures) << n << ' ' << below;
            }
        }
    }
}

TEST(EveryLaw, TreatsBadInputAsDocumented) {
    expect_bad_input_as_documented<exact_binomial, float>();
    expect_bad_input_as_documented<exact_binomial, double>();
    expect_bad_input_as_documented<dual_gated_binomial, float>();
    expect_bad_input_as_documented<dual_gated_binomial, double>();
}

/// Trials and probabilities of every size, good and bad.
template <class Real>
std::vector<Real> any_parameter() {
    using limits = std::numeric_limits<Real>;
    std::vector<Real> numbers{limits::quiet_NaN(),  limits::infinity(), -limits::infinity(),
                              (limits::max)(),      limits::lowest(),   limits::min(),
                              limits::denorm_min(), Real(-0.),          Real(0)};
    for (const double x : {1e-30, 1e-9, 0.05, 0.3, 0.5,    0.7,    0.999999, 1.,       1.000001, 1.5,  1.999999,
                           2.,    2.5,  7.3,  16., 19.999, 20.001, 1000.,    123456.7, 1e9,      1e16, 1e30})
        numbers.push_back(static_cast<Real>(x));
    numbers.push_back(Real(1) - limits::epsilon() / 2);
    return numbers;
}

/// Every pair of parameters in every lane: finite, in the support, and to the last bit what the scalar law gives.
template <class Law, class Pack>
void expect_lanes_equal_scalars() {
    using Real = typename Pack::value_type;
    using Index = mica::index_of<Pack>;
    using Bits = mica::bits_of<Real>;
    constexpr int lanes = mica::lanes_of<Pack>;
    const auto numbers = any_parameter<Real>();
    std::uint32_t index = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        for (std::size_t j = 0; j < numbers.size(); ++j, ++index) {
            Pack n(numbers[i]);
            Pack p(numbers[j]);
            for (int k = 1; k < lanes; k += 2) n.set(k, numbers[(i + static_cast<std::size_t>(k)) % numbers.size()]);
            for (int k = 0; k < lanes; k += 3) p.set(k, numbers[(j + static_cast<std::size_t>(k)) % numbers.size()]);
            uniform_stream<Pack> xi{Index(18U), Index::iota(index)};
            const auto packed = Law{}(n, p, xi);
            for (int k = 0; k < lanes; ++k) {
                uniform_stream<Real> of_lane{18U, index + static_cast<std::uint32_t>(k)};
                const auto scalar = Law{}(n[k], p[k], of_lane);
                EXPECT_EQ(std::bit_cast<Bits>(packed.successes[k]), std::bit_cast<Bits>(scalar.successes))
                    << "N = " << n[k] << ", p = " << p[k];
                EXPECT_EQ(std::bit_cast<Bits>(packed.failures[k]), std::bit_cast<Bits>(scalar.failures))
                    << "N = " << n[k] << ", p = " << p[k];
                const Real most = n[k] > 0 ? std::ceil(n[k]) : Real(0);
                EXPECT_TRUE(std::isfinite(scalar.successes) && scalar.successes >= 0 && scalar.successes <= most)
                    << "N = " << n[k] << ", p = " << p[k] << ": " << scalar.successes;
                EXPECT_TRUE(std::isfinite(scalar.failures) && scalar.failures >= 0 && scalar.failures <= most)
                    << "N = " << n[k] << ", p = " << p[k] << ": " << scalar.failures;
            }
        }
    }
}

TEST(EveryLaw, GivesInEveryLaneWhatItGivesForAScalar) {
    expect_lanes_equal_scalars<exact_binomial, mica::pack<float, 4>>();
    expect_lanes_equal_scalars<exact_binomial, mica::pack<float, 8>>();
    expect_lanes_equal_scalars<exact_binomial, mica::pack<double, 4>>();
    expect_lanes_equal_scalars<dual_gated_binomial, mica::pack<float, 4>>();
    expect_lanes_equal_scalars<dual_gated_binomial, mica::pack<float, 8>>();
    expect_lanes_equal_scalars<dual_gated_binomial, mica::pack<double, 4>>();
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

// dual_gated_binomial

TEST(DualGatedBinomial, DrawsTwoUniforms) {
    for (const double n : {0., 0.5, 1., 1.5, 2., 3., 1e9}) {
        for (const double p : {0., 1e-9, 0.5, 1.}) {
            each_extreme_pair<double>([&](double a, double b) {
                scripted_pair<double> xi{{a, b}};
                dual_gated_binomial{}(n, p, xi);
                EXPECT_EQ(xi.drawn, 2U) << n << ' ' << p;
            });
        }
    }
}

/// Midpoints of equal strata: they integrate a step over one uniform to within half a stratum.
constexpr int strata = 1 << 13;
double stratum(int i) { return (i + 0.5) / strata; }

/// The same strata in another order, for a second uniform.
double other_stratum(int i) { return stratum(static_cast<int>(i * std::int64_t{5003} % strata)); }

/// How often each pair (successes, failures) of 0, 1, 2 occurs, over the strata of the gate's uniform.
template <class Real>
std::array<std::array<double, 3>, 3> small_outcomes(Real n, Real p) {
    std::array<std::array<double, 3>, 3> share{};
    for (int i = 0; i < strata; ++i) {
        const Real other = static_cast<Real>(other_stratum(i));
        const auto drawn = dual_gated_binomial{}(n, p, scripted_pair<Real>{{static_cast<Real>(stratum(i)), other}});
        const bool whole = (drawn.successes == 0 || drawn.successes == 1 || drawn.successes == 2) &&
                           (drawn.failures == 0 || drawn.failures == 1 || drawn.failures == 2);
        EXPECT_TRUE(whole) << n << ' ' << p << ": " << drawn.successes << ", " << drawn.failures;
        if (whole)
            share[static_cast<std::size_t>(drawn.successes)][static_cast<std::size_t>(drawn.failures)] += 1. / strata;
    }
    return share;
}

constexpr double probabilities_in_unit[] = {0.,  0x1p-20, 0.001, 0.01, 0.1,   0.25,        0.4, 0.5,
                                            0.6, 0.75,    0.9,   0.99, 0.999, 1 - 0x1p-20, 1.};

/// Real N in [0, 2]: the exact laws of the neighbouring integers, interpolated, so E[n] = N p and E[failures] = N q.
template <class Real>
void expect_interpolated_exact_laws() {
    constexpr double two_steps = 1. / strata + 1e-6; // and the rounding of the gates in float
    for (const double n : {0., 0.05, 0.5, 0.95, 1., 1.05, 1.5, 1.95, 2.}) {
        for (const double p : probabilities_in_unit) {
            const double q = 1 - p;
            const double two = (std::max)(0., n - 1);
            const double one = 1 - std::abs(n - 1);
            const auto share = small_outcomes(static_cast<Real>(n), static_cast<Real>(p));
            const double expected[3][3] = {
                {1 - two - one, one * q, two * q * q}, {one * p, two * 2 * p * q, 0}, {two * p * p, 0, 0}};
            double successes = 0;
            double failures = 0;
            for (std::size_t s = 0; s < 3; ++s) {
                for (std::size_t f = 0; f < 3; ++f) {
                    EXPECT_TRUE(std::abs(share[s][f] - expected[s][f]) <= two_steps)
                        << "N = " << n << ", p = " << p << ": (" << s << ", " << f << ") " << share[s][f];
                    successes += static_cast<double>(s) * share[s][f];
                    failures += static_cast<double>(f) * share[s][f];
                }
            }
            // A step of one count each at up to four places.
            EXPECT_TRUE(std::abs(successes - n * p) <= 2 * two_steps) << n << ' ' << p << ' ' << successes;
            EXPECT_TRUE(std::abs(failures - n * q) <= 2 * two_steps) << n << ' ' << p << ' ' << failures;
        }
    }
}

TEST(DualGatedBinomial, InterpolatesTheExactLawsUpToTwoTrials) {
    expect_interpolated_exact_laws<float>();
    expect_interpolated_exact_laws<double>();
}

/// The lattice of two successive Fibonacci numbers: pairs so evenly spread over the unit square that the integral of
/// a smooth function with a few steps is off by some 3e-5 of its range.
constexpr int lattice_size = 317811;
constexpr std::int64_t lattice_step = 196418;

struct law_moments {
    double mean;
    double variance;
};

law_moments dual_gated_moments(double n, double p) {
    double sum = 0;
    double squares = 0;
    for (int i = 0; i < lattice_size; ++i) {
        const double a = (i + 0.5) / lattice_size;
        const double b = (static_cast<double>(i * lattice_step % lattice_size) + 0.5) / lattice_size;
        const double from_mean = dual_gated_binomial{}(n, p, scripted_pair<double>{{a, b}}).successes - n * p;
        sum += from_mean;
        squares += from_mean * from_mean;
    }
    const double offset = sum / lattice_size;
    return {n * p + offset, squares / lattice_size - offset * offset};
}

/// The published law's known defects (shared/spec/laws.md, to its rounding and 1e-4 for the lattice): the law is
/// implemented as published, no better and no worse. At (1000, 0.003) the table says V = 1.165, but quadrature of the
/// stated law, with no code of mica's, gives 1.1360, and E = 1.27458.
TEST(DualGatedBinomial, HasThePublishedLawsMeanAndVariance) {
    struct defect {
        double trials;
        double probability;
        double mean;
        double variance;
    };
    constexpr double rounding = 6e-4;
    for (const defect& d : {defect{4, 0.25, 1.083, 0.982},
                            {16, 0.0625, 1.259, 1.352},
                            {64, 1. / 64, 1.303, 1.451},
                            {1000, 0.001, 1.316, 1.482},
                            {1000, 0.003, 1.2746, 1.136},
                            {1000, 0.05, 1.018, 0.998},
                            {1000, 0.5, 1.000, 0.998}}) {
        const auto [mean, variance] = dual_gated_moments(d.trials, d.probability);
        const double np = d.trials * d.probability;
        EXPECT_TRUE(std::abs(mean / np - d.mean) <= rounding) << d.trials << ' ' << d.probability << ' ' << mean / np;
        EXPECT_TRUE(std::abs(variance / (np * (1 - d.probability)) - d.variance) <= rounding)
            << d.trials << ' ' << d.probability << ' ' << variance / (np * (1 - d.probability));
    }
}

/// Exchanging p and q at mirrored uniforms exchanges successes and failures, point by point.
TEST(DualGatedBinomial, IsSymmetric) {
    for (const double n : {0.5, 1., 1.25, 1.5, 2., 2.5, 3., 16., 1000., 1e6}) {
        for (const double p : {0x1p-20, 0.03125, 0.25, 0.5, 0.625}) { // 1 - p is exact
            for (int i = 0; i < 4096; ++i) {
                const double a = stratum(i * 2);
                const double b = other_stratum(i);
                const auto here = dual_gated_binomial{}(n, p, scripted_pair<double>{{a, b}});
                const auto there = dual_gated_binomial{}(n, 1 - p, scripted_pair<double>{{1 - a, 1 - b}});
                EXPECT_TRUE(std::abs(here.successes - there.failures) <= 1e-13 * n) << n << ' ' << p << ' ' << a;
                EXPECT_TRUE(std::abs(here.failures - there.successes) <= 1e-13 * n) << n << ' ' << p << ' ' << a;
            }
        }
    }
}

/// From 2 trials on, to one rounding of N.
template <class Real>
void expect_sum_is_trials() {
    for (const Real n : {Real(2), Real(2.5), Real(7.3), Real(1000), Real(1e7), Real(1e12), Real(1e16)}) {
        for (const double p : probabilities_in_unit) {
            for (std::uint32_t i = 0; i < 500; ++i) {
                const auto [successes, failures] =
                    dual_gated_binomial{}(n, static_cast<Real>(p), uniform_stream<Real>{19U, i});
                EXPECT_TRUE(std::abs(successes + failures - n) <= n * std::numeric_limits<Real>::epsilon())
                    << n << ' ' << p << ": " << successes << " + " << failures;
                EXPECT_TRUE(successes >= 0 && failures >= 0 && successes <= n && failures <= n) << n << ' ' << p;
            }
        }
    }
}

TEST(DualGatedBinomial, SuccessesAndFailuresSumToTheTrialsFromTwoOn) {
    expect_sum_is_trials<float>();
    expect_sum_is_trials<double>();
}

/// The chance of any success at N p = 1e-6, over all float uniforms: through 1 - (1-p)^N it would be lost. A success
/// is at least 1 there, so this is P(n >= 1).
TEST(DualGatedBinomial, KeepsTheChanceOfRareEvents) {
    for (const binomial_case& c : {binomial_case{2, 5e-7}, {1000, 1e-9}, {1e9, 1e-15}, {5e10, 2e-17}}) {
        std::uint32_t low = 0;
        std::uint32_t high = 0xffffffffU;
        while (low < high) {
            const std::uint32_t middle = low + (high - low) / 2;
            const float u = mica::uniform_from_bits<float>(middle);
            const auto drawn = dual_gated_binomial{}(static_cast<float>(c.trials), static_cast<float>(c.probability),
                                                     scripted_pair<float>{{u, 0.5F}});
            if (drawn.successes >= 1)
                low = middle + 1;
            else
                high = middle;
        }
        EXPECT_TRUE(std::abs(low * 0x1p-32 - 1e-6) <= 0x1p-31) << c << ": " << low * 0x1p-32;
    }
}

/// The law in float is the law in double: the same uniforms, the same branch and nearly the same count, except where
/// a uniform falls within rounding of a gate.
TEST(DualGatedBinomial, FloatAgreesWithDouble) {
    for (const double n : {2., 7., 100., 1e5}) {
        for (const double p : {0x1p-20, 0.03125, 0.25, 0.5, 0.875}) {
            int disagreements = 0;
            for (std::uint32_t i = 0; i < 4096; ++i) {
                uniform_stream<float> xi{20U, i};
                const float a = xi();
                const float b = xi();
                const auto narrow =
                    dual_gated_binomial{}(static_cast<float>(n), static_cast<float>(p), scripted_pair<float>{{a, b}});
                const auto wide = dual_gated_binomial{}(n, p, scripted_pair<double>{{a, b}});
                const double close = 1e-6 * (1 + n);
                if (!(std::abs(static_cast<double>(narrow.successes) - wide.successes) <= close)) ++disagreements;
            }
            EXPECT_LE(disagreements, 1) << n << ' ' << p;
        }
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
