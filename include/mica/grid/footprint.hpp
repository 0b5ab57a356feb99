// mica/grid/footprint.hpp: the ellipse that a pixel covers in texture space.
//
//     M = (duv/dx  duv/dy),  the ellipse is M times the unit disc,  area |det M|
//     sigma_max^2 = T/2 + sqrt(((a-d)/2)^2 + b^2),  sigma_min = |det M| / sigma_max
//
// with a, b, d the entries of M M^T and T = a + d. Source: DB23 Sec. 5.1, and the EWA tradition before it. The textbook
// sigma_min^2 = T/2 - sqrt(...) is off by 3.5 % at ratio 4e3 in binary32 and negative in 97 % of cases at 1e5; the
// quotient, with the determinant's cancellation compensated, is good to 1e-6 at ratio 1e5 (tests/footprint_test.cpp).
#pragma once

#include <cmath>

#include "../numeric/number.hpp"

namespace mica {

/// Derivatives of the texture coordinates by the pixel coordinates, in uv per pixel.
template <scalar_number Real>
struct uv_derivatives {
    Real du_dx, dv_dx;
    Real du_dy, dv_dy;
};

/// A pixel's ellipse in texture space.
template <scalar_number Real>
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

/// a b - c d without cancellation, to 2 ulp (Kahan; Jeannerod, Louvet & Muller 2013).
template <scalar_number Real>
MICA_HOST_DEVICE inline Real difference_of_products(Real a, Real b, Real c, Real d) {
    const Real cd = c * d;
    const Real error = std::fma(-c, d, cd);
    return std::fma(a, b, -cd) + error;
}

} // namespace detail

/// The footprint of a pixel.
///
/// Total: a zero or non-finite M gives all zeros with ratio 1, a footprint that covers nothing; rank one gives area 0
/// and the largest ratio; magnitudes from 1e-30 to 1e30 are scaled before they are squared (an area beyond the range
/// of Real is 0 or the largest finite Real).
template <scalar_number Real>
MICA_HOST_DEVICE footprint<Real> make_footprint(const uv_derivatives<Real>& m) {
    const Real size =
        maximum(maximum(mica::abs(m.du_dx), mica::abs(m.dv_dx)), maximum(mica::abs(m.du_dy), mica::abs(m.dv_dy)));
    const bool undefined = is_nan(m.du_dx) || is_nan(m.dv_dx) || is_nan(m.du_dy) || is_nan(m.dv_dy);
    if (undefined || !(size > Real(0)) || size > std::numeric_limits<Real>::max()) return {0, 0, 0, 1, 0};

    // A power of two, so that a rescaled footprint has the same digits; two steps keep 1/scale finite.
    const int exponent = std::ilogb(size);
    const auto scaled = [exponent](Real x) { return std::scalbn(x, -exponent); };
    const Real ux = scaled(m.du_dx), vx = scaled(m.dv_dx);
    const Real uy = scaled(m.du_dy), vy = scaled(m.dv_dy);

    const Real a = ux * ux + uy * uy;
    const Real d = vx * vx + vy * vy;
    const Real b = ux * vx + uy * vy;
    const Real half_difference = (a - d) / 2;
    const Real root = std::sqrt(half_difference * half_difference + b * b);
    const Real sigma_max = std::sqrt((a + d) / 2 + root);
    const Real determinant = mica::abs(detail::difference_of_products(ux, vy, uy, vx));
    const Real sigma_min = clamp(determinant / sigma_max, sigma_max / Real(largest_footprint_ratio), sigma_max);

    // Direction of the major axis from +u: atan2(2b, a-d) / 2, which needs no case for b = 0; from +v a quarter turn
    // less. Orientation 1 (180 degrees) is orientation 0.
    constexpr Real pi = Real(3.14159265358979323846);
    Real orientation = std::atan2(b, half_difference) / (2 * pi) - Real(0.5);
    if (orientation < 0) orientation += 1;
    if (!(orientation < 1)) orientation = 0;

    const auto unscaled = [exponent](Real x) {
        return minimum(std::scalbn(x, exponent), std::numeric_limits<Real>::max());
    };
    const Real area =
        minimum(std::scalbn(std::scalbn(determinant, exponent), exponent), std::numeric_limits<Real>::max());
    return {area, unscaled(sigma_max), unscaled(sigma_min), maximum(Real(1), sigma_max / sigma_min), orientation};
}

} // namespace mica
