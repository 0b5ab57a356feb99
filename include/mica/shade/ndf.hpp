// mica/shade/ndf.hpp: distributions of facet normals, with two roughnesses.
//
// h is in the surface's frame: tangent, bitangent, normal. In slopes (X, Y) = (h.x / h.z / alpha_x, h.y / h.z / alpha_y) both
// distributions are those of one round lobe, of q = X^2 + Y^2, and the facet area in a solid angle is
//
//     integral of P(q) w dX dY,   w = 1 / h.z = sqrt(1 + T),   T = (alpha_x X)^2 + (alpha_y Y)^2 = a^2 q
//
// with P(q) = 1 / (pi (1+q)^2) for GGX and exp(-q) / pi for Beckmann. Along a ray from the origin a is constant, so the area
// inside a contour is the integral of F(q) d psi / (2 pi) over its azimuth psi, with F(q) = integral from 0 to q of pi P w.
// F is in closed form; contour_area.hpp integrates it. Derived for mica; at a contour around everything it
// is D_H of KK25 Sec. 3.2.
#pragma once

#include "../numeric/angle.hpp"
#include "vector.hpp"

namespace mica {

/// Roughness below this counts as it where a density is evaluated; at 0 the surface is a mirror and has none.
inline constexpr float smallest_roughness = 1e-4F;

namespace detail {

/// atanh(x) / x, x in [0, 1). Relative error 1e-6.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real atanh_over(Real x) {
    const Real s = x * x;
    const auto near_zero = x < Real(0.1F);
    const Real y = select(near_zero, Real(0.1F), x);
    return select(near_zero, Real(1) + s * (Real(1.F / 3) + s * (Real(0.2F) + s * Real(1.F / 7))),
                  mica::log((Real(1) + y) / (Real(1) - y)) / (y + y));
}

/// sqrt(pi) x exp(x^2) erfc(x), y = 1 / x^2 in [0, 1]. Relative error 1.2e-5 (tools/fit_polynomials).
template <real_number Real>
MICA_HOST_DEVICE constexpr Real scaled_tail(Real y) {
    using Scalar = scalar_of<Real>;
    constexpr Scalar c[] = {Scalar(0.9999881873), Scalar(-0.4980598158), Scalar(0.6954659697), Scalar(-1.222852339),
                            Scalar(1.802295539),  Scalar(-1.78039341),   Scalar(0.999300301),  Scalar(-0.2378812292)};
    return polynomial(y, c);
}

/// What both distributions share. Shape gives for a squared roughness a2 = a^2, q and w: area(a2) = F(infinity),
/// within_over_square(a2, q, w) = F(q) / q, beyond(a2, q, w) = F(infinity) - F(q), density(q) = pi P(q), and Smith's Lambda of
/// the squared slope t of a direction whose facets have roughness 1.
template <class Shape, real_number Real>
struct stretched_distribution {
    Real roughness_x, roughness_y; ///< alpha along tangent and bitangent, in [0, 1]

    /// Facet area per surface area and solid angle of h; 0 below the surface.
    MICA_HOST_DEVICE constexpr Real density(vector3<Real> h) const { return density_at_normal() * relative_density(h); }

    /// D(n) = 1 / (pi alpha_x alpha_y).
    MICA_HOST_DEVICE constexpr Real density_at_normal() const {
        return Real(0.318309886F) / (limited(roughness_x) * limited(roughness_y));
    }

    /// D(h) / D(n); above 1 for Beckmann's at roughness near 1.
    MICA_HOST_DEVICE constexpr Real relative_density(vector3<Real> h) const {
        const auto above = h.z > Real(0);
        const Real z = select(above, h.z, Real(1));
        const Real x = h.x / (z * limited(roughness_x)), y = h.y / (z * limited(roughness_y));
        const Real fourth = (z * z) * (z * z);
        const auto counted = above && (fourth > Real(0)); // else, at the very horizon, 0 over 0
        return select(counted, Shape::density(x * x + y * y) / select(counted, fourth, Real(1)), Real(0));
    }

    /// D_H: facet area per surface area, the integral of D over the hemisphere; from 1 (mirror) to 2 (GGX at 1). With two
    /// roughnesses the mean over the azimuth of that of a(psi), by the midpoint rule. Relative error 2e-4 (tests/lights_test.cpp).
    MICA_HOST_DEVICE constexpr Real facet_area() const {
        const Real x = limited(roughness_x), y = limited(roughness_y);
        if (all(abs(x - y) <= Real(0))) return Shape::area(x * x);
        constexpr int nodes = 16; // of a quarter turn: the others mirror it
        Real sum = Real(0);
        for (int i = 0; i < nodes; ++i) {
            const Real turn = Real((static_cast<float>(i) + 0.5F) / (2 * nodes));
            const auto [sine, cosine] = half_turns(turn);
            sum = sum + Shape::area(x * x * (cosine * cosine) + y * y * (sine * sine));
        }
        return sum * Real(1.F / nodes);
    }

    /// Smith's masking and shadowing, height-correlated (Heitz 2014, Eq. 99), in [0, 1]; 0 below the surface.
    MICA_HOST_DEVICE constexpr Real masking_shadowing(vector3<Real> wi, vector3<Real> wo) const {
        const auto above = (wi.z > Real(0)) && (wo.z > Real(0));
        return select(above, Real(1) / (Real(1) + lambda(wi) + lambda(wo)), Real(0));
    }

    /// Smith's Lambda, the masked over the visible facet area; w above the surface.
    MICA_HOST_DEVICE constexpr Real lambda(vector3<Real> w) const {
        const Real x = w.x * limited(roughness_x), y = w.y * limited(roughness_y);
        const Real z = maximum(w.z, Real(1e-6F));
        return Shape::lambda((x * x + y * y) / (z * z));
    }

    MICA_HOST_DEVICE static constexpr Real limited(Real roughness) {
        return clamp(roughness, Real(smallest_roughness), Real(1));
    }
};

struct ggx_shape {
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real density(Real q) {
        return Real(1) / ((Real(1) + q) * (Real(1) + q));
    }
    /// 1 + a^2 atanh(b) / b, b^2 = 1 - a^2: twice the logarithm of (1 + b) / a is that of (1 + b) / (1 - b).
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real area(Real a2) {
        const Real b2 = maximum(Real(1) - a2, Real(0)), b = mica::sqrt(b2);
        const auto rough = b < Real(0.1F);
        const Real c = select(rough, Real(0.5F), b);
        const Real ratio = select(rough, Real(1) + b2 * (Real(1.F / 3) + b2 * Real(0.2F)),
                                  (mica::log(Real(1) + c) - Real(0.5F) * mica::log(a2)) / c);
        return Real(1) + a2 * ratio;
    }
    /// F(q) = q (1 - a^2 / (1+w)) / (1+q) + a^2 atanh(b u) / b,  u = q / (q+w+1).
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real within_over_square(Real a2, Real q, Real w) {
        const Real b = mica::sqrt(maximum(Real(1) - a2, Real(0)));
        const Real inverse = Real(1) / (q + w + Real(1));
        return (Real(1) - a2 / (Real(1) + w)) / (Real(1) + q) + a2 * inverse * atanh_over(b * q * inverse);
    }
    /// (1 + q a^2 / (1+w)) / (1+q) + a^2 atanh(b / w) / b.
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real beyond(Real a2, Real q, Real w) {
        const Real b = mica::sqrt(maximum(Real(1) - a2, Real(0)));
        return (Real(1) + q * a2 / (Real(1) + w)) / (Real(1) + q) +
               a2 / w * atanh_over(minimum(b / w, Real(1 - 6e-8F)));
    }
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real lambda(Real t) {
        return Real(0.5F) * (mica::sqrt(Real(1) + t) - Real(1));
    }
};

struct beckmann_shape {
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real density(Real q) {
        return mica::exp(-q);
    }
    /// 1 + (a^2 / 2) K(a^2), K that of scaled_tail.
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real area(Real a2) {
        return Real(1) + Real(0.5F) * a2 * scaled_tail(a2);
    }
    /// (F(infinity) - beyond) / q, and where they cancel 1 + q (a^2 - 2) / 4.
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real within_over_square(Real a2, Real q, Real w) {
        const auto near_zero = q < Real(2e-3F);
        const Real divisor = select(near_zero, Real(1), q);
        return select(near_zero, Real(1) + Real(0.25F) * q * (a2 - Real(2)), (area(a2) - beyond(a2, q, w)) / divisor);
    }
    /// exp(-q) (w + a^2 / (2 w) K(a^2 / w^2)).
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real beyond(Real a2, Real q, Real w) {
        const Real inverse = Real(1) / w;
        return mica::exp(-q) * (w + Real(0.5F) * a2 * inverse * scaled_tail(a2 * inverse * inverse));
    }
    /// The rational fit of Walter et al. 2007, Sec. 5.2, relative error of the masking 0.35 %.
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real lambda(Real t) {
        const Real c = Real(1) / mica::sqrt(maximum(t, Real(1e-12F)));
        const Real fit =
            (Real(1) - Real(1.259F) * c + Real(0.396F) * c * c) / (Real(3.535F) * c + Real(2.181F) * c * c);
        return select(c < Real(1.6F), maximum(fit, Real(0)), Real(0)); // the fit is -6e-5 between 1.55 and 1.6
    }
};

} // namespace detail

/// GGX (Walter et al. 2007, Eq. 33; Burley 2012 with two roughnesses): P(q) = 1 / (pi (1+q)^2).
///
/// ggx<Real>{roughness_x, roughness_y}, alpha along tangent and bitangent, in [0, 1]. Of directions in the surface's frame:
/// density(h), its value density_at_normal() at the normal, relative_density(h) = D(h) / D(n); facet_area() is D_H;
/// masking_shadowing(wi, wo) and lambda(w) are Smith's.
template <real_number Real>
struct ggx : detail::stretched_distribution<detail::ggx_shape, Real> {
    /// What the lights integrate.
    using shape = detail::ggx_shape;
};

/// Beckmann (Walter et al. 2007, Eq. 25): P(q) = exp(-q) / pi. Members as for ggx.
template <real_number Real>
struct beckmann : detail::stretched_distribution<detail::beckmann_shape, Real> {
    /// What the lights integrate.
    using shape = detail::beckmann_shape;
};

} // namespace mica
