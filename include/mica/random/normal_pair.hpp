// mica/random/normal_pair.hpp: from random bits to normal variates, two at a time.
#pragma once

#include "../numeric/angle.hpp"
#include "hash.hpp"
#include "uniform.hpp"

namespace mica {

/// Two independent standard normal variates.
template <real_number Real>
struct normal_pair {
    Real first, second; ///< the two
};

namespace detail {

/// -ln u for normal u in (0, 1], relative error 2e-6: half the cost of log(), which divides.
template <real_number Real>
    requires(std::same_as<scalar_of<Real>, float>)
MICA_HOST_DEVICE constexpr Real minus_log(Real u) {
    constexpr float c[] = {-0.9999998559F, 0.5000224248F, -0.3333766965F, 0.2484165793F,
                           -0.1980269367F, 0.1940769021F, -0.1706524775F};
    const auto [exponent, mantissa] = split(u);
    const Real f = mantissa - Real(1);
    return exponent * Real(-0.6931471806F) + f * polynomial(f, c);
}

} // namespace detail

/// Two independent standard normal variates from 32 random bits (Box & Muller 1958): sqrt(-2 ln u) at an angle.
///
/// u has the upper 31 bits, so a variate reaches 6.6 standard deviations. The angle is a multiple of the same bits by the
/// golden ratio: the points (u, angle) form a lattice of 2^32 points in the square, as even as 32 bits can be; its coarsest
/// lines are 2^-16 apart, and the k smallest u have the first k angles of a golden-section sequence. The angle's first two
/// bits are the signs, the others its place within the quadrant. Relative error 1e-5 (float). double has 20 more bits for u,
/// hashed from these.
template <real_number Real>
MICA_HOST_DEVICE constexpr normal_pair<Real> normal_pair_from_bits(index_of<Real> bits) {
    using Scalar = scalar_of<Real>;
    using Index = index_of<Real>;
    const Index angle = bits * Index(golden_increment);
    const Index within = angle & Index(0x3fffffffU);
    if constexpr (sizeof(Scalar) == 4) {
        const Real whole = convert<Real>(reinterpret<integer_of<Real>>(bits >> 1));
        const Real w = detail::minus_log(whole * Real(0x1p-31F) + Real(0x1p-32F));
        const Real radius = w * detail::inverse_sqrt_in<2>(w); // cos + sin has the sqrt 2
        const Real place = convert<Real>(reinterpret<integer_of<Real>>(within));
        const auto [sine, cosine] = detail::eighth_turn(place * Real(0x1p-30F) - Real(0.5));
        const auto signed_by = [](Real x, Index sign) {
            return reinterpret<Real>(reinterpret<Index>(x) ^ (sign & Index(0x80000000U)));
        };
        return {signed_by(radius * (cosine - sine), angle), signed_by(radius * (cosine + sine), angle << 1)};
    } else {
        const Real radius = mica::sqrt(-mica::log(uniform_from_bits<Real>(bits, mix(bits + Index(golden_increment)))));
        const auto [sine, cosine] = detail::eighth_turn(convert<Real>(within) * Real(0x1p-30) - Real(0.5));
        const auto sign = [](Index bit) { return Real(1) - Real(2) * convert<Real>(bit >> 31); };
        return {sign(angle) * radius * (cosine - sine), sign(angle << 1) * radius * (cosine + sine)};
    }
}

} // namespace mica
