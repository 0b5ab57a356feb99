// mica/shade/lights.hpp: lights with a place or a direction: what they add to a pixel, and with what probability a facet
// flashes towards them.
//
//     respond(light, point, facets, f0, table) -> {smooth, probability, half_vector}
//
// with facets a ggx or beckmann distribution. What is returned makes a light_class of the kernel (glint_kernel.hpp).
// Everything is 0 where the light or the eye is below the surface.
//
// Rectangles and disks. A facet flashes where it reflects the eye's ray into the light, so the probability is the facet area
// of the light's half vectors over D_H: the integral of F d psi / (2 pi) around their contour in slopes (ndf.hpp),
// where the horizon cuts the light along the horizon. KK24 takes it from linearly transformed cosines. Where the mirror direction lies well outside, F(infinity) - F is integrated instead, which keeps the
// relative accuracy of small probabilities.
//
// An edge of the light is an arc of a great circle; with phi the angle from its point nearest to the mirror direction, the
// integrand has a peak of a width that is known, and beyond it a tail of all scales. In x, phi = width sinh(x), both are
// smooth, and few nodes of Gauss's rule suffice to either side.
//
// Relative error of p, against plain sums over the light: with one roughness 0.2 % for rectangles at n.v >= 0.15 and 5 % at
// 0.05; for disks 3 % at n.v >= 0.4 and 16 % at 0.15, where the lobe is narrow or the horizon cuts them,
// and up to all of p at 0.05. With two roughnesses
// 1 % up to a ratio of 4, n.v >= 0.17 and roughness >= 0.05 (tests/lights_test.cpp). At a ratio of 10 and roughness 0.02, lights that are long and thin or mostly
// below the horizon may be off by factors. p and the smooth radiance have the same error, so that no light is lost by it.
//
// Sources: DB23 Eq. 6-9 (directional); KK24 (sun, area); the contour integral is mica's own.
#pragma once

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
    vector3<float> towards; ///< the middle, of length 1
    rgb<float> radiance;
    float half_angle = 0.00465F; ///< radians; the sun's by default. Omega = 2 pi (1 - cos half_angle)
};

/// Shines to the side of cross(half_u, half_v); the two are perpendicular or not.
struct rectangle_light {
    vector3<float> centre, half_u, half_v;
    rgb<float> radiance;
};

/// Shines to the side of its normal, which is of length 1.
struct disk_light {
    vector3<float> centre, normal;
    float radius;
    rgb<float> radiance;
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
template <real_number Real>
MICA_HOST_DEVICE constexpr vector3<Real> select(const mask_of<Real>& mask, vector3<Real> a, vector3<Real> b) {
    return {mica::select(mask, a.x, b.x), mica::select(mask, a.y, b.y), mica::select(mask, a.z, b.z)};
}

/// a / |a|, and 0 for 0.
template <real_number Real>
MICA_HOST_DEVICE constexpr vector3<Real> normalized_or_zero(vector3<Real> a) {
    const Real square = dot(a, a);
    return inverse_sqrt(maximum(square, Real(1e-30F))) * a;
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
        const auto lit = (wi.z > Real(0)) && (wo.z > Real(0));
        half_vector = normalized_or_zero(wi + wo);
        wi_dot_h = maximum(dot(wi, half_vector), Real(1e-6F));
        relative_density = mica::select(lit, facets.relative_density(half_vector), Real(0));
        const Real common = relative_density * facets.density_at_normal() * facets.masking_shadowing(wi, wo) /
                            (Real(4) * mica::select(lit, wo.z, Real(1)));
        smooth = common * (schlick_fresnel(f0, wi_dot_h) * broadcast<Real>(irradiance));
    }
};

template <int Nodes>
struct gauss_rule; ///< nodes and weights of [-1, 1]
template <>
struct gauss_rule<16> {
    static constexpr float node[] = {-0.989400935F, -0.944575023F, -0.865631202F, -0.755404408F,
                                     -0.617876244F, -0.458016778F, -0.281603551F, -0.0950125098F,
                                     0.0950125098F, 0.281603551F,  0.458016778F,  0.617876244F,
                                     0.755404408F,  0.865631202F,  0.944575023F,  0.989400935F};
    static constexpr float weight[] = {0.0271524594F, 0.0622535239F, 0.0951585117F, 0.124628971F,
                                       0.149595989F,  0.169156519F,  0.182603415F,  0.18945061F,
                                       0.18945061F,   0.182603415F,  0.169156519F,  0.149595989F,
                                       0.124628971F,  0.0951585117F, 0.0622535239F, 0.0271524594F};
};
template <>
struct gauss_rule<6> {
    static constexpr float node[] = {-0.932469514F, -0.661209386F, -0.238619186F,
                                     0.238619186F,  0.661209386F,  0.932469514F};
    static constexpr float weight[] = {0.171324492F, 0.360761573F, 0.467913935F,
                                       0.467913935F, 0.360761573F, 0.171324492F};
};

/// The facet area whose normals reflect wo into a region of the sphere, from the edges of its contour.
template <class Facets, real_number Real>
class contour_area {
  public:
    MICA_HOST_DEVICE constexpr contour_area(const Facets& facets, vector3<Real> wo)
        : inverse_x_(Real(1) / Facets::limited(facets.roughness_x)),
          inverse_y_(Real(1) / Facets::limited(facets.roughness_y)), least_(smaller(facets) * smaller(facets)),
          most_(larger(facets) * larger(facets)), wo_(wo), mirror_{-wo.x, -wo.y, wo.z} {}

    /// How far the mirror direction is from the plane of an edge, as the sine; > 0 on the inner side.
    MICA_HOST_DEVICE constexpr Real inside(vector3<Real> edge_normal) const { return dot(mirror_, edge_normal); }

    /// Twice pi times the part of the area that an edge from a to b contributes, directions of any length less than half a
    /// turn apart on the great circle with that normal; `beyond`: of F - F(infinity) instead of F.
    template <int Nodes>
    MICA_HOST_DEVICE constexpr Real edge(vector3<Real> a, vector3<Real> b, vector3<Real> edge_normal,
                                         const mask_of<Real>& beyond) const {
        const Real delta = inside(edge_normal);
        // The point of the circle nearest to the mirror direction; where all are equally near, a.
        const auto projected = mirror_ - delta * edge_normal;
        const auto round = dot(projected, projected) < Real(1e-8F);
        const auto foot = normalized_or_zero(select(round, a, projected));
        const auto beside = cross(edge_normal, foot);
        // In slopes a step of length s from the mirror direction is (s.x / alpha_x, s.y / alpha_y) / (2 n.wo), and the point
        // nearest to the origin is elsewhere on the edge.
        const Real normal_x = edge_normal.x * inverse_x_, normal_y = edge_normal.y * inverse_y_;
        const Real beside_x = beside.x * inverse_x_, beside_y = beside.y * inverse_y_;
        const Real inverse = Real(1) / maximum(beside_x * beside_x + beside_y * beside_y, Real(1e-12F));
        const Real shift = -delta * (normal_x * beside_x + normal_y * beside_y) * inverse;
        const Real apart = delta * (normal_x * beside_y - normal_y * beside_x) * inverse;
        const auto nearest = normalized_or_zero(foot + clamp(shift, Real(-1), Real(1)) * beside);
        const Real peak = apart * apart + Real(4) * wo_.z * wo_.z * inverse;

        // phi is counted from it, or from the end that is nearer to it where it is not on the edge.
        const auto start = normalized_or_zero(a), end = normalized_or_zero(b);
        const auto on_edge =
            (dot(cross(start, nearest), edge_normal) >= Real(0)) && (dot(cross(nearest, end), edge_normal) >= Real(0));
        const Real from_start = dot(start, nearest), from_end = dot(end, nearest);
        const auto closer = select(from_start > from_end, start, end);
        const auto origin = select(on_edge, nearest, closer);
        const auto along = cross(edge_normal, origin);
        const Real away = mica::select(on_edge, Real(0), Real(2) - Real(2) * maximum(from_start, from_end));
        const Real width = mica::sqrt(clamp(peak + away, Real(1e-10F), Real(4)));

        const Real first = inverse_sinh(minimum(angle(start, origin, along), Real(0)), width);
        const Real last = inverse_sinh(maximum(angle(end, origin, along), Real(0)), width);
        const Real middle = mica::select(on_edge, Real(0), Real(0.5F) * (first + last));
        return half<Nodes>(first, middle, origin, along, width, beyond) +
               half<Nodes>(middle, last, origin, along, width, beyond);
    }

  private:
    MICA_HOST_DEVICE static constexpr Real smaller(const Facets& facets) {
        return minimum(Facets::limited(facets.roughness_x), Facets::limited(facets.roughness_y));
    }
    MICA_HOST_DEVICE static constexpr Real larger(const Facets& facets) {
        return maximum(Facets::limited(facets.roughness_x), Facets::limited(facets.roughness_y));
    }

    /// phi of a direction of the circle, in [-pi, pi].
    MICA_HOST_DEVICE static constexpr Real angle(vector3<Real> l, vector3<Real> origin, vector3<Real> along) {
        return Real(6.28318531F) * angle_in_turns(dot(l, along), dot(l, origin));
    }

    /// x with width sinh(x) = phi.
    MICA_HOST_DEVICE static constexpr Real inverse_sinh(Real phi, Real width) {
        const Real size = abs(phi) / width;
        const Real x = mica::log(size + mica::sqrt(size * size + Real(1)));
        return mica::select(phi < Real(0), -x, x);
    }

    template <int Nodes>
    MICA_HOST_DEVICE constexpr Real half(Real first, Real last, vector3<Real> origin, vector3<Real> along, Real width,
                                         const mask_of<Real>& beyond) const {
        const Real centre = Real(0.5F) * (last + first), reach = Real(0.5F) * (last - first);
        Real sum = Real(0);
        for (int i = 0; i < Nodes; ++i) {
            const Real x = centre + Real(gauss_rule<Nodes>::node[i]) * reach;
            sum = sum + Real(gauss_rule<Nodes>::weight[i]) * integrand(x, origin, along, width, beyond);
        }
        return reach * sum;
    }

    /// F / q (X dY - Y dX) / dx.
    MICA_HOST_DEVICE constexpr Real integrand(Real from_origin, vector3<Real> origin, vector3<Real> along, Real width,
                                              const mask_of<Real>& beyond) const {
        const Real growth = mica::exp(from_origin), decay = Real(1) / growth;
        const Real phi = Real(0.5F) * width * (growth - decay), speed = Real(0.5F) * width * (growth + decay);
        const auto turn = half_turns(minimum(abs(phi) * Real(0.318309886F), Real(1)));
        const Real cosine = turn.cosine, sine = mica::select(phi < Real(0), -turn.sine, turn.sine);
        const auto l = cosine * origin + sine * along;
        const auto change = cosine * along + Real(-1) * (sine * origin);
        const auto m = l + wo_; // along the half vector
        const Real inverse_z = Real(1) / maximum(m.z, Real(1e-6F));
        const Real x = m.x * inverse_z, y = m.y * inverse_z;
        const Real stretched_x = x * inverse_x_, stretched_y = y * inverse_y_;
        const Real q = stretched_x * stretched_x + stretched_y * stretched_y, t = x * x + y * y;
        const Real a2 = clamp(t / maximum(q, Real(1e-20F)), least_, most_);
        const Real w = mica::sqrt(Real(1) + t);
        using shape = typename Facets::shape;
        Real area = Real(0);
        if (!all(beyond)) area = shape::within_over_square(a2, q, w);
        if (any(beyond)) area = mica::select(beyond, -shape::beyond(a2, q, w) / maximum(q, Real(1e-20F)), area);
        return area * (x * change.y - y * change.x) * inverse_z * inverse_x_ * inverse_y_ * speed;
    }

    Real inverse_x_, inverse_y_, least_, most_;
    vector3<Real> wo_, mirror_;
};

/// The facet area that reflects wo into a convex polygon seen from the origin. Corners anticlockwise as seen from outside the
/// sphere; what is below the horizon is cut off.
template <int Nodes, class Facets, real_number Real, std::size_t Corners>
MICA_HOST_DEVICE constexpr Real area_of(const std::array<vector3<Real>, Corners>& corner, const Facets& facets,
                                        Real facet_area, vector3<Real> wo) {
    const contour_area<Facets, Real> contour(facets, wo);
    // How far is the mirror direction from the contour, and on which side?
    Real least = Real(1), lowest = Real(1);
    std::array<vector3<Real>, Corners> edge_normal;
    for (std::size_t i = 0; i < Corners; ++i) {
        edge_normal[i] = normalized_or_zero(cross(corner[i], corner[(i + 1) % Corners]));
        least = minimum(least, contour.inside(edge_normal[i]));
        lowest = minimum(lowest, corner[i].z);
    }
    const auto cut = lowest < Real(0);
    const Real apart = minimum(abs(least), mica::select(cut, wo.z, Real(1)));
    const Real lobe = Real(2) * maximum(facets.limited(facets.roughness_x), facets.limited(facets.roughness_y));
    const auto beyond = apart > lobe; // else F itself is the smoother
    Real sum = Real(0);
    vector3<Real> out{Real(1), Real(0), Real(0)}, in{Real(1), Real(0), Real(0)}; // where the contour meets the horizon
    for (std::size_t i = 0; i < Corners; ++i) {
        const auto& a = corner[i];
        const auto& b = corner[(i + 1) % Corners];
        const auto rises = (a.z < Real(0)) && (b.z >= Real(0)), falls = (a.z >= Real(0)) && (b.z < Real(0));
        const auto crosses = rises || falls;
        const Real part = a.z / mica::select(crosses, a.z - b.z, Real(1));
        vector3<Real> horizon = a + part * (b - a);
        horizon.z = Real(0);
        in = select(rises, horizon, in);
        out = select(falls, horizon, out);
        const auto above = (a.z >= Real(0)) || (b.z >= Real(0));
        const Real area =
            contour.template edge<Nodes>(select(rises, horizon, a), select(falls, horizon, b), edge_normal[i], beyond);
        sum = sum + mica::select(above, area, Real(0));
    }
    if (any(cut)) {
        // Along the horizon, in two parts: together they may be half a turn.
        const vector3<Real> up{Real(0), Real(0), Real(1)};
        const auto sum_of_ends = normalized_or_zero(out) + normalized_or_zero(in);
        const vector3<Real> across{-out.y, out.x, Real(0)};
        const auto between = select(dot(sum_of_ends, sum_of_ends) > Real(1e-6F), sum_of_ends, across);
        const Real area = contour.template edge<Nodes>(out, between, up, beyond) +
                          contour.template edge<Nodes>(between, in, up, beyond);
        sum = sum + mica::select(cut && (dot(out - in, out - in) > Real(0)), area, Real(0));
    }
    const Real enclosed = mica::select(beyond && (least > Real(0)), facet_area, Real(0));
    return clamp(enclosed + sum * Real(0.159154943F), Real(0), facet_area);
}

/// What the tables say of a view, lane by lane: E_D / D_H and the albedo.
template <real_number Real>
struct view_terms {
    Real visible_fraction;
    rgb<Real> albedo;
};
template <real_number Real>
view_terms<Real> view_terms_of(const microfacet_table& table, Real n_dot_v, Real roughness, rgb<float> f0) {
    view_terms<Real> terms{};
    for (int i = 0; i < lanes_of<Real>; ++i) {
        const auto mu = static_cast<float>(lane(n_dot_v, i)), alpha = static_cast<float>(lane(roughness, i));
        mica::set_lane(terms.visible_fraction, i, scalar_of<Real>(table.visible_fraction(mu, alpha)));
        mica::set_lane(terms.albedo, i, table.albedo(mu, alpha)(f0));
    }
    return terms;
}

/// An area light of so many corners. Its smooth radiance is the albedo of the split sum, parted among the facets that
/// reflect to above the horizon: all of it for a light around everything. The albedo and the number of those facets are
/// those of GGX of the mean roughness.
template <int Nodes, class Facets, real_number Real, std::size_t Corners>
light_response<Real> respond_area(const std::array<vector3<Real>, Corners>& corners, const mask_of<Real>& faces,
                                  vector3<Real> centre, rgb<float> radiance, vector3<Real> wo, const Facets& facets,
                                  rgb<float> f0, const microfacet_table& table) {
    const auto lit = faces && (wo.z > Real(0));
    const Real facet_area = facets.facet_area();
    const Real probability = mica::select(lit, area_of<Nodes>(corners, facets, facet_area, wo) / facet_area, Real(0));
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
light_response<Real> respond(const rectangle_light& light, const shading_point<Real>& point, const Facets<Real>& facets,
                             rgb<float> f0, const microfacet_table& table) {
    const auto to = detail::broadcast<Real>(light.centre) - point.position;
    const auto centre = point.local(to);
    const auto u = point.local(detail::broadcast<Real>(light.half_u)),
               v = point.local(detail::broadcast<Real>(light.half_v));
    const std::array<vector3<Real>, 4> corners{centre - u - v, centre - u + v, centre + u + v, centre + u - v};
    const auto faces = dot(to, detail::broadcast<Real>(cross(light.half_u, light.half_v))) < Real(0);
    return detail::respond_area<16>(corners, faces, centre, light.radiance, point.local(point.wo), facets, f0, table);
}

/// Disk: a polygon of 16 corners and the same area.
template <real_number Real, template <real_number> class Facets>
light_response<Real> respond(const disk_light& light, const shading_point<Real>& point, const Facets<Real>& facets,
                             rgb<float> f0, const microfacet_table& table) {
    constexpr std::size_t corners_of_disk = 16;
    constexpr float same_area = 1.01301137F; // sqrt(pi / (8 sin(2 pi / 16)))
    const bool upright = abs(light.normal.z) > 0.5F;
    const auto first = normalized(cross(light.normal, upright ? vector3<float>{1, 0, 0} : vector3<float>{0, 0, 1}));
    const auto second = cross(light.normal, first);
    const auto to = detail::broadcast<Real>(light.centre) - point.position;
    std::array<vector3<Real>, corners_of_disk> corners;
    for (std::size_t i = 0; i < corners_of_disk; ++i) {
        // Clockwise about the normal, which is anticlockwise from outside the sphere.
        const float turn = 1 - static_cast<float>(i) / corners_of_disk;
        const auto half = half_turns(turn); // of half the angle
        const float cosine = 1 - 2 * half.sine * half.sine, sine = 2 * half.sine * half.cosine;
        const float reach = same_area * light.radius;
        corners[i] = point.local(to + detail::broadcast<Real>(reach * cosine * first + reach * sine * second));
    }
    const auto faces = dot(to, detail::broadcast<Real>(light.normal)) < Real(0);
    return detail::respond_area<6>(corners, faces, point.local(to), light.radiance, point.local(point.wo), facets, f0,
                                   table);
}

} // namespace mica
