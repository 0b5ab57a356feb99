// mica/numeric/elementary.hpp: logarithm, exponential and square root, branch-free, for every number type.
//
// Own polynomials instead of <cmath>: std::pow costs more than a whole law and never vectorises, and these give the
// same bits on every target and lane count when floating contraction is off. For float they are minimax fits,
// printed by tools/fit_polynomials; for double the Taylor series, long enough to round.
//
// Largest errors, enforced by tests/numeric_test.cpp (float: every 257th value of the domain and all special ones):
//
//     function        domain                              float     double
//     log             normal, > 0                         2 ulp     2 ulp   (absolute 5e-8, 2e-16 where |log x| < 1/2)
//     log2            normal, > 0                         2 ulp     2 ulp   (absolute 1e-7, 3e-16 where |log2 x| < 1/2)
//     log1p_neg       p in [0, 1)                         2 ulp     2 ulp
//     log_complement  p in [0, 1/2]                       2 ulp     2 ulp
//     exp             [-87, 88.37]   ([-708, 709.43])     2 ulp     2 ulp
//     exp2            [-126, 127]    ([-1022, 1023])      2 ulp     2 ulp
//     expm1           [-inf, 88.37]  ([-inf, 709.43])     4 ulp     4 ulp   (next to ln2 / 2)
//     inverse_sqrt    normal, > 0                         4 ulp     4 ulp
//     sqrt            0 and normal                        1 ulp     1 ulp
#pragma once

#include <cstddef>
#include <utility>

#include "number.hpp"

namespace mica {

namespace detail {

/// c[0] + c[1] x + c[2] x^2 + ..., by Horner's rule.
template <real_number Real, std::size_t Count>
MICA_HOST_DEVICE constexpr Real polynomial(Real x, const scalar_of<Real> (&c)[Count]) {
    return [&]<std::size_t... K>(std::index_sequence<K...>) { // g++ -O2 would leave a loop a loop
        Real sum = Real(c[Count - 1]);
        ((sum = sum * x + Real(c[Count - 2 - K])), ...);
        return sum;
    }
    (std::make_index_sequence<Count - 1>());
}

/// Layout and constants of the binary formats.
template <class Scalar>
struct format;

template <>
struct format<float> {
    static constexpr int mantissa_bits = 23;
    static constexpr int bias = 127;
    static constexpr std::uint32_t two_thirds = 0x3f2aaaab;
    static constexpr float ln2_high = 0.693145752F; // 16 bits: k ln2_high is exact for |k| < 256
    static constexpr float ln2_low = 1.42860677e-6F;
    static constexpr float smallest_exponential = -87.33654F;
    static constexpr float largest_exponential = 88.3762F; // below 127.5 ln2, so that k <= 127
    static constexpr std::uint32_t inverse_sqrt_magic = 0x5f3759df;
    static constexpr int inverse_sqrt_steps = 3;
};

template <>
struct format<double> {
    static constexpr int mantissa_bits = 52;
    static constexpr int bias = 1023;
    static constexpr std::uint64_t two_thirds = 0x3fe5555555555555;
    static constexpr double ln2_high = 0.693147180369123816490; // 33 bits: k ln2_high is exact for |k| < 2048
    static constexpr double ln2_low = 1.90821492927058770002e-10;
    static constexpr double smallest_exponential = -708.3964185322641;
    static constexpr double largest_exponential = 709.4361; // below 1023.5 ln2
    static constexpr std::uint64_t inverse_sqrt_magic = 0x5fe6eb50c7b537a9;
    static constexpr int inverse_sqrt_steps = 4;
};

/// 2 atanh(t) = log((1+t)/(1-t)) for |t| <= 1/3.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real twice_atanh(Real t) {
    // From where the square no longer counts it is 0: t (s c) would be a subnormal number, on which processors are slow.
    constexpr auto epsilon = std::numeric_limits<scalar_of<Real>>::epsilon();
    const Real s = maximum(t * t - Real(epsilon * epsilon), Real(0));
    if constexpr (sizeof(scalar_of<Real>) == 4) {
        // degree 3 in s <= 1/9, relative error 4.6e-9
        constexpr float c[] = {0.6666641313F, 0.4002169908F, 0.2799914082F, 0.2802446005F};
        return t * Real(2) + t * (s * polynomial(s, c));
    } else {
        // 2/(2k+3): the series; its first omitted term is below 9^-17 / 18 of the sum
        constexpr double c[] = {2. / 3,  2. / 5,  2. / 7,  2. / 9,  2. / 11, 2. / 13, 2. / 15, 2. / 17,
                                2. / 19, 2. / 21, 2. / 23, 2. / 25, 2. / 27, 2. / 29, 2. / 31, 2. / 33};
        return t * Real(2) + t * (s * polynomial(s, c));
    }
}

/// exp(r) - 1 for |r| <= ln2 / 2, with relative accuracy.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real expm1_reduced(Real r) {
    if constexpr (sizeof(scalar_of<Real>) == 4) {
        // degree 4, relative error 1.4e-8
        constexpr float c[] = {0.4999999813F, 0.1666654268F, 0.0416672039F, 0.008366646793F, 0.001388249834F};
        return r + r * r * polynomial(r, c);
    } else {
        // 1/(k+2)!: the series; its first omitted term is below 2e-19
        constexpr double c[] = {1. / 2,         1. / 6,           1. / 24,          1. / 120,     1. / 720,
                                1. / 5040,      1. / 40320,       1. / 362880,      1. / 3628800, 1. / 39916800,
                                1. / 479001600, 1. / 6227020800., 1. / 87178291200.};
        return r + r * r * polynomial(r, c);
    }
}

/// x = 2^exponent mantissa with the mantissa in [2/3, 4/3); x normal and > 0.
template <real_number Real>
struct split_number {
    Real exponent;
    Real mantissa;
};

template <real_number Real>
MICA_HOST_DEVICE constexpr split_number<Real> split(Real x) {
    using Format = format<scalar_of<Real>>;
    using Bits = bits_of<Real>;
    const Bits bits = reinterpret<Bits>(x);
    const auto exponent =
        reinterpret<integer_of<Real>>(bits - Bits(Format::two_thirds)) >> Format::mantissa_bits; // arithmetic shift
    const Bits mantissa = bits - (reinterpret<Bits>(exponent) << Format::mantissa_bits);
    return {convert<Real>(exponent), reinterpret<Real>(mantissa)};
}

/// exponent ln2 + log(1 + f) for f in [-1/2, 1/3].
template <real_number Real>
MICA_HOST_DEVICE constexpr Real log_of_split(Real exponent, Real f) {
    using Format = format<scalar_of<Real>>;
    const Real fraction = twice_atanh(f / (Real(2) + f));
    return exponent * Real(Format::ln2_high) + (exponent * Real(Format::ln2_low) + fraction);
}

/// 2^k and k for the integer k nearest to x, which must be the exponent of a normal number.
template <real_number Real>
struct nearest_power {
    Real power;
    Real exponent;
};

template <real_number Real>
MICA_HOST_DEVICE constexpr nearest_power<Real> power_near(Real x) {
    using Format = format<scalar_of<Real>>;
    using Scalar = scalar_of<Real>;
    // With the bias added it is positive, where truncation rounds down, and already the exponent as the format has it.
    // It is taken off as an integer: of floats, -ffast-math would spread the difference over what follows.
    using Integer = integer_of<Real>;
    const Integer biased = convert<Integer>(x + Real(Scalar(Format::bias) + Scalar(0.5)));
    return {reinterpret<Real>(biased << Format::mantissa_bits), convert<Real>(biased - Integer(Format::bias))};
}

/// y = k ln2 + r, |r| <= ln2/2 but for a rounding, as 2^k and r. Below the smallest normal exponential 2^k is 0, above the largest it is
/// that of the largest.
template <real_number Real>
struct reduced_exponent {
    Real power;
    Real remainder;
};

template <real_number Real>
MICA_HOST_DEVICE constexpr reduced_exponent<Real> reduce_exponent(Real y) {
    using Format = format<scalar_of<Real>>;
    constexpr scalar_of<Real> log2_e = scalar_of<Real>(1.4426950408889634);
    const auto underflows = y < Real(Format::smallest_exponential);
    const Real limited = clamp(y, Real(Format::smallest_exponential), Real(Format::largest_exponential));
    const auto [power, k] = power_near(limited * Real(log2_e));
    const Real remainder = (limited - k * Real(Format::ln2_high)) - k * Real(Format::ln2_low);
    return {select(underflows, Real(0), power), remainder};
}

} // namespace detail

/// floor(log2 |x|) of a normal x. 0 and subnormal numbers give -127 (-1023), infinity and NaN 128 (1024), also under
/// -ffast-math.
template <real_number Real>
MICA_HOST_DEVICE constexpr integer_of<Real> binary_exponent(Real x) {
    using Format = detail::format<scalar_of<Real>>;
    using Integer = integer_of<Real>;
    return reinterpret<Integer>((reinterpret<bits_of<Real>>(x) << 1) >> (Format::mantissa_bits + 1)) -
           Integer(Format::bias);
}

/// 2^k; k in [-126, 127] ([-1022, 1023]).
template <real_number Real>
MICA_HOST_DEVICE constexpr Real power_of_two(integer_of<Real> k) {
    using Format = detail::format<scalar_of<Real>>;
    return reinterpret<Real>((k + integer_of<Real>(Format::bias)) << Format::mantissa_bits);
}

/// Natural logarithm. x normal and > 0; 0 gives about -88 (-709), a finite stand-in for -infinity.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real log(Real x) {
    const auto parts = detail::split(x);
    return detail::log_of_split(parts.exponent, parts.mantissa - Real(1));
}

/// Binary logarithm; exact at powers of two. x normal and > 0; 0 gives about -127 (-1023).
template <real_number Real>
MICA_HOST_DEVICE constexpr Real log2(Real x) {
    constexpr auto log2_e = scalar_of<Real>(1.4426950408889634);
    const auto parts = detail::split(x);
    const Real f = parts.mantissa - Real(1);
    return parts.exponent + detail::twice_atanh(f / (Real(2) + f)) * Real(log2_e);
}

/// log(1 - p) for p in [0, 1/2], with relative accuracy down to the smallest p: the series takes p as it is.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real log_complement(Real p) {
    return detail::twice_atanh(-p / (Real(2) - p));
}

/// log(1 - p) for p in [0, 1), with relative accuracy down to the smallest p. p = 1 gives log(0).
///
/// For p <= 1/2 the argument of the series is p itself, no range reduction; beyond, 1 - p is exact.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real log1p_neg(Real p) {
    const auto parts = detail::split(Real(1) - p);
    const auto direct = p <= Real(0.5);
    return detail::log_of_split(select(direct, Real(0), parts.exponent), select(direct, -p, parts.mantissa - Real(1)));
}

/// e^y. Below the smallest normal number (y < -87.3, double -708.4) exactly 0; above the range the value at its end.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real exp(Real y) {
    const auto parts = detail::reduce_exponent(y);
    return parts.power + parts.power * detail::expm1_reduced(parts.remainder);
}

/// 2^x; exact at integers. x in [-126, 127] ([-1022, 1023]); below exactly 0, above 2^127 (2^1023).
template <real_number Real>
MICA_HOST_DEVICE constexpr Real exp2(Real x) {
    using Format = detail::format<scalar_of<Real>>;
    constexpr auto ln2 = scalar_of<Real>(0.6931471805599453);
    constexpr auto largest = scalar_of<Real>(Format::bias);
    const Real limited = clamp(x, Real(1 - largest), Real(largest));
    const auto [power, k] = detail::power_near(limited);
    const Real rest = detail::expm1_reduced((limited - k) * Real(ln2));
    return select(x < Real(1 - largest), Real(0), power + power * rest);
}

/// e^y - 1, with relative accuracy at small y. The small argument takes the polynomial itself: written as
/// s poly + (s - 1), -ffast-math would fold it into exp(y) - 1, and rare events would be lost.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real expm1(Real y) {
    const auto parts = detail::reduce_exponent(y);
    const Real rest = detail::expm1_reduced(parts.remainder);
    const auto small = abs(y) < Real(0.34375); // k = 0 and the remainder is y
    return select(small, rest, parts.power + parts.power * rest - Real(1));
}

namespace detail {

/// 1 / sqrt(x) by so many Newton steps on an integer estimate: relative error 1.8e-3, 4.7e-6, 3e-11, ...
template <int Steps, real_number Real>
MICA_HOST_DEVICE constexpr Real inverse_sqrt_in(Real x) {
    using Format = format<scalar_of<Real>>;
    using Bits = bits_of<Real>;
    const Real half = x * Real(0.5);
    Real inverse = reinterpret<Real>(Bits(Format::inverse_sqrt_magic) - (reinterpret<Bits>(x) >> 1));
    MICA_UNROLL
    for (int step = 0; step < Steps; ++step) inverse = inverse * (Real(1.5) - half * inverse * inverse);
    return inverse;
}

} // namespace detail

/// 1 / sqrt(x) for finite normal x > 0.
///
/// Newton steps on an integer estimate, in the scalar path too: the hardware's estimates differ between vendors, and its
/// exact square root is not reachable from a pack without compiler flags.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real inverse_sqrt(Real x) {
    return detail::inverse_sqrt_in<detail::format<scalar_of<Real>>::inverse_sqrt_steps>(x);
}

/// Square root of a finite x; 0 where x <= 0 or subnormal.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real sqrt(Real x) {
    const Real inverse = inverse_sqrt(x);
    const Real root = x * inverse;
    const Real corrected = root + Real(0.5) * inverse * (x - root * root);
    return select(x >= Real((std::numeric_limits<scalar_of<Real>>::min)()), corrected, Real(0));
}

} // namespace mica
