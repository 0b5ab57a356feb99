// mica/shade/lights.hpp: lights with a place or a direction: what they add to a pixel, and with what probability a facet
// flashes towards them.
//
//     respond(light, point, facets, f0, table) -> {smooth, probability, half_vector}
//
// with facets a ggx or beckmann distribution. What is returned makes a light_class of the kernel (glint_kernel.hpp).
// Everything is 0 where the light or the eye is below the surface.
//
// Rectangles and disks: a facet flashes where it reflects the eye's ray into the light, so p is the facet area of the light's
// half vectors over D_H (contour_area.hpp), of what is above the horizon. KK24 takes it from linearly transformed cosines. p
// and the smooth radiance have the same error, so that no light is lost by it. The smooth radiance is that of the split sum, as
// under environments: six walls around a point are a white environment. It has no Fresnel term and no shadowing of its own
// direction, which suns have: on rough surfaces a sun and a far disk of its size differ, at the rim by several times.
//
// Sources: DB23 Eq. 6-9 (directional); KK24 (sun, area).
#pragma once

#include "contour_area.hpp"
#include "microfacet.hpp"
#include "ndf.hpp"
#include "shading_point.hpp"

namespace mica {

/// What a light does in a pixel.
template <real_number Real>
struct light_response {
    rgb<Real> smooth;          ///< radiance towards the eye in the limit of infinitely many facets
    Real probability;          ///< that a facet flashes, in [0, 1]
    vector3<Real> half_vector; ///< in the surface's frame, of length 1
};

/// From one direction. Published with a free parameter instead of a size: the share of the facets that can flash.
struct directional_light {
    vector3<float> towards;   ///< of length 1
    rgb<float> irradiance;    ///< on a surface that faces it
    float glint_fraction = 1; ///< R in (0, 1], of DB23 Eq. 6: p = R D(h) / D(n), at most 1
};

/// From a small solid angle, the sun among them (KK24): p = D(h) Omega / (4 l.h) / D_H, at most 1.
struct sun_light {
    vector3<float> towards;      ///< the middle, of length 1
    rgb<float> radiance;         ///< uniform over the disc
    float half_angle = 0.00465F; ///< radians; the sun's by default. Omega = 2 pi (1 - cos half_angle)
};

/// Shines to the side of cross(half_u, half_v); the two are perpendicular or not.
struct rectangle_light {
    vector3<float> centre;         ///< in the scene, as shading_point::position
    vector3<float> half_u, half_v; ///< from the centre to the middle of an edge
    rgb<float> radiance;           ///< the same in all directions
};

/// Shines to the side of its normal, which is of length 1.
struct disk_light {
    vector3<float> centre; ///< in the scene, as shading_point::position
    vector3<float> normal; ///< of length 1
    float radius;          ///< > 0
    rgb<float> radiance;   ///< the same in all directions
};

namespace detail {

template <real_number Real>
MICA_HOST_DEVICE constexpr vector3<Real> broadcast(vector3<float> v) {
    return {Real(v.x), Real(v.y), Real(v.z)};
}
template <real_number Real>
MICA_HOST_DEVICE constexpr rgb<Real> broadcast(rgb<float> c) {
    return {Real(c.r), Real(c.g), Real(c.b)};
}
/// Schlick's Fresnel reflectance.
template <real_number Real>
MICA_HOST_DEVICE constexpr rgb<Real> schlick_fresnel(rgb<float> f0, Real wi_dot_h) {
    const Real m = Real(1) - clamp(wi_dot_h, Real(0), Real(1)), m2 = m * m, m5 = m2 * m2 * m;
    const auto band = [m5](float f) { return Real(f) + Real(1 - f) * m5; };
    return {band(f0.r), band(f0.g), band(f0.b)};
}

/// From one direction, of an irradiance on what faces it: F D G / (4 n.v) times it, and D.
template <real_number Real, class Facets>
struct mirrored {
    vector3<Real> half_vector;
    Real relative_density, wi_dot_h;
    rgb<Real> smooth;

    MICA_HOST_DEVICE constexpr mirrored(vector3<float> towards, rgb<float> irradiance, const shading_point<Real>& point,
                                        const Facets& facets, rgb<float> f0) {
        const auto wi = point.local(broadcast<Real>(towards)), wo = point.local(point.wo);
        const auto sum = wi + wo; // 0 for opposite directions, both along the horizon
        const auto lit = (wi.z > Real(0)) && (wo.z > Real(0)) && (dot(sum, sum) > Real(1e-20F));
        half_vector = normalized_or_zero(sum);
        wi_dot_h = maximum(dot(wi, half_vector), Real(1e-6F));
        relative_density = select(lit, facets.relative_density(half_vector), Real(0));
        const Real common = relative_density * facets.density_at_normal() * facets.masking_shadowing(wi, wo) /
                            (Real(4) * maximum(wo.z, Real(1e-6F)));
        smooth = common * (schlick_fresnel(f0, wi_dot_h) * broadcast<Real>(irradiance));
    }
};

/// What the tables say of a view, lane by lane: E_D / D_H and the albedo.
template <real_number Real>
struct view_terms {
    Real visible_fraction;
    rgb<Real> albedo;
};
template <real_number Real>
MICA_HOST_DEVICE view_terms<Real> view_terms_of(const microfacet_table& table, Real n_dot_v, Real roughness,
                                                rgb<float> f0) {
    view_terms<Real> terms{};
    for (int i = 0; i < lanes_of<Real>; ++i) {
        const auto mu = static_cast<float>(lane(n_dot_v, i)), alpha = static_cast<float>(lane(roughness, i));
        set_lane(terms.visible_fraction, i, scalar_of<Real>(table.visible_fraction(mu, alpha)));
        set_lane(terms.albedo, i, table.albedo(mu, alpha)(f0));
    }
    return terms;
}

/// Whether the side of a plane through `centre` to which `normal` points is seen from the origin; not from within the plane,
/// where rounding would decide.
template <real_number Real>
MICA_HOST_DEVICE constexpr mask_of<Real> shines_here(vector3<Real> centre, vector3<Real> normal) {
    const Real height = dot(centre, normal);
    return (height < Real(0)) && (height * height > Real(1e-12F) * (dot(centre, centre) * dot(normal, normal)));
}

/// An area light with its probability. Its smooth radiance is the albedo of the split sum, parted among the facets that
/// reflect to above the horizon: all of it for a light around everything. The albedo and the number of those facets are those
/// of GGX of the mean roughness.
template <class Facets, real_number Real>
MICA_HOST_DEVICE light_response<Real> respond_area(Real probability, vector3<Real> centre, rgb<float> radiance,
                                                   vector3<Real> wo, const Facets& facets, rgb<float> f0,
                                                   const microfacet_table& table) {
    const auto terms = view_terms_of(table, wo.z, mica::sqrt(facets.roughness_x * facets.roughness_y), f0);
    const Real share = minimum(probability / maximum(terms.visible_fraction, Real(0.25F)), Real(1));
    return {share * (terms.albedo * broadcast<Real>(radiance)), probability,
            normalized_or_zero(normalized_or_zero(centre) + wo)};
}

} // namespace detail

/// Directional light. `f0` is the reflectance at normal incidence.
template <real_number Real, template <real_number> class Facets>
MICA_HOST_DEVICE constexpr light_response<Real>
respond(const directional_light& light, const shading_point<Real>& point, const Facets<Real>& facets, rgb<float> f0) {
    const detail::mirrored<Real, Facets<Real>> seen(light.towards, light.irradiance, point, facets, f0);
    return {seen.smooth, clamp(Real(light.glint_fraction) * seen.relative_density, Real(0), Real(1)), seen.half_vector};
}

/// Sun. Where p would exceed 1 (a lobe narrower than the sun) every facet flashes.
template <real_number Real, template <real_number> class Facets>
MICA_HOST_DEVICE constexpr light_response<Real> respond(const sun_light& light, const shading_point<Real>& point,
                                                        const Facets<Real>& facets, rgb<float> f0) {
    const float sine = half_turns(light.half_angle * 0.159154943F).sine; // of half the half angle
    const float solid_angle = 4 * 3.14159265F * sine * sine;
    const detail::mirrored<Real, Facets<Real>> seen(light.towards, solid_angle * light.radiance, point, facets, f0);
    const Real area = seen.relative_density * facets.density_at_normal() * Real(solid_angle / 4) / seen.wi_dot_h;
    return {seen.smooth, clamp(area / facets.facet_area(), Real(0), Real(1)), seen.half_vector};
}

/// Neither needs the table; with it, all lights are called alike.
template <class Light, real_number Real, template <real_number> class Facets>
MICA_HOST_DEVICE constexpr light_response<Real> respond(const Light& light, const shading_point<Real>& point,
                                                        const Facets<Real>& facets, rgb<float> f0,
                                                        const microfacet_table&) {
    return respond(light, point, facets, f0);
}

/// Rectangle.
template <real_number Real, template <real_number> class Facets>
MICA_HOST_DEVICE light_response<Real> respond(const rectangle_light& light, const shading_point<Real>& point,
                                              const Facets<Real>& facets, rgb<float> f0,
                                              const microfacet_table& table) {
    const auto centre = point.local(detail::broadcast<Real>(light.centre) - point.position);
    const auto u = point.local(detail::broadcast<Real>(light.half_u)),
               v = point.local(detail::broadcast<Real>(light.half_v));
    const std::array<vector3<Real>, 4> corners{centre - u - v, centre - u + v, centre + u + v, centre + u - v};
    const auto wo = point.local(point.wo);
    const auto lit = detail::shines_here(centre, cross(u, v)) && (wo.z > Real(0));
    Real probability = Real(0);
    if (any(lit)) {
        const detail::contour_area<Facets<Real>, Real> contour(facets, wo);
        probability = select(lit, contour.of_polygon(corners) / contour.total(), Real(0));
    }
    return detail::respond_area(probability, centre, light.radiance, wo, facets, f0, table);
}

/// Disk.
template <real_number Real, template <real_number> class Facets>
MICA_HOST_DEVICE light_response<Real> respond(const disk_light& light, const shading_point<Real>& point,
                                              const Facets<Real>& facets, rgb<float> f0,
                                              const microfacet_table& table) {
    const auto centre = point.local(detail::broadcast<Real>(light.centre) - point.position);
    const auto normal = point.local(detail::broadcast<Real>(light.normal));
    const auto wo = point.local(point.wo);
    const auto lit = detail::shines_here(centre, normal) && (wo.z > Real(0));
    Real probability = Real(0);
    if (any(lit)) {
        const detail::contour_area<Facets<Real>, Real> contour(facets, wo);
        probability =
            select(lit, contour.of_disk(centre, Real(-1) * normal, Real(light.radius)) / contour.total(), Real(0));
    }
    return detail::respond_area(probability, centre, light.radiance, wo, facets, f0, table);
}

} // namespace mica
