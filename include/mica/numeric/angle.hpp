// mica/numeric/angle.hpp: sine, cosine and arctangent of angles counted in turns, for every number type.
//
// Turns instead of radians: a fraction of a turn is exact where a multiple of pi is not, and nothing needs to be reduced.
// For float the polynomials of tools/fit_polynomials; for double the functions of <cmath>, lane by lane.
#pragma once

#include <cmath>

#include "elementary.hpp"

namespace mica {

/// Sine and cosine of one angle.
template <real_number Real>
struct sine_cosine {
    Real sine, cosine; ///< the two
};

namespace detail {

inline constexpr double pi = 3.14159265358979323846;

/// A scalar function in every lane of its arguments.
template <class Function, real_number Real, std::same_as<Real>... More>
MICA_HOST_DEVICE Real each_lane(const Function& function, Real x, More... more) {
    for (int i = 0; i < lanes_of<Real>; ++i) set_lane(x, i, function(lane(x, i), lane(more, i)...));
    return x;
}

/// Sine and cosine of y / 4 turns, |y| <= 1/2: an eighth of a turn to either side. Absolute error 1e-7 (2e-16).
template <real_number Real>
MICA_HOST_DEVICE constexpr sine_cosine<Real> eighth_turn(Real y) {
    using Scalar = scalar_of<Real>;
    if constexpr (sizeof(Scalar) == 4) {
        constexpr float sine[] = {1.570796322F, -0.6459634602F, 0.07968003277F, -0.004601657887F};
        constexpr float cosine[] = {1.F, -1.23370054F, 0.2536691826F, -0.02085993603F, 0.0009033629754F};
        const Real s = y * y;
        return {y * polynomial(s, sine), polynomial(s, cosine)};
    } else {
        return {each_lane([](Scalar t) { return std::sin(Scalar(pi / 2) * t); }, y),
                each_lane([](Scalar t) { return std::cos(Scalar(pi / 2) * t); }, y)};
    }
}

} // namespace detail

/// Sine and cosine of x half turns (pi x radians), x in [0, 1]. Absolute error 3e-7 (double 1e-15).
template <real_number Real>
MICA_HOST_DEVICE constexpr sine_cosine<Real> half_turns(Real x) {
    const auto [sine, cosine] = detail::eighth_turn(x - Real(0.5)); // of half the angle from the quarter turn
    return {cosine * cosine - sine * sine, Real(-2) * sine * cosine};
}

/// The angle of (x, y) from +x towards +y, in turns: atan2(y, x) / (2 pi), in [-1/2, 1/2]; 0 for (0, 0). Absolute error
/// 4e-8 (double 1e-16). Finite arguments; both are 0 if below the smallest normal number.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real angle_in_turns(Real y, Real x) {
    using Scalar = scalar_of<Real>;
    if constexpr (sizeof(Scalar) == 4) {
        constexpr float c[] = {0.1591549407F,   -0.05305123391F, 0.03181924205F,   -0.02260580244F, 0.01693557288F,
                               -0.01194345601F, 0.006794566167F, -0.002557401374F, 0.0004535738788F};
        const Real up = abs(y), right = abs(x);
        const Real longer = maximum(maximum(up, right), Real((std::numeric_limits<Scalar>::min)()));
        const Real slope = minimum(up, right) / longer;
        const Real octant = slope * detail::polynomial(slope * slope, c);
        const Real quadrant = select(up > right, Real(0.25) - octant, octant);
        const Real half = select(x < Real(0), Real(0.5) - quadrant, quadrant);
        return select(y < Real(0), -half, half);
    } else {
        return detail::each_lane([](Scalar b, Scalar a) { return std::atan2(b, a) / Scalar(2 * detail::pi); }, y, x);
    }
}

} // namespace mica
