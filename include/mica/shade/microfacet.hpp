// mica/shade/microfacet.hpp: the microfacet terms, and what glints need beyond them: how much facet area there is, and
// how much of it reflects anything.
//
// Roughness is GGX's alpha in [0, 1]; perceptual roughness is its square root. wo points to the eye, wi to the light,
// both away from the surface; n_dot_v = n.wo.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "ndf.hpp"

namespace mica {

/// GGX normal distribution, facet area per surface area and solid angle of h (Walter et al. 2007, Eq. 33); its
/// integral times n.h is 1. n_dot_h in [0, 1].
template <scalar_number Real>
MICA_HOST_DEVICE Real ggx_distribution(Real n_dot_h, Real roughness) {
    constexpr Real one_over_pi = Real(0.31830988618379067154);
    const Real alpha = maximum(roughness, Real(smallest_roughness));
    const Real sine_square = maximum(Real(0), 1 - n_dot_h * n_dot_h);
    // cos^2 (alpha^2 - 1) + 1, written without the cancellation at cos = 1
    const Real denominator = sine_square + alpha * alpha * n_dot_h * n_dot_h;
    return one_over_pi * alpha * alpha / (denominator * denominator);
}

/// Smith masking-shadowing of GGX, height-correlated (Heitz 2014, Eq. 99), in [0, 1].
template <scalar_number Real>
MICA_HOST_DEVICE Real ggx_masking_shadowing(Real n_dot_l, Real n_dot_v, Real roughness) {
    if (!(n_dot_l > 0 && n_dot_v > 0)) return 0;
    const Real a2 = roughness * roughness;
    const Real view = n_dot_l * std::sqrt(a2 + (1 - a2) * n_dot_v * n_dot_v);
    const Real light = n_dot_v * std::sqrt(a2 + (1 - a2) * n_dot_l * n_dot_l);
    return 2 * n_dot_l * n_dot_v / (view + light);
}

/// Smith masking of GGX for one direction, in [0, 1].
template <scalar_number Real>
MICA_HOST_DEVICE Real ggx_masking(Real n_dot_v, Real roughness) {
    if (!(n_dot_v > 0)) return 0;
    const Real a2 = roughness * roughness;
    return 2 * n_dot_v / (n_dot_v + std::sqrt(a2 + (1 - a2) * n_dot_v * n_dot_v));
}

/// Schlick's Fresnel reflectance; f0 at normal incidence.
template <scalar_number Real>
MICA_HOST_DEVICE Real schlick_fresnel(Real f0, Real wi_dot_h) {
    const Real m = 1 - clamp(wi_dot_h, Real(0), Real(1));
    const Real m2 = m * m;
    return f0 + (1 - f0) * m2 * m2 * m;
}

namespace detail {

/// Facet area of GGX with normals within arccos(cosine) of n, per surface area:
/// the integral of 2 pi D over cosines from `cosine` to 1, b^2 = 1 - alpha^2:
/// alpha^2 [c / (1 - b^2 c^2) + atanh(b c) / b], c from `cosine` to 1.
template <scalar_number Real>
MICA_HOST_DEVICE Real facet_area_within(Real cosine, Real alpha) {
    const Real a2 = alpha * alpha;
    const Real b = std::sqrt(maximum(Real(0), 1 - a2));
    const auto antiderivative = [a2, b](Real c) {
        const Real bc = b * c;
        // atanh(x)/x near 0 is 1 + x^2/3; 1 - b^2 c^2 = 1 - c^2 + alpha^2 c^2
        const Real ratio =
            bc > Real(1e-3) ? std::atanh(minimum(bc, 1 - std::numeric_limits<Real>::epsilon())) / bc : 1 + bc * bc / 3;
        return a2 * c * (1 / (1 - c * c + a2 * c * c) + ratio);
    };
    return antiderivative(Real(1)) - antiderivative(cosine);
}

} // namespace detail

/// D_H: total facet area of GGX per surface area, the integral of D over the hemisphere (KK25 Sec. 3.2):
/// 1 + alpha^2 ln((1 + sqrt(1-alpha^2)) / alpha) / sqrt(1-alpha^2), from 1 (mirror) to 2 (alpha = 1). Relative error
/// 2e-6 in float.
template <scalar_number Real>
MICA_HOST_DEVICE Real total_facet_area(Real roughness) {
    const Real alpha = clamp(roughness, Real(smallest_roughness), Real(1));
    const Real b2 = 1 - alpha * alpha;
    const Real b = std::sqrt(b2);
    const Real log_ratio = b > Real(0.03) ? std::log((1 + b) / alpha) / b : 1 + b2 / 3 + b2 * b2 / 5;
    return 1 + alpha * alpha * log_ratio;
}

/// E_D: facet area per surface area that reflects the eye's ray to above the horizon (KK25 Eq. 21), by quadrature.
///
/// A facet at angle theta from n does so for the azimuths with cos(phi) > -cot(2 theta) cot(theta_v): for all of them
/// while theta < 45 deg - theta_v / 2, for none beyond 45 deg + theta_v / 2, so
///
///     E_D = F(45 - theta_v/2) + integral from 45 - theta_v/2 to 45 + theta_v/2 of
///                               D(theta) sin(theta) 2 arccos(-cot(2 theta) cot(theta_v)) d theta
///
/// with F the facet area within an angle, in closed form. The integral is taken over s, s^2 = alpha^2 / (alpha^2 +
/// tan^2 theta) (the probability D n.h leaves beyond theta), by the midpoint rule in the angle of a Chebyshev
/// substitution, which removes the square-root ends of arccos. Absolute error 3e-5 in double. In (0, D_H]; the least
/// is 1 - 1/sqrt(2) = 0.29 of D_H, at roughness 1 seen from above.
template <scalar_number Real>
Real visible_facet_area(Real n_dot_v, Real roughness) {
    constexpr Real pi = Real(3.14159265358979323846);
    const Real alpha = clamp(roughness, Real(smallest_roughness), Real(1));
    const Real mu = clamp(n_dot_v, Real(0), Real(1));
    const Real theta_v = std::acos(mu);
    const Real lower = pi / 4 - theta_v / 2;
    const Real upper = pi / 4 + theta_v / 2;
    const Real all_azimuths = detail::facet_area_within(std::cos(lower), alpha);

    const auto left_beyond = [alpha](Real theta) {
        const Real sine = alpha * std::cos(theta);
        return sine / std::sqrt(sine * sine + std::sin(theta) * std::sin(theta));
    };
    const Real s_low = theta_v >= pi / 2 ? Real(0) : left_beyond(upper);
    const Real s_high = left_beyond(lower);
    const Real half = (s_high - s_low) / 2;
    constexpr int nodes = 96;
    Real sum = 0;
    for (int i = 0; i < nodes; ++i) {
        const Real angle = pi * (static_cast<Real>(i) + Real(0.5)) / nodes;
        const Real s = s_low + half * (1 - std::cos(angle));
        const Real tangent = alpha * std::sqrt(maximum(Real(0), 1 - s * s)) / s;
        const Real cot_2theta = (1 - tangent * tangent) / (2 * tangent);
        const Real bound = mu < 1 ? -cot_2theta * mu / std::sqrt(1 - mu * mu) : Real(0);
        const Real azimuths = std::acos(clamp(bound, Real(-1), Real(1))) / pi;
        // D sin d theta 2 pi = (du) / cos(theta) with u = 1 - s^2, du = 2 s ds
        sum += 2 * std::sqrt(s * s + alpha * alpha * (1 - s * s)) * azimuths * half * std::sin(angle);
    }
    // The nodes' weight is that for which the rule integrates the sine itself exactly.
    return all_azimuths + sum * 2 * std::sin(pi / (2 * nodes));
}

/// The split-sum integral of the BRDF, E(f0) = f0 scale + bias (Karis 2013): the directional albedo of GGX with
/// Smith masking-shadowing and Schlick's Fresnel.
template <scalar_number Real>
struct albedo_terms {
    Real scale; ///< what f0 is multiplied by
    Real bias;  ///< what is added

    /// E(f0), band by band.
    rgb<Real> operator()(rgb<Real> f0) const { return scale * f0 + rgb<Real>{bias, bias, bias}; }
};

/// By sampling visible normals (Heitz 2018). They are points of a disc; the strata are finer towards its edge, where
/// the tail of the lobe lies, and cover half of it, since the other half mirrors it. Absolute error 3e-3.
template <scalar_number Real>
albedo_terms<Real> directional_albedo_terms(Real n_dot_v, Real roughness) {
    constexpr Real pi = Real(3.14159265358979323846);
    const Real alpha = clamp(roughness, Real(smallest_roughness), Real(1));
    const Real mu = clamp(n_dot_v, Real(1e-4), Real(1));
    const vector3<Real> wo{std::sqrt(1 - mu * mu), 0, mu};
    const vector3<Real> stretched = normalized(vector3<Real>{alpha * wo.x, 0, wo.z});
    const vector3<Real> first{0, 1, 0}; // both perpendicular to `stretched`, which has no y
    const vector3<Real> second = cross(stretched, first);
    constexpr int radii = 24, azimuths = 16;
    albedo_terms<Real> sum{0, 0};
    Real strata = 0;
    for (int i = 0; i < radii; ++i) {
        const Real to_edge = (static_cast<Real>(i) + Real(0.5)) / radii; // s^2 = 1 - r^2, so r dr = s ds
        const Real r = std::sqrt(1 - to_edge * to_edge);
        for (int j = 0; j < azimuths; ++j) {
            strata += to_edge;
            const Real phi = pi * ((static_cast<Real>(j) + Real(0.5)) / azimuths - Real(0.5));
            const Real t1 = r * std::cos(phi);
            const Real blend = (1 + stretched.z) / 2;
            const Real t2 = (1 - blend) * std::sqrt(1 - t1 * t1) + blend * r * std::sin(phi);
            const Real t3 = std::sqrt(maximum(Real(0), 1 - t1 * t1 - t2 * t2));
            const vector3<Real> sampled = t1 * first + t2 * second + t3 * stretched;
            const vector3<Real> h =
                normalized(vector3<Real>{alpha * sampled.x, alpha * sampled.y, maximum(Real(1e-9), sampled.z)});
            const vector3<Real> wi = reflected(wo, h);
            if (!(wi.z > 0)) continue;
            // The weight of a visible normal is F G2 / G1(wo).
            const Real weight = to_edge * ggx_masking_shadowing(wi.z, mu, alpha) / ggx_masking(mu, alpha);
            const Real fresnel = schlick_fresnel(Real(0), dot(wi, h));
            sum.scale += (1 - fresnel) * weight;
            sum.bias += fresnel * weight;
        }
    }
    return {sum.scale / strata, sum.bias / strata};
}

namespace detail {

/// Values on a square grid over [0,1]^2, bilinear between.
template <std::size_t Size>
struct bilinear_table {
    std::array<std::array<float, Size>, Size> value; ///< [y][x]

    float operator()(float x, float y) const {
        const float scaled_x = x * (Size - 1), scaled_y = y * (Size - 1);
        const auto column = static_cast<std::size_t>(minimum(scaled_x, Size - 2.F));
        const auto row = static_cast<std::size_t>(minimum(scaled_y, Size - 2.F));
        const float fx = scaled_x - static_cast<float>(column), fy = scaled_y - static_cast<float>(row);
        const auto along = [&](const std::array<float, Size>& line) {
            return (1 - fx) * line[column] + fx * line[column + 1];
        };
        return (1 - fy) * along(value[row]) + fy * along(value[row + 1]);
    }
};

} // namespace detail

/// E_D / D_H and the directional albedo for all views and roughnesses, bilinear in tables.
///
/// Built once (tens of milliseconds), then constant. Rows are uniform in perceptual roughness. Columns of E_D are
/// uniform in n.v (1+alpha) / (n.v + alpha), which follows its rise at grazing angles whatever the roughness; those of
/// the albedo in sqrt(n.v). Absolute error against the functions above: E_D / D_H 5e-4; albedo 1e-2, and 5e-2 at
/// grazing angles (n.v < 0.05) of very smooth surfaces (roughness < 0.01) (tests/microfacet_test.cpp).
class microfacet_table {
  public:
    /// Computes the tables.
    microfacet_table() {
        for (std::size_t row = 0; row < visible_size; ++row) {
            const double alpha = row_roughness(row, visible_size);
            for (std::size_t column = 0; column < visible_size; ++column) {
                const double x = static_cast<double>(column) / (visible_size - 1);
                const double n_dot_v = alpha * x / (1 + alpha - x);
                visible_.value[row][column] =
                    static_cast<float>(visible_facet_area(n_dot_v, alpha) / total_facet_area(alpha));
            }
        }
        for (std::size_t row = 0; row < albedo_size; ++row) {
            const double alpha = row_roughness(row, albedo_size);
            for (std::size_t column = 0; column < albedo_size; ++column) {
                const double x = static_cast<double>(column) / (albedo_size - 1);
                const auto albedo = directional_albedo_terms(x * x, alpha);
                scale_.value[row][column] = static_cast<float>(albedo.scale);
                bias_.value[row][column] = static_cast<float>(albedo.bias);
            }
        }
    }

    /// E_D / D_H: the share of all facets that reflect the eye's ray to above the horizon, in [0.29, 1].
    /// n_dot_v and roughness in [0, 1]; beyond, the nearer end.
    float visible_fraction(float n_dot_v, float roughness) const {
        const float alpha = clamp(roughness, smallest_roughness, 1.F);
        const float mu = clamp(n_dot_v, 0.F, 1.F);
        return visible_(mu * (1 + alpha) / (mu + alpha), std::sqrt(alpha));
    }

    /// Directional albedo E(f0) = f0 scale + bias; arguments as above.
    albedo_terms<float> albedo(float n_dot_v, float roughness) const {
        const float x = std::sqrt(clamp(n_dot_v, 0.F, 1.F)), y = std::sqrt(clamp(roughness, 0.F, 1.F));
        return {scale_(x, y), bias_(x, y)};
    }

  private:
    static constexpr std::size_t visible_size = 64;
    static constexpr std::size_t albedo_size = 32;

    static double row_roughness(std::size_t row, std::size_t size) {
        const double perceptual = static_cast<double>(row) / static_cast<double>(size - 1);
        return std::fmax(perceptual * perceptual, static_cast<double>(smallest_roughness));
    }

    detail::bilinear_table<visible_size> visible_;
    detail::bilinear_table<albedo_size> scale_;
    detail::bilinear_table<albedo_size> bias_;
};

} // namespace mica
