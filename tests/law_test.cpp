// tests/law_test.cpp: what holds for every law, whatever it computes: it is exact where nothing is random, draws as many
// uniforms as it says, and treats bad input as documented.
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include <mica/numeric/pack.hpp>
#include <mica/random/uniform_stream.hpp>

#include "every_law.hpp"
#include "scripted_uniforms.hpp"

namespace {

using mica::uniform_stream;

template <class Law>
class EveryLaw : public testing::Test {};
TYPED_TEST_SUITE(EveryLaw, every_law, by_law_name);

/// How many uniforms the headers say that a law draws; 0: any number.
template <class Law>
constexpr std::size_t stated_draws = 2;
template <>
constexpr std::size_t stated_draws<mica::gaussian_binomial> = 1;
template <>
constexpr std::size_t stated_draws<mica::bernoulli_sum_binomial> = 18;
template <>
constexpr std::size_t stated_draws<mica::exact_binomial> = 0;
template <int Gates>
constexpr std::size_t stated_draws<mica::smooth_quantile_binomial<Gates>> = 1;

/// The formula of the floored gated law, as published, does not interpolate between integers.
template <class Law>
constexpr bool interpolates_real_trials = true;
template <class Gate>
constexpr bool interpolates_real_trials<mica::basic_floored_gated_binomial<Gate>> = false;

/// Successes and failures with two uniforms, given again and again. Not inlined: there is much of a law.
template <class Law, class Real>
[[gnu::noinline]] mica::counts<Real> drawn_with(Real trials, Real probability, Real first, Real second) {
    return Law{}(trials, probability, scripted_uniforms<Real, 2>{{first, second}});
}

template <class Law, class Real>
void expect_concept() {
    static_assert(mica::binomial_law<Law, Real> && mica::binomial_law<Law, mica::pack<Real, 4>>);
    static_assert(mica::binomial_law<Law, mica::pack<Real, 8>> && mica::binomial_law<Law, mica::pack<Real, 16>>);
}

TYPED_TEST(EveryLaw, TakesEveryNumberType) {
    expect_concept<TypeParam, float>();
    expect_concept<TypeParam, double>();
}

/// A law as a function, so that what is expected of it is compiled once, not once for each law.
template <class Real>
using draw = mica::counts<Real> (*)(Real trials, Real probability, Real first, Real second);

template <class Real>
void expect_certainty(draw<Real> law) {
    for (const double trials : {0., 1., 2., 3., 10., 1000., 1e6, 1e12, 1e15}) {
        const Real n = static_cast<Real>(trials);
        each_extreme_pair<Real>([&](Real a, Real b) {
            const auto never = law(n, Real(0), a, b);
            EXPECT_EQ(never.successes, 0) << "N = " << n << ", p = 0, xi = " << a << ", " << b;
            EXPECT_EQ(never.failures, n) << "N = " << n << ", p = 0, xi = " << a << ", " << b;
            const auto always = law(n, Real(1), a, b);
            EXPECT_EQ(always.successes, n) << "N = " << n << ", p = 1, xi = " << a << ", " << b;
            EXPECT_EQ(always.failures, 0) << "N = " << n << ", p = 1, xi = " << a << ", " << b;
        });
    }
}

TYPED_TEST(EveryLaw, IsExactWhereNothingIsRandom) {
    expect_certainty<float>(drawn_with<TypeParam, float>);
    expect_certainty<double>(drawn_with<TypeParam, double>);
}

/// At real trials only the number of trials is random: p = 0 gives no success, p = 1 no failure.
template <class Real>
void expect_certainty_at_real_trials(draw<Real> law, bool interpolates) {
    for (const double trials : {0.05, 0.5, 0.95, 1.001, 1.5, 1.999, 7.25}) {
        const Real n = static_cast<Real>(trials);
        each_extreme_pair<Real>([&](Real a, Real b) {
            const auto never = law(n, Real(0), a, b);
            EXPECT_EQ(never.successes, 0) << n << ' ' << a << ' ' << b;
            EXPECT_TRUE(never.failures >= 0 && never.failures <= std::ceil(n)) << n << ' ' << a << ' ' << b;
            const auto always = law(n, Real(1), a, b);
            if (interpolates) {
                EXPECT_EQ(always.failures, 0) << n << ' ' << a << ' ' << b;
            }
            EXPECT_TRUE(always.successes >= 0 && always.successes <= std::ceil(n)) << n << ' ' << a << ' ' << b;
        });
    }
}

TYPED_TEST(EveryLaw, HasNoWrongOutcomeAtRealTrials) {
    constexpr bool interpolates = interpolates_real_trials<TypeParam>;
    expect_certainty_at_real_trials<float>(drawn_with<TypeParam, float>, interpolates);
    expect_certainty_at_real_trials<double>(drawn_with<TypeParam, double>, interpolates);
}

/// A law that can be asked for any parameters draws the same number of uniforms at all of them, or lanes would part.
TYPED_TEST(EveryLaw, DrawsAsManyUniformsAsStated) {
    if (stated_draws<TypeParam> == 0) return; // exact_test.cpp
    for (const double n : {0., 0.5, 1., 1.5, 2., 16., 17., 1e9, -1., std::numeric_limits<double>::quiet_NaN()})
        for (const double p : {0., 1e-9, 0.3, 0.7, 1., std::numeric_limits<double>::quiet_NaN()})
            each_extreme_pair<double>([&](double a, double b) {
                scripted_uniforms<double, 2> xi{{a, b}};
                TypeParam{}(n, p, xi);
                EXPECT_EQ(xi.drawn, stated_draws<TypeParam>) << n << ' ' << p;
            });
}

template <class Law, class Real>
[[gnu::noinline]] mica::counts<Real> drawn_from_stream(Real trials, Real probability, std::uint32_t index) {
    return Law{}(trials, probability, uniform_stream<Real>{17U, index});
}

template <class Real>
void expect_bad_input_as_documented(mica::counts<Real> (*law)(Real trials, Real probability, std::uint32_t index)) {
    using limits = std::numeric_limits<Real>;
    const Real nan = limits::quiet_NaN();
    const Real infinity = limits::infinity();
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

TYPED_TEST(EveryLaw, TreatsBadInputAsDocumented) {
    expect_bad_input_as_documented<float>(drawn_from_stream<TypeParam, float>);
    expect_bad_input_as_documented<double>(drawn_from_stream<TypeParam, double>);
}

/// Laws of polynomials alone are evaluated while compiling.
static_assert(mica::quantile_binomial<4>{}(100.F, 0.25F, [] { return 0.5F; }).successes == 25);
static_assert(mica::dual_gated_binomial{}(2.F, 0.5F, [] { return 0.5F; }).failures == 1);

} // namespace
