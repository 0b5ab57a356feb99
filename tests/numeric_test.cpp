// tests/numeric_test.cpp: the elementary functions against long double and Boost.Math, with the largest errors that
// the headers state, and packs against scalars bit for bit. Also compiled with MICA_VECTOR_EXTENSIONS=0.
//
// The binary32 functions are swept over every 257th value of their domain and its special ones, or, where
// MICA_SWEEP_STRIDE is 1, over all of them: the target full_sweep does that, and prints the largest errors.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "mica/numeric/gate.hpp"
#include "mica/numeric/normal.hpp"
#include "mica/numeric/pack.hpp"

#include "statistics.hpp"

namespace {

/// The number in which a result is judged: 29 bits, or 11, more than it has.
template <class Real>
using reference = std::conditional_t<sizeof(Real) == 4, double, long double>;

/// The largest error seen, and where. A NaN stays.
template <class Real>
struct largest_error {
    double value = 0;
    Real where = 0;

    void see(double error, Real at) {
        if (error <= value || std::isnan(value)) return;
        value = error;
        where = at;
    }

    void expect_at_most(double stated) const {
        std::printf("largest error %.4g at %a, stated %g\n", value, static_cast<double>(where), stated);
        EXPECT_TRUE(value <= stated) << "error " << value << " at " << where << ", stated " << stated;
    }
};

/// The error of `computed` in units in the last place of the exact value.
template <class Real>
double error_in_ulp(Real computed, reference<Real> exact) {
    using limits = std::numeric_limits<Real>;
    if (exact == 0) return computed == 0 ? 0 : std::numeric_limits<double>::infinity();
    const int exponent = (std::max)(std::ilogb(exact), limits::min_exponent - 1) - (limits::digits - 1);
    return static_cast<double>(std::abs((computed - exact) / std::ldexp(reference<Real>(1), exponent)));
}

template <class Real>
double relative_error(Real computed, reference<Real> exact) {
    if (exact == 0) return computed == 0 ? 0 : std::numeric_limits<double>::infinity();
    return static_cast<double>(std::abs((computed - exact) / exact));
}

/// 1 for the full sweep. 257 is prime, so every pattern of low bits is met.
std::uint32_t sweep_stride() {
    const char* const asked = std::getenv("MICA_SWEEP_STRIDE");
    return asked ? static_cast<std::uint32_t>(std::strtoul(asked, nullptr, 10)) : 257;
}

/// Every binary32 value from `first` to `last`, of equal sign, in the strides of the sweep, and `last` itself.
template <class Visit>
void each_float(float first, float last, Visit visit) {
    const auto low = std::bit_cast<std::uint32_t>(first);
    const auto high = std::bit_cast<std::uint32_t>(last);
    const std::uint32_t stride = sweep_stride();
    for (std::uint64_t bits = low; bits < high; bits += stride)
        visit(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    visit(last);
}

/// 200 000 doubles from `first` to `last`, of equal sign, their logarithms evenly spaced.
template <class Visit>
void each_double(double first, double last, Visit visit) {
    constexpr int count = 200'000;
    const double sign = first < 0 ? -1 : 1;
    const double low = std::log2(std::abs(first));
    const double step = (std::log2(std::abs(last)) - low) / (count - 1);
    visit(first);
    for (int i = 1; i + 1 < count; ++i) visit(sign * std::exp2(low + i * step));
    visit(last);
}

/// Doubles ever nearer to `x`, from both sides.
template <class Visit>
void each_double_near(double x, Visit visit) {
    visit(x);
    for (int k = 2; k < 54; ++k) {
        visit(x * (1 - std::ldexp(1., -k)));
        visit(x * (1 + std::ldexp(1., -k)));
    }
}

constexpr float smallest_float = std::numeric_limits<float>::min();
constexpr float largest_float = (std::numeric_limits<float>::max)();
constexpr float below_one_float = 1 - 0x1p-24F;
constexpr double smallest_double = std::numeric_limits<double>::min();
constexpr double largest_double = (std::numeric_limits<double>::max)();
constexpr double below_one_double = 1 - 0x1p-53;

// log

/// Where |log x| < 1/2 the statement is about absolute error, elsewhere about ulp. Both as multiples of what is stated.
template <class Real>
double log_error(Real x, double stated_ulp, double stated_absolute) {
    const auto exact = std::log(static_cast<reference<Real>>(x));
    if (std::abs(exact) < 0.5) return static_cast<double>(std::abs(mica::log(x) - exact)) / stated_absolute;
    return error_in_ulp(mica::log(x), exact) / stated_ulp;
}

TEST(Log, FloatHasTheStatedError) {
    largest_error<float> largest;
    each_float(smallest_float, largest_float, [&](float x) { largest.see(log_error(x, 2, 5e-8), x); });
    for (const float x : {1.F, 0.5F, below_one_float}) largest.see(log_error(x, 2, 5e-8), x);
    largest.expect_at_most(1);
}

TEST(Log, DoubleHasTheStatedError) {
    largest_error<double> largest;
    const auto visit = [&](double x) { largest.see(log_error(x, 2, 2e-16), x); };
    each_double(smallest_double, largest_double, visit);
    each_double(0.25, 4, visit);
    each_double_near(1, visit);
    largest.expect_at_most(1);
}

TEST(Log, OfZeroIsFinite) {
    EXPECT_TRUE(mica::log(0.F) <= -87 && mica::log(0.F) >= -89) << mica::log(0.F);
    EXPECT_TRUE(mica::log(0.) <= -708 && mica::log(0.) >= -710) << mica::log(0.);
}

// log1p_neg

TEST(Log1pNeg, FloatHasTheStatedError) {
    largest_error<float> largest;
    const auto visit = [&](float p) {
        largest.see(error_in_ulp(mica::log1p_neg(p), std::log1p(-static_cast<double>(p))), p);
    };
    each_float(0, below_one_float, visit);
    for (const float p : {smallest_float, 0.5F, 0.5F + 0x1p-24F, 0.5F - 0x1p-25F}) visit(p);
    largest.expect_at_most(2);
}

TEST(Log1pNeg, DoubleHasTheStatedError) {
    largest_error<double> largest;
    const auto visit = [&](double p) {
        largest.see(error_in_ulp(mica::log1p_neg(p), std::log1p(-static_cast<long double>(p))), p);
    };
    visit(0);
    each_double(smallest_double, below_one_double, visit);
    each_double(0.01, below_one_double, visit);
    each_double_near(0.5, visit);
    for (int k = 2; k < 54; ++k) visit(1 - std::ldexp(1., -k));
    largest.expect_at_most(2);
}

TEST(LogComplement, FloatHasTheStatedError) {
    largest_error<float> largest;
    const auto visit = [&](float p) {
        largest.see(error_in_ulp(mica::log_complement(p), std::log1p(-static_cast<double>(p))), p);
    };
    each_float(0, 0.5F, visit);
    for (const float p : {smallest_float, 0.5F, 0.5F - 0x1p-25F}) visit(p);
    largest.expect_at_most(2);
}

TEST(LogComplement, DoubleHasTheStatedError) {
    largest_error<double> largest;
    const auto visit = [&](double p) {
        largest.see(error_in_ulp(mica::log_complement(p), std::log1p(-static_cast<long double>(p))), p);
    };
    visit(0);
    each_double(smallest_double, 0.5, visit);
    each_double(0.01, 0.5, visit);
    largest.expect_at_most(2);
}

TEST(Log1pNeg, OfOneIsTheLogOfZero) {
    EXPECT_EQ(mica::log1p_neg(1.F), mica::log(0.F));
    EXPECT_EQ(mica::log1p_neg(1.), mica::log(0.));
}

// exp

TEST(Exp, FloatHasTheStatedError) {
    largest_error<float> largest;
    const auto visit = [&](float y) { largest.see(error_in_ulp(mica::exp(y), std::exp(static_cast<double>(y))), y); };
    each_float(0.F, 88.37F, visit);
    each_float(-0.F, -87.F, visit);
    largest.expect_at_most(2);
}

TEST(Exp, DoubleHasTheStatedError) {
    largest_error<double> largest;
    const auto visit = [&](double y) {
        largest.see(error_in_ulp(mica::exp(y), std::exp(static_cast<long double>(y))), y);
    };
    visit(0);
    each_double(smallest_double, 709, visit);
    each_double(-smallest_double, -708, visit);
    each_double(0.01, 709, visit);
    each_double(-0.01, -708, visit);
    largest.expect_at_most(2);
}

template <class Real>
void expect_exponential_ends() {
    const Real infinity = std::numeric_limits<Real>::infinity();
    EXPECT_EQ(mica::exp(-infinity), 0);
    EXPECT_EQ(mica::exp(Real(-1000)), 0);
    EXPECT_EQ(mica::exp((std::numeric_limits<Real>::lowest)()), 0);
    EXPECT_EQ(mica::expm1(-infinity), -1);
    EXPECT_TRUE(std::isfinite(mica::exp(infinity)));
    EXPECT_EQ(mica::exp(infinity), mica::exp(Real(1000)));
    EXPECT_TRUE(std::isfinite(mica::expm1(infinity)));
}

TEST(Exp, EndsAreZeroAndFinite) {
    expect_exponential_ends<float>();
    expect_exponential_ends<double>();
}

/// Between -88.7 and -87.3 the exponential is subnormal; it must be cut to 0 and not wrap round.
TEST(Exp, UnderflowsToZeroAndStaysMonotone) {
    float before = 0;
    for (int i = 0; i <= 4096; ++i) {
        const float y = -89.F + static_cast<float>(i) * (2.F / 4096);
        const float value = mica::exp(y);
        EXPECT_TRUE(value >= before) << y;
        EXPECT_TRUE(value == 0 || value >= smallest_float * 0.999F) << y;
        before = value;
    }
}

/// Above the stated domain the value stops growing; it must not fall back where 2^128 would be needed.
template <class Real>
void expect_monotone_upper_end(Real from, Real to) {
    constexpr int steps = 4096;
    Real before = 0;
    Real before_minus_one = 0;
    for (int i = 0; i <= steps; ++i) {
        const Real y = from + (to - from) * (static_cast<Real>(i) / steps);
        EXPECT_TRUE(mica::exp(y) >= before) << "exp(" << y << ')';
        EXPECT_TRUE(mica::expm1(y) >= before_minus_one) << "expm1(" << y << ')';
        before = mica::exp(y);
        before_minus_one = mica::expm1(y);
    }
}

TEST(Exp, StaysMonotoneAtTheUpperEnd) {
    expect_monotone_upper_end<float>(87, 90);
    expect_monotone_upper_end<double>(708, 711);
}

// log2, exp2

/// Where |log2 x| < 1/2 the statement is about absolute error, elsewhere about ulp. Both as multiples of what is stated.
template <class Real>
double log2_error(Real x, double stated_ulp, double stated_absolute) {
    const auto exact = std::log2(static_cast<reference<Real>>(x));
    if (std::abs(exact) < 0.5) return static_cast<double>(std::abs(mica::log2(x) - exact)) / stated_absolute;
    return error_in_ulp(mica::log2(x), exact) / stated_ulp;
}

TEST(Log2, FloatHasTheStatedError) {
    largest_error<float> largest;
    each_float(smallest_float, largest_float, [&](float x) { largest.see(log2_error(x, 2, 1e-7), x); });
    for (const float x : {1.F, 0.5F, below_one_float}) largest.see(log2_error(x, 2, 1e-7), x);
    largest.expect_at_most(1);
}

TEST(Log2, DoubleHasTheStatedError) {
    largest_error<double> largest;
    const auto visit = [&](double x) { largest.see(log2_error(x, 2, 3e-16), x); };
    each_double(smallest_double, largest_double, visit);
    each_double(0.25, 4, visit);
    each_double_near(1, visit);
    largest.expect_at_most(1);
}

TEST(Exp2, FloatHasTheStatedError) {
    largest_error<float> largest;
    const auto visit = [&](float x) { largest.see(error_in_ulp(mica::exp2(x), std::exp2(static_cast<double>(x))), x); };
    each_float(0.F, 127.F, visit);
    each_float(-0.F, -126.F, visit);
    largest.expect_at_most(2);
}

TEST(Exp2, DoubleHasTheStatedError) {
    largest_error<double> largest;
    const auto visit = [&](double x) {
        largest.see(error_in_ulp(mica::exp2(x), std::exp2(static_cast<long double>(x))), x);
    };
    visit(0);
    each_double(smallest_double, 1023, visit);
    each_double(-smallest_double, -1022, visit);
    each_double(0.01, 1023, visit);
    each_double(-0.01, -1022, visit);
    largest.expect_at_most(2);
}

template <class Real>
void expect_exact_powers_of_two(int least, int most) {
    for (int k = least; k <= most; ++k) {
        EXPECT_EQ(mica::exp2(static_cast<Real>(k)), std::ldexp(Real(1), k));
        EXPECT_EQ(mica::log2(std::ldexp(Real(1), k)), static_cast<Real>(k));
    }
    EXPECT_EQ(mica::exp2(static_cast<Real>(2 * least)), 0);
    EXPECT_EQ(mica::exp2(static_cast<Real>(2 * most)), std::ldexp(Real(1), most));
}

TEST(Exp2, IsExactAtIntegersAndSoIsItsInverse) {
    expect_exact_powers_of_two<float>(-126, 127);
    expect_exact_powers_of_two<double>(-1022, 1023);
}

// expm1

TEST(Expm1, FloatHasTheStatedError) {
    largest_error<float> largest;
    const auto visit = [&](float y) {
        largest.see(error_in_ulp(mica::expm1(y), std::expm1(static_cast<double>(y))), y);
    };
    each_float(0.F, 88.37F, visit);
    each_float(-0.F, -largest_float, visit);
    for (const float y : {0.34375F, -0.34375F, 0.5F, -0.5F}) visit(y);
    largest.expect_at_most(4);
}

TEST(Expm1, DoubleHasTheStatedError) {
    largest_error<double> largest;
    const auto visit = [&](double y) {
        largest.see(error_in_ulp(mica::expm1(y), std::expm1(static_cast<long double>(y))), y);
    };
    visit(0);
    each_double(smallest_double, 709, visit);
    each_double(-smallest_double, -largest_double, visit);
    each_double(0.01, 709, visit);
    each_double(-0.01, -50, visit);
    each_double_near(0.34375, visit);
    each_double_near(-0.34375, visit);
    largest.expect_at_most(4);
}

// inverse_sqrt

TEST(InverseSqrt, FloatHasTheStatedError) {
    largest_error<float> largest;
    each_float(smallest_float, largest_float, [&](float x) {
        largest.see(error_in_ulp(mica::inverse_sqrt(x), 1 / std::sqrt(static_cast<double>(x))), x);
    });
    largest.expect_at_most(4);
}

TEST(InverseSqrt, DoubleHasTheStatedError) {
    largest_error<double> largest;
    each_double(smallest_double, largest_double, [&](double x) {
        largest.see(error_in_ulp(mica::inverse_sqrt(x), 1 / std::sqrt(static_cast<long double>(x))), x);
    });
    largest.expect_at_most(4);
}

// sqrt

TEST(Sqrt, FloatHasTheStatedError) {
    largest_error<float> largest;
    const auto visit = [&](float x) { largest.see(error_in_ulp(mica::sqrt(x), std::sqrt(static_cast<double>(x))), x); };
    each_float(smallest_float, largest_float, visit);
    for (const float x : {0.F, 0.5F, 1.F, 4.F, below_one_float}) visit(x);
    largest.expect_at_most(1);
}

TEST(Sqrt, DoubleHasTheStatedError) {
    largest_error<double> largest;
    const auto visit = [&](double x) {
        largest.see(error_in_ulp(mica::sqrt(x), std::sqrt(static_cast<long double>(x))), x);
    };
    visit(0);
    each_double(smallest_double, largest_double, visit);
    each_double(0.25, 4, visit);
    each_double_near(1, visit);
    largest.expect_at_most(1);
}

template <class Real>
void expect_no_root() {
    for (const Real x : {Real(0), Real(-0.), Real(-1), (std::numeric_limits<Real>::lowest)(),
                         std::numeric_limits<Real>::denorm_min(), std::numeric_limits<Real>::min() / 2})
        EXPECT_EQ(mica::sqrt(x), 0) << x;
}

TEST(Sqrt, IsZeroAtNegativeAndSubnormalNumbers) {
    expect_no_root<float>();
    expect_no_root<double>();
}

// floor, clamp, is_nan

TEST(Floor, IsExactAtEveryFloat) {
    largest_error<float> largest;
    const auto visit = [&](float x) { largest.see(std::abs(mica::floor(x) - std::floor(x)), x); };
    each_float(0.F, largest_float, visit);
    each_float(-0.F, -largest_float, visit);
    for (const float x : {0x1p23F - 0.5F, 0x1p23F, 0x1p23F + 1, 0x1p24F, 0x1p31F, 0x1p32F}) {
        visit(x);
        visit(-x);
    }
    largest.expect_at_most(0);
}

TEST(Truncate, IsTheFloorOfEveryPositiveFloat) {
    largest_error<float> largest;
    const auto visit = [&](float x) { largest.see(std::abs(mica::truncate(x) - std::floor(x)), x); };
    each_float(0.F, largest_float, visit);
    for (const float x : {0x1p23F - 0.5F, 0x1p23F, 0x1p23F + 1, 0x1p24F, 0x1p31F, 0x1p32F}) visit(x);
    largest.expect_at_most(0);
}

TEST(Floor, IsExactAtEveryDouble) {
    largest_error<double> largest;
    const auto visit = [&](double x) { largest.see(std::abs(mica::floor(x) - std::floor(x)), x); };
    visit(0);
    each_double(1e-3, largest_double, visit);
    each_double(-1e-3, -largest_double, visit);
    for (const double x : {0x1p52 - 0.5, 0x1p52, 0x1p52 + 1, 0x1p53, 0x1p63, 0x1p64}) {
        visit(x);
        visit(-x);
    }
    for (int i = -1000; i <= 1000; ++i) each_double_near(i, visit);
    largest.expect_at_most(0);
}

template <class Real>
void expect_nan_is_handled() {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    const Real infinity = std::numeric_limits<Real>::infinity();
    EXPECT_TRUE(mica::is_nan(nan));
    EXPECT_TRUE(mica::is_nan(-nan));
    EXPECT_TRUE(mica::is_nan(std::numeric_limits<Real>::signaling_NaN()));
    for (const Real x : {Real(0), Real(-0.), Real(1), infinity, -infinity, (std::numeric_limits<Real>::max)()})
        EXPECT_TRUE(!mica::is_nan(x)) << x;
    EXPECT_EQ(mica::clamp(nan, Real(2), Real(3)), 2);
    EXPECT_EQ(mica::minimum(nan, Real(3)), 3);
    EXPECT_EQ(mica::maximum(nan, Real(3)), 3);
    EXPECT_EQ(mica::clamp(infinity, Real(2), Real(3)), 3);
    EXPECT_EQ(mica::clamp(-infinity, Real(2), Real(3)), 2);
}

TEST(Number, NanIsRecognisedAndClampedToTheLowEnd) {
    expect_nan_is_handled<float>();
    expect_nan_is_handled<double>();
}

// normal_quantile

TEST(NormalQuantile, FloatHasTheStatedError) {
    largest_error<float> largest;
    const auto visit = [&](float u) {
        largest.see(relative_error(mica::normal_quantile(u), statistics::normal_quantile(static_cast<double>(u))), u);
    };
    each_float(0x1p-32F, below_one_float, visit);
    for (int k = 2; k < 24; ++k) {
        visit(0.5F - std::ldexp(1.F, -k));
        visit(0.5F + std::ldexp(1.F, -k));
    }
    largest.expect_at_most(8e-7);
}

/// Over all that uniform_stream<double> can return.
TEST(NormalQuantile, DoubleHasTheStatedError) {
    largest_error<double> largest;
    const auto visit = [&](double u) {
        largest.see(relative_error(mica::normal_quantile(u), statistics::normal_quantile(static_cast<long double>(u))),
                    u);
    };
    for (double u = 0x1p-53; u < 1; u *= 1.001) visit(u);
    for (double u = 0x1p-53; u < 1; u *= 1.001) visit(1 - u);
    for (int k = 2; k < 52; ++k) {
        visit(0.5 - std::ldexp(1., -k));
        visit(0.5 + std::ldexp(1., -k));
    }
    largest.expect_at_most(1e-15);
}

TEST(NormalQuantile, IsOddAboutOneHalf) {
    for (int i = 1; i < 4096; ++i) {
        const float u = static_cast<float>(i) / 4096;
        EXPECT_EQ(mica::normal_quantile(u), -mica::normal_quantile(1 - u)) << u;
        const double v = static_cast<double>(i) / 4096;
        EXPECT_EQ(mica::normal_quantile(v), -mica::normal_quantile(1 - v)) << v;
    }
    EXPECT_EQ(mica::normal_quantile(0.5F), 0);
    EXPECT_EQ(mica::normal_quantile(0.5), 0);
}

TEST(NormalQuantile, StopsInTheFarTailOfFloat) {
    const float end = mica::normal_quantile(1.9e-10F);
    EXPECT_TRUE(std::abs(mica::normal_quantile(1e-20F) - end) <= 1e-3F);
    EXPECT_TRUE(std::isfinite(mica::normal_quantile(0.F)));
    EXPECT_TRUE(std::isfinite(mica::normal_quantile(1.F)));
}

// log1p_gate

/// N = 10^0..10^16 and p = 10^-16..1, the domain for which the gate states its errors.
template <class Real, class Visit>
void each_gate_argument(Visit visit) {
    constexpr int steps = 512;
    for (int i = 0; i <= steps; ++i)
        for (int j = 0; j <= steps; ++j)
            visit(static_cast<Real>(std::pow(10., 16. * i / steps)),
                  static_cast<Real>(std::pow(10., 16. * j / steps - 16)));
}

template <class Real>
long double exact_log_gate(Real trials, Real probability) {
    return static_cast<long double>(trials) * std::log1p(-static_cast<long double>(probability));
}

template <class Real>
void expect_gate(double stated_absolute, double stated_relative) {
    largest_error<Real> none;
    largest_error<Real> any;
    each_gate_argument<Real>([&](Real n, Real p) {
        const long double logarithm = exact_log_gate(n, p);
        const auto of_none = mica::log1p_gate::none(n, p) - std::exp(logarithm);
        const auto of_any = mica::log1p_gate::any(n, p) / -std::expm1(logarithm) - 1;
        none.see(static_cast<double>(std::abs(of_none)), p);
        any.see(static_cast<double>(std::abs(of_any)), p);
    });
    none.expect_at_most(stated_absolute);
    any.expect_at_most(stated_relative);
}

TEST(Log1pGate, FloatHasTheStatedErrors) { expect_gate<float>(1e-7, 3e-7); }
TEST(Log1pGate, DoubleHasTheStatedErrors) { expect_gate<double>(2e-16, 1e-15); }

template <class Real>
void expect_gate_ends() {
    const Real largest = (std::numeric_limits<Real>::max)();
    for (const Real n : {Real(0.5), Real(1), Real(2), Real(1e16), largest}) {
        EXPECT_EQ(mica::log1p_gate::none(n, Real(1)), 0) << n;
        EXPECT_EQ(mica::log1p_gate::any(n, Real(1)), 1) << n;
        EXPECT_EQ(mica::log1p_gate::none(n, Real(0)), 1) << n;
        EXPECT_EQ(mica::log1p_gate::any(n, Real(0)), 0) << n;
    }
    for (const Real p : {Real(0), Real(1e-30), Real(0.5), Real(1)}) {
        EXPECT_EQ(mica::log1p_gate::none(Real(0), p), 1) << p;
        EXPECT_EQ(mica::log1p_gate::any(Real(0), p), 0) << p;
    }
    EXPECT_EQ(mica::log1p_gate::none(largest, Real(0.5)), 0);
    EXPECT_EQ(mica::log1p_gate::any(largest, Real(0.5)), 1);
}

TEST(Log1pGate, IsExactWhereNothingIsRandom) {
    expect_gate_ends<float>();
    expect_gate_ends<double>();
}

// pack

template <class Pack>
Pack load(const std::array<typename Pack::value_type, mica::lanes_of<Pack>>& values) {
    return Pack::load(values.data());
}

/// Numbers of every size and kind, a few of them not finite, padded to a multiple of the lanes.
template <class Real>
std::vector<Real> mixed_numbers() {
    using limits = std::numeric_limits<Real>;
    std::vector<Real> numbers{0,
                              Real(-0.),
                              1,
                              -1,
                              Real(0.5),
                              Real(-0.5),
                              Real(1) - limits::epsilon() / 2,
                              limits::min(),
                              limits::denorm_min(),
                              (limits::max)(),
                              limits::lowest(),
                              limits::infinity(),
                              -limits::infinity(),
                              Real(0.34375),
                              Real(-0.34375),
                              Real(88)};
    for (int i = 0; i < 4096; ++i) numbers.push_back(static_cast<Real>(std::exp2(i / 32. - 64)));
    for (int i = 0; i < 4096; ++i) numbers.push_back(static_cast<Real>(i - 2048) / 16);
    for (int i = 1; i < 4096; ++i) numbers.push_back(static_cast<Real>(i) / 4096);
    numbers.push_back(Real(0.25));
    return numbers;
}

template <class Real>
bool same_bits(Real a, Real b) {
    using Bits = mica::bits_of<Real>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b) || (mica::is_nan(a) && mica::is_nan(b));
}

/// f(pack) gives in every lane what f(scalar) gives.
template <class Pack, class Function>
void expect_same_in_every_lane(const char* name, Function f) {
    using Real = typename Pack::value_type;
    constexpr int lanes = mica::lanes_of<Pack>;
    const auto numbers = mixed_numbers<Real>();
    for (std::size_t i = 0; i + lanes <= numbers.size(); i += lanes) {
        const Pack result = f(Pack::load(&numbers[i]));
        for (int j = 0; j < lanes; ++j) {
            const Real x = numbers[i + static_cast<std::size_t>(j)];
            const Real expected = f(x);
            EXPECT_TRUE(same_bits(result[j], expected))
                << name << '(' << x << ") = " << expected << ", " << result[j] << " in lane " << j;
        }
    }
}

/// The number limited to [low, high], for functions whose domain is smaller; NaN cannot occur.
template <class Number>
Number within(Number x, double low, double high) {
    return mica::clamp(x, Number(low), Number(high));
}

template <class Pack>
void expect_functions_same_in_every_lane() {
    using Real = typename Pack::value_type;
    using limits = std::numeric_limits<Real>;
    expect_same_in_every_lane<Pack>("log", [](auto x) { return mica::log(within(x, limits::min(), (limits::max)())); });
    expect_same_in_every_lane<Pack>("log1p_neg", [](auto x) { return mica::log1p_neg(within(x, 0, 1)); });
    expect_same_in_every_lane<Pack>("exp", [](auto x) { return mica::exp(x); });
    expect_same_in_every_lane<Pack>("expm1", [](auto x) { return mica::expm1(x); });
    expect_same_in_every_lane<Pack>(
        "inverse_sqrt", [](auto x) { return mica::inverse_sqrt(within(x, limits::min(), (limits::max)())); });
    expect_same_in_every_lane<Pack>("log2",
                                    [](auto x) { return mica::log2(within(x, limits::min(), (limits::max)())); });
    expect_same_in_every_lane<Pack>("exp2", [](auto x) { return mica::exp2(x); });
    expect_same_in_every_lane<Pack>("sqrt",
                                    [](auto x) { return mica::sqrt(within(x, limits::lowest(), (limits::max)())); });
    expect_same_in_every_lane<Pack>("log_complement", [](auto x) { return mica::log_complement(within(x, 0, 0.5)); });
    expect_same_in_every_lane<Pack>("floor", [](auto x) { return mica::floor(x); });
    expect_same_in_every_lane<Pack>("truncate", [](auto x) { return mica::truncate(within(x, 0, (limits::max)())); });
    expect_same_in_every_lane<Pack>("abs", [](auto x) { return mica::abs(x); });
    expect_same_in_every_lane<Pack>("minimum", [](auto x) { return mica::minimum(x, 3); });
    expect_same_in_every_lane<Pack>("maximum", [](auto x) { return mica::maximum(x, 3); });
    expect_same_in_every_lane<Pack>("clamp", [](auto x) { return mica::clamp(x, -1, 1); });
    expect_same_in_every_lane<Pack>("normal_quantile", [](auto x) { return mica::normal_quantile(within(x, 0, 1)); });
    for (const double n : {0., 1., 7.3, 1e9}) {
        expect_same_in_every_lane<Pack>(
            "none", [n](auto x) { return mica::log1p_gate::none(decltype(x)(static_cast<Real>(n)), within(x, 0, 1)); });
        expect_same_in_every_lane<Pack>(
            "any", [n](auto x) { return mica::log1p_gate::any(decltype(x)(static_cast<Real>(n)), within(x, 0, 1)); });
    }
}

TEST(Pack, FunctionsGiveWhatTheyGiveForScalars) {
    expect_functions_same_in_every_lane<mica::pack<float, 4>>();
    expect_functions_same_in_every_lane<mica::pack<float, 8>>();
    expect_functions_same_in_every_lane<mica::pack<double, 4>>();
}

template <class Pack>
void expect_arithmetic() {
    using T = typename Pack::value_type;
    constexpr int lanes = mica::lanes_of<Pack>;
    const Pack a = Pack::iota(T(3));
    const Pack b = Pack::iota(T(1)) * Pack(2);
    for (int i = 0; i < lanes; ++i) {
        const T x = a[i];
        const T y = b[i];
        EXPECT_EQ(x, static_cast<T>(3 + i));
        EXPECT_EQ(y, static_cast<T>(2 + 2 * i));
        EXPECT_EQ((a + b)[i], x + y);
        EXPECT_EQ((a - b)[i], static_cast<T>(x - y));
        EXPECT_EQ((a * b)[i], x * y);
        EXPECT_EQ((a / b)[i], x / y);
        EXPECT_EQ((-a)[i], static_cast<T>(-x));
        EXPECT_EQ((a < b)[i], x < y);
        EXPECT_EQ((a <= b)[i], x <= y);
        EXPECT_EQ((a > b)[i], x > y);
        EXPECT_EQ((a >= b)[i], x >= y);
        EXPECT_EQ((a == b)[i], x == y);
        EXPECT_EQ(mica::select(a < b, a, b)[i], x < y ? x : y);
        EXPECT_EQ(mica::lane(a, i), x);
    }
}

TEST(Pack, ArithmeticAndComparisonsWorkLaneByLane) {
    expect_arithmetic<mica::pack<float, 4>>();
    expect_arithmetic<mica::pack<float, 8>>();
    expect_arithmetic<mica::pack<double, 4>>();
    expect_arithmetic<mica::pack<std::int32_t, 8>>();
    expect_arithmetic<mica::pack<std::uint32_t, 4>>();
    expect_arithmetic<mica::pack<std::int64_t, 4>>();
    expect_arithmetic<mica::pack<std::uint64_t, 4>>();
}

template <class Pack>
void expect_bit_operators() {
    using T = typename Pack::value_type;
    const Pack a = Pack::iota(T(0x1234567)) * Pack(0x35);
    const Pack b = Pack::iota(T(0x7654321));
    for (int i = 0; i < mica::lanes_of<Pack>; ++i) {
        EXPECT_EQ((a & b)[i], a[i] & b[i]);
        EXPECT_EQ((a | b)[i], a[i] | b[i]);
        EXPECT_EQ((a ^ b)[i], a[i] ^ b[i]);
        EXPECT_EQ((a >> 5)[i], a[i] >> 5);
        EXPECT_EQ((b << 3)[i], static_cast<T>(b[i] << 3));
    }
}

TEST(Pack, BitOperatorsWorkLaneByLane) {
    expect_bit_operators<mica::pack<std::int32_t, 8>>();
    expect_bit_operators<mica::pack<std::uint32_t, 4>>();
    expect_bit_operators<mica::pack<std::uint64_t, 4>>();
}

/// The exponent of a number below 1 is taken out of its bits by an arithmetic shift of a negative integer.
TEST(Pack, SignedShiftKeepsTheSign) {
    const mica::pack<std::int32_t, 4> a(-1024);
    for (int i = 0; i < 4; ++i) EXPECT_EQ((a >> 4)[i], -64);
}

TEST(Pack, UnsignedArithmeticWrapsRound) {
    const mica::pack<std::uint32_t, 4> largest(0xffffffffU);
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ((largest + mica::pack<std::uint32_t, 4>(2U))[i], 1U);
        EXPECT_EQ((largest * largest)[i], 1U);
        EXPECT_EQ((largest >> 31)[i], 1U);
    }
}

TEST(Pack, BroadcastKeepsTheSignOfZero) {
    const mica::pack<float, 4> zero(-0.F);
    const mica::pack<double, 4> wide_zero(-0.);
    for (int i = 0; i < 4; ++i) {
        EXPECT_TRUE(std::signbit(zero[i]));
        EXPECT_TRUE(std::signbit(wide_zero[i]));
    }
}

TEST(Pack, LoadsAndStoresLanesInOrder) {
    const std::array<float, 8> numbers{1, -2, 3.5F, 0, 5, 6, 7, 1e30F};
    const auto loaded = mica::pack<float, 8>::load(numbers.data());
    std::array<float, 8> stored{};
    loaded.store(stored.data());
    EXPECT_EQ(stored, numbers);

    auto changed = loaded;
    changed.set(2, 42);
    for (int i = 0; i < 8; ++i) EXPECT_EQ(changed[i], i == 2 ? 42 : numbers[static_cast<std::size_t>(i)]);
}

TEST(Pack, MasksCombine) {
    using Pack = mica::pack<float, 4>;
    const auto low = Pack::iota(0) < Pack(2);
    const auto even = load<Pack>({1, 0, 1, 0}) > Pack(0);
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(low[i], i < 2);
        EXPECT_EQ((low && even)[i], i == 0);
        EXPECT_EQ((low || even)[i], i != 3);
        EXPECT_EQ((!low)[i], i >= 2);
    }
    EXPECT_TRUE(mica::any(low) && !mica::all(low));
    EXPECT_TRUE(mica::any(low || !low) && mica::all(low || !low));
    EXPECT_TRUE(!mica::any(low && !low) && !mica::all(low && !low));
}

TEST(Pack, ComparisonsWithNanAreFalse) {
    using Pack = mica::pack<float, 4>;
    const Pack nan(std::numeric_limits<float>::quiet_NaN());
    EXPECT_TRUE(!mica::any(nan < Pack(0)) && !mica::any(nan >= Pack(0)) && !mica::any(nan == nan));
    EXPECT_TRUE(mica::all(mica::is_nan(nan)));
    EXPECT_TRUE(!mica::any(mica::is_nan(Pack(1))));
    EXPECT_TRUE(mica::all(mica::clamp(nan, 2, 3) == Pack(2)));
}

TEST(Pack, ConvertsTowardsZeroAndReinterpretsBits) {
    using Pack = mica::pack<float, 4>;
    const Pack x = load<Pack>({1.75F, -1.75F, 0, -1e6F});
    const auto whole = mica::convert<mica::integer_of<Pack>>(x);
    const auto back = mica::convert<Pack>(whole);
    const auto bits = mica::reinterpret<mica::bits_of<Pack>>(x);
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(whole[i], static_cast<std::int32_t>(x[i]));
        EXPECT_EQ(back[i], std::trunc(x[i]));
        EXPECT_EQ(bits[i], std::bit_cast<std::uint32_t>(x[i]));
        EXPECT_EQ(mica::reinterpret<Pack>(bits)[i], x[i]);
    }
    const auto wide = mica::convert<mica::pack<double, 4>>(mica::pack<std::uint32_t, 4>(0xffffffffU));
    for (int i = 0; i < 4; ++i) EXPECT_EQ(wide[i], 4294967295.);
}

} // namespace
