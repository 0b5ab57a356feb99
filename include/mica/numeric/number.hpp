// mica/numeric/number.hpp: the small vocabulary in which every law is written.
//
// A law does not know whether its number is a float, a double or a pack of them. It asks number_traits for the types
// that go with it and uses the free functions below (and the ordinary operators); a comparison gives a mask, and
// select() takes the place of the branch. numeric/pack.hpp says the same words for packs.
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "../config.hpp"

namespace mica {

/// The types that go with a number type: its `scalar`, integers of the same size and lane count (`integer` signed,
/// `bits` unsigned), a 32-bit `index` of the same lane count, and the `mask` that its comparisons give.
template <class Number>
struct number_traits {};

template <>
struct number_traits<float> {
    using scalar = float;
    using integer = std::int32_t;
    using bits = std::uint32_t;
    using index = std::uint32_t;
    using mask = bool;
    static constexpr int lanes = 1;
};

template <>
struct number_traits<double> {
    using scalar = double;
    using integer = std::int64_t;
    using bits = std::uint64_t;
    using index = std::uint32_t;
    using mask = bool;
    static constexpr int lanes = 1;
};

/// The plain number: float or double.
template <class Number>
using scalar_of = typename number_traits<Number>::scalar;
/// A signed integer of the same size and lane count.
template <class Number>
using integer_of = typename number_traits<Number>::integer;
/// An unsigned integer of the same size and lane count.
template <class Number>
using bits_of = typename number_traits<Number>::bits;
/// A 32-bit unsigned integer of the same lane count.
template <class Number>
using index_of = typename number_traits<Number>::index;
/// What a comparison gives: bool, or one truth value for each lane.
template <class Number>
using mask_of = typename number_traits<Number>::mask;
/// How many plain numbers it holds.
template <class Number>
inline constexpr int lanes_of = number_traits<Number>::lanes;

/// A number type that the laws accept: float, double, pack<float, W>, pack<double, W>, or any other for which
/// number_traits and the functions of this header exist.
template <class Number>
concept real_number = std::floating_point<scalar_of<Number>>;

/// One plain number, no lanes.
template <class Number>
concept scalar_number = real_number<Number> && std::same_as<Number, scalar_of<Number>>;

/// A plain number or integer.
template <class Scalar>
concept arithmetic = std::is_arithmetic_v<Scalar>;

/// if_true where the mask holds, if_false elsewhere. Both are evaluated.
template <arithmetic Number>
MICA_HOST_DEVICE constexpr Number select(bool mask, Number if_true, Number if_false) {
    return mask ? if_true : if_false;
}

/// Whether the mask holds in any lane.
MICA_HOST_DEVICE constexpr bool any(bool mask) { return mask; }
/// Whether the mask holds in every lane.
MICA_HOST_DEVICE constexpr bool all(bool mask) { return mask; }

/// Value by value, truncating towards zero. A real must lie within the range of the integer.
template <arithmetic To, arithmetic From>
MICA_HOST_DEVICE constexpr To convert(From value) {
    return static_cast<To>(value);
}

/// The same bits under another type of the same size.
template <arithmetic To, arithmetic From>
    requires(sizeof(To) == sizeof(From))
MICA_HOST_DEVICE constexpr To reinterpret(From value) { return __builtin_bit_cast(To, value); }

/// Lane `i` of a number; a scalar is its own only lane.
template <arithmetic Number>
MICA_HOST_DEVICE constexpr Number lane(Number value, int) {
    return value;
}

/// Sets lane `i`.
template <arithmetic Number>
MICA_HOST_DEVICE constexpr void set_lane(Number& number, int, Number value) {
    number = value;
}

// From here on in terms of the words above, so the same for scalars and packs. Laws call the functions that other
// libraries have under the same names as mica::exp(), mica::sqrt(), ...: theirs give other last bits.

/// The smaller; b where a is NaN.
template <class Number>
MICA_HOST_DEVICE constexpr Number minimum(Number a, std::type_identity_t<Number> b) {
    return select(a < b, a, b);
}

/// The larger; b where a is NaN.
template <class Number>
MICA_HOST_DEVICE constexpr Number maximum(Number a, std::type_identity_t<Number> b) {
    return select(a > b, a, b);
}

/// x limited to [low, high]; low where x is NaN.
template <real_number Number>
MICA_HOST_DEVICE constexpr Number clamp(Number x, std::type_identity_t<Number> low, std::type_identity_t<Number> high) {
    return minimum(maximum(x, low), high);
}

/// |x|
template <real_number Number>
MICA_HOST_DEVICE constexpr Number abs(Number x) {
    return select(x < Number(0), -x, x);
}

namespace detail {

/// From here on every number is an integer.
template <std::floating_point Scalar>
inline constexpr Scalar integers_from = Scalar(1) / std::numeric_limits<Scalar>::epsilon();

/// x without its fraction where it has one, which must be below integers_from.
template <real_number Number>
MICA_HOST_DEVICE constexpr Number without_fraction(Number x, const mask_of<Number>& has_fraction) {
    return select(has_fraction, convert<Number>(convert<integer_of<Number>>(select(has_fraction, x, Number(0)))), x);
}

} // namespace detail

/// The largest integer <= x, for every finite x. Through the integers, not by adding and subtracting a large number,
/// which -ffast-math deletes.
template <real_number Number>
MICA_HOST_DEVICE constexpr Number floor(Number x) {
    const Number truncated = detail::without_fraction(x, abs(x) < Number(detail::integers_from<scalar_of<Number>>));
    return truncated - select(truncated > x, Number(1), Number(0));
}

namespace detail {

/// A number that an integer of its size can hold, as the integer below it and the rest in [0, 1).
template <real_number Number>
struct whole_and_rest {
    integer_of<Number> whole;
    Number rest;
};

template <real_number Number>
MICA_HOST_DEVICE constexpr whole_and_rest<Number> split_at_integer(Number x) {
    using Integer = integer_of<Number>;
    const Integer truncated = convert<Integer>(x);
    const Number rest = x - convert<Number>(truncated);
    const auto below = rest < Number(0);
    return {truncated - select(below, Integer(1), Integer(0)), rest + select(below, Number(1), Number(0))};
}

} // namespace detail

/// The integer part of x >= 0.
template <real_number Number>
MICA_HOST_DEVICE constexpr Number truncate(Number x) {
    return detail::without_fraction(x, x < Number(detail::integers_from<scalar_of<Number>>));
}

/// Whether x is NaN, read off its bits because -ffast-math deletes x != x.
template <real_number Number>
MICA_HOST_DEVICE constexpr mask_of<Number> is_nan(Number x) {
    using Bits = bits_of<Number>;
    constexpr scalar_of<Number> infinity = std::numeric_limits<scalar_of<Number>>::infinity();
    constexpr auto infinity_bits = reinterpret<bits_of<scalar_of<Number>>>(infinity);
    constexpr auto all_but_sign = std::numeric_limits<decltype(infinity_bits)>::max() >> 1;
    return (reinterpret<Bits>(x) & Bits(all_but_sign)) > Bits(infinity_bits);
}

namespace detail {

/// x limited to [0, most], `most` > 0 and finite; NaN gives 0 or most. By its bits, whose order as integers is that of
/// the numbers from 0 on: -ffast-math lets clang drop a comparison that only an infinity fails.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real limited_from_0(Real x, scalar_of<Real> most) {
    using Integer = integer_of<Real>;
    const Integer most_bits = Integer(reinterpret<integer_of<scalar_of<Real>>>(most));
    return reinterpret<Real>(minimum(maximum(reinterpret<Integer>(x), Integer(0)), most_bits));
}

} // namespace detail

} // namespace mica
