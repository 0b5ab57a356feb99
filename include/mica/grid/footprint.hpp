// mica/grid/footprint.hpp: the ellipse that a pixel covers in texture space.
//
//     M = (duv/dx  duv/dy),  the ellipse is M times the unit disc,  area |det M|
//     sigma_max^2 = T/2 + sqrt(((a-d)/2)^2 + b^2),  sigma_min = |det M| / sigma_max
//
// with a, b, d the entries of M M^T and T = a + d. Source: DB23 Sec. 5.1, and the EWA tradition before it. The textbook
// sigma_min^2 = T/2 - sqrt(...) is off by 3.5 % at ratio 4e3 in binary32 and negative in 97 % of cases at 1e5; the
// quotient, with the determinant's cancellation compensated, is good to 1e-6 at ratio 1e5 (tests/footprint_test.cpp;
// -ffast-math may undo the compensation).
#pragma once

#include "../numeric/angle.hpp"

namespace mica {

/// Derivatives of the texture coordinates by the pixel coordinates, in uv per pixel.
template <real_number Real>
struct uv_derivatives {
    Real du_dx, dv_dx; ///< by the next pixel of the row
    Real du_dy, dv_dy; ///< by the next row
};

/// A pixel's ellipse in texture space.
template <real_number Real>
struct footprint {
    Real area;        ///< |det M|, in uv^2; what the pixel covers, whatever the ellipse is used for
    Real sigma_max;   ///< major semi-axis, in uv
    Real sigma_min;   ///< minor semi-axis, in uv, at least sigma_max / largest_footprint_ratio
    Real ratio;       ///< sigma_max / sigma_min, in [1, largest_footprint_ratio]
    Real orientation; ///< of the major axis, in half turns from +v towards -u, in [0, 1)
};

/// Beyond this ratio a footprint counts as having it; a rank-one footprint does.
inline constexpr float largest_footprint_ratio = 0x1p20F;

namespace detail {

/// a b - c d without cancellation: the upper halves of the factors have exact products, of which the large part of the
/// difference is made.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real difference_of_products(Real a, Real b, Real c, Real d) {
    using Bits = bits_of<Real>;
    constexpr int lower_half = (format<scalar_of<Real>>::mantissa_bits + 2) / 2; // of 24 bits 12, of 53 bits 27
    const auto upper = [](Real x) { return reinterpret<Real>((reinterpret<Bits>(x) >> lower_half) << lower_half); };
    const Real a1 = upper(a), b1 = upper(b), c1 = upper(c), d1 = upper(d);
    const Real a0 = a - a1, b0 = b - b1, c0 = c - c1, d0 = d - d1;
    return (a1 * b1 - c1 * d1) + ((a1 * b0 - c1 * d0) + (a0 * b - c0 * d));
}

} // namespace detail

/// The footprint of a pixel.
///
/// Total: a non-finite M, or one whose entries are all below the smallest normal number, gives all zeros with ratio 1, a
/// footprint that covers nothing; rank one gives area 0 and the largest ratio; an area beyond the range of Real is 0 or
/// the largest finite Real.
template <real_number Real>
MICA_HOST_DEVICE constexpr footprint<Real> make_footprint(const uv_derivatives<Real>& m) {
    using Scalar = scalar_of<Real>;
    using Integer = integer_of<Real>;
    using Format = detail::format<Scalar>;
    const Real size =
        maximum(maximum(mica::abs(m.du_dx), mica::abs(m.dv_dx)), maximum(mica::abs(m.du_dy), mica::abs(m.dv_dy)));
    const auto undefined = is_nan(m.du_dx) || is_nan(m.dv_dx) || is_nan(m.du_dy) || is_nan(m.dv_dy);
    const Integer size_exponent = binary_exponent(size);
    const auto covers =
        !undefined && size_exponent > Integer(-Format::bias) && size_exponent < Integer(Format::bias) + Integer(1);

    // By a power of two, so that a rescaled footprint has the same digits. Its inverse is a normal number, too.
    const Integer exponent = select(covers, minimum(size_exponent, Integer(Format::bias - 1)), Integer(0));
    const Real down = power_of_two<Real>(-exponent), up = power_of_two<Real>(exponent);
    const auto scaled = [&](Real x) { return select(covers, x, Real(0)) * down; };
    const Real ux = scaled(m.du_dx), vx = scaled(m.dv_dx);
    const Real uy = scaled(m.du_dy), vy = scaled(m.dv_dy);

    const Real a = ux * ux + uy * uy;
    const Real d = vx * vx + vy * vy;
    const Real b = ux * vx + uy * vy;
    const Real half_difference = (a - d) * Real(0.5);
    const Real root = mica::sqrt(half_difference * half_difference + b * b);
    const Real sigma_max = select(covers, mica::sqrt((a + d) * Real(0.5) + root), Real(1));
    const Real determinant = mica::abs(detail::difference_of_products(ux, vy, uy, vx));
    const Real sigma_min = clamp(determinant / sigma_max, sigma_max * Real(1 / largest_footprint_ratio), sigma_max);

    // The axis is at half the angle of (a - d, 2 b), which needs no case for b = 0; from +v it is a quarter turn less.
    // Orientation 1 (180 degrees) is orientation 0.
    const Real from_v = angle_in_turns(b, half_difference) - Real(0.5);
    const Real positive = select(from_v < Real(0), from_v + Real(1), from_v);
    const Real orientation = select(positive < Real(1), positive, Real(0));

    constexpr Scalar largest = (std::numeric_limits<Scalar>::max)();
    const auto or_nothing = [&](Real x) { return select(covers, detail::limited_from_0(x, largest), Real(0)); };
    return {or_nothing(determinant * up * up), or_nothing(sigma_max * up), or_nothing(sigma_min * up),
            select(covers, maximum(Real(1), sigma_max / sigma_min), Real(1)), select(covers, orientation, Real(0))};
}

} // namespace mica
