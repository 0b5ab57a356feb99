// mica/shade/contour_area.hpp: the facet area that reflects the eye's ray into a light with an edge.
//
// Those facets have their half vectors inside the light's contour, and their area is the integral of F d psi / (2 pi) around
// it in slopes (ndf.hpp); where the horizon cuts the light, along the horizon. The contour is made of arcs of circles: great
// circles for the edges of a polygon and for the horizon, quarters of the rim for a disk.
//
// With phi the angle from the point of an arc that is nearest to the origin in slopes, the integrand has a peak of a width
// that is known there, and beyond it a tail of all scales. In x, phi = width sinh(x), both are smooth, and one rule of 15
// nodes suffices for most arcs. It contains one of 7, whose difference bounds the error; arcs are halved until the sum of
// differences is small. Where the lobe's middle is outside the contour, F(infinity) - F is integrated instead, which keeps the
// relative accuracy of small areas.
//
// Relative error against binary64 (tests/contour_test.cpp, lights of all sizes around the mirror direction, roughness >= 0.02,
// n.v >= 0.05): 99 % of surfaces within 2e-4, all with roughnesses up to 1:4 within 3e-3. At 1:10 and n.v < 0.15 99 % within
// 2e-3; one in a thousand passes the lobe where no node sees it, and is off by a factor.
//
// The integral is mica's own; the distributions are those of Walter et al. 2007.
#pragma once

#include <array>

#include "ndf.hpp"

namespace mica::detail {

inline constexpr auto pi_float = static_cast<float>(pi);

/// a / |a|, and 0 for 0.
template <real_number Real>
MICA_HOST_DEVICE constexpr vector3<Real> normalized_or_zero(vector3<Real> a) {
    return inverse_sqrt(maximum(dot(a, a), Real(1e-30F))) * a;
}

/// phi in radians, |phi| <= pi; beyond, that of pi.
template <real_number Real>
MICA_HOST_DEVICE constexpr sine_cosine<Real> sine_cosine_of(Real phi) {
    const auto size = half_turns(minimum(abs(phi) * Real(1 / pi_float), Real(1)));
    return {select(phi < Real(0), -size.sine, size.sine), size.cosine};
}

/// The angle of (x, y) in radians, in [-pi, pi].
template <real_number Real>
MICA_HOST_DEVICE constexpr Real radians_of(Real y, Real x) {
    return Real(2 * pi_float) * angle_in_turns(y, x);
}

/// x with sinh(x) = y.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real inverse_sinh(Real y) {
    const Real size = abs(y), x = mica::log(size + mica::sqrt(size * size + Real(1)));
    return select(y < Real(0), -x, x);
}

/// The directions base + cos(phi) first + sin(phi) second, of any length, |phi| <= reach.
template <real_number Real>
struct circle_arc {
    vector3<Real> base, first, second;
    Real reach; ///< radians, in [0, pi / 2]

    /// The arc counted from phi; its reach stays.
    MICA_HOST_DEVICE constexpr circle_arc turned(Real phi) const {
        const auto [sine, cosine] = sine_cosine_of(phi);
        return {base, cosine * first + sine * second, cosine * second - sine * first, reach};
    }

    /// From a to b anticlockwise about the normal of their great circle; half a turn at most.
    MICA_HOST_DEVICE static constexpr circle_arc between(vector3<Real> a, vector3<Real> b, vector3<Real> normal) {
        const auto start = normalized_or_zero(a), end = normalized_or_zero(b);
        const Real sine = maximum(dot(cross(start, end), normal), Real(0));
        const Real angle = radians_of(sine, dot(start, end));
        const circle_arc from_start{{Real(0), Real(0), Real(0)}, start, cross(normal, start), Real(0.5F) * angle};
        return from_start.turned(from_start.reach);
    }
};

/// Kronrod's rule of 15 nodes and, at the odd ones and the middle, Gauss's of 7: nodes and weights of [0, 1]; those of [-1, 0]
/// mirror them (Piessens et al. 1983, QUADPACK, qk15).
struct gauss_kronrod {
    float node[7] = {0.991455371F, 0.949107912F, 0.864864423F, 0.741531186F, 0.586087235F, 0.405845151F, 0.207784955F};
    float kronrod[8] = {0.0229353220F, 0.0630920926F, 0.104790010F, 0.140653260F,
                        0.169004727F,  0.190350578F,  0.204432940F, 0.209482141F};
    float gauss[4] = {0.129484966F, 0.279705391F, 0.381830051F, 0.417959184F};
};

/// Facets seen from wo; everything in the surface's frame.
template <class Facets, real_number Real>
class contour_area {
  public:
    MICA_HOST_DEVICE constexpr contour_area(const Facets& facets, vector3<Real> wo)
        : total_(facets.facet_area()), wo_(wo), mirror_{-wo.x, -wo.y, wo.z} {
        const Real x = Facets::limited(facets.roughness_x), y = Facets::limited(facets.roughness_y);
        inverse_x_ = Real(1) / x;
        inverse_y_ = Real(1) / y;
        least_ = minimum(x * x, y * y);
        most_ = maximum(x * x, y * y);
    }

    /// Of all facets: D_H.
    MICA_HOST_DEVICE constexpr Real total() const { return total_; }

    /// Inside a convex polygon. Corners anticlockwise as seen from outside the sphere of directions, of any length.
    template <std::size_t Corners>
    MICA_HOST_DEVICE constexpr Real of_polygon(const std::array<vector3<Real>, Corners>& corner) const {
        std::array<graded_arc, Corners + 1> arcs{};
        Real inside = Real(1);
        horizon_points horizon;
        for (std::size_t i = 0; i < Corners; ++i) {
            const auto &a = corner[i], &b = corner[(i + 1) % Corners];
            const auto rises = (a.z < Real(0)) && (b.z >= Real(0)), falls = (a.z >= Real(0)) && (b.z < Real(0));
            const Real part = a.z / select(rises || falls, a.z - b.z, Real(1));
            const auto crossing = a + part * (b - a);
            horizon.into = select(rises, crossing, horizon.into);
            horizon.out_of = select(falls, crossing, horizon.out_of);
            const auto start = select(rises, crossing, a), end = select(falls, crossing, b);
            const auto above = (a.z >= Real(0)) || (b.z >= Real(0));
            const auto normal = normalized_or_zero(cross(a, b));
            inside = minimum(inside, dot(mirror_, normal));
            arcs[i] = graded_edge(circle_arc<Real>::between(start, select(above, end, start), normal));
        }
        arcs.back() = graded_edge(horizon.arc());
        return area(arcs, inside > Real(0));
    }

    /// Inside a disk whose normal, of length 1, points away from the surface.
    MICA_HOST_DEVICE constexpr Real of_disk(vector3<Real> centre, vector3<Real> normal, Real radius) const {
        // The mirror direction meets the disk's plane at towards / forward from the centre.
        const Real forward = dot(mirror_, normal);
        const auto towards = dot(centre, normal) * mirror_ - forward * centre;
        const auto inside = (forward > Real(0)) && (dot(towards, towards) < radius * radius * forward * forward);
        // The rim is counted from its highest point if the horizon cuts it, else from the point towards the mirror direction.
        const vector3<Real> uphill{-normal.z * normal.x, -normal.z * normal.y, Real(1) - normal.z * normal.z};
        const Real height = radius * mica::sqrt(maximum(uphill.z, Real(0)));
        const auto cut = centre.z < height, hidden = centre.z <= -height;
        const Real cosine = clamp(-centre.z / maximum(height, Real(1e-20F)), Real(-1), Real(1));
        const Real above = radians_of(mica::sqrt(Real(1) - cosine * cosine), cosine);
        const Real reach = select(hidden, Real(0), select(cut, above, Real(pi_float)));
        const auto aside = select(dot(towards, towards) > Real(1e-12F), towards, any_across(normal));
        const auto first = normalized_or_zero(select(cut, uphill, aside));
        const circle_arc<Real> rim{centre, radius * first, radius * cross(normal, first), Real(1.F / quarters) * reach};

        std::array<graded_arc, quarters + 1> arcs{};
        for (int i = 0; i < quarters; ++i)
            arcs[static_cast<std::size_t>(i)] =
                graded_rim(rim.turned(static_cast<float>(2 * i + 1 - quarters) * rim.reach));
        const auto end = sine_cosine_of(reach);
        const auto middle = centre + end.cosine * rim.first, aside_of_it = end.sine * rim.second;
        horizon_points horizon;
        horizon.out_of = select(cut && !hidden, middle + aside_of_it, horizon.out_of);
        horizon.into = select(cut && !hidden, middle - aside_of_it, horizon.into);
        arcs.back() = graded_edge(horizon.arc());
        return area(arcs, inside);
    }

  private:
    static constexpr int quarters = 4;
    static constexpr float tolerance = 1e-3F; ///< of the difference of the two rules, to the area
    static constexpr int most_halvings = 6;

    /// An arc with phi = width sinh(x), x from start to end.
    struct graded_arc {
        circle_arc<Real> arc;
        Real width, start, end;
        Real nearest; ///< X^2 + Y^2 at phi = 0
    };

    /// Where the contour passes the horizon; the same point if it does not.
    struct horizon_points {
        vector3<Real> out_of{Real(1), Real(0), Real(0)}, into{Real(1), Real(0), Real(0)};

        MICA_HOST_DEVICE constexpr circle_arc<Real> arc() const {
            return circle_arc<Real>::between({out_of.x, out_of.y, Real(0)}, {into.x, into.y, Real(0)},
                                             {Real(0), Real(0), Real(1)});
        }
    };

    /// A direction's half vector in slopes over the roughness, and how they change with phi.
    struct slopes {
        Real x, y, dx, dy;
        Real q;       ///< x^2 + y^2
        Real t;       ///< the square of the slope itself
        Real turning; ///< x dy - y dx
    };

    /// Perpendicular to the normal, nothing else.
    MICA_HOST_DEVICE static constexpr vector3<Real> any_across(vector3<Real> normal) {
        const vector3<Real> x{Real(1), Real(0), Real(0)}, z{Real(0), Real(0), Real(1)};
        return cross(normal, select(abs(normal.z) > Real(0.7F), x, z));
    }

    MICA_HOST_DEVICE constexpr slopes slopes_at(const circle_arc<Real>& arc, Real phi) const {
        const auto [sine, cosine] = sine_cosine_of(phi);
        const auto l = arc.base + cosine * arc.first + sine * arc.second;
        const auto dl = cosine * arc.second - sine * arc.first;
        const Real square = maximum(dot(l, l), Real(1e-30F)), inverse_length = inverse_sqrt(square);
        const Real length = square * inverse_length;
        const auto m = l + length * wo_; // along the half vector
        const auto dm = dl + (dot(l, dl) * inverse_length) * wo_;
        const Real inverse_z = Real(1) / maximum(m.z, Real(1e-6F) * length);
        const Real slope_x = m.x * inverse_z, slope_y = m.y * inverse_z;
        const Real x = slope_x * inverse_x_, y = slope_y * inverse_y_;
        return {x,
                y,
                (dm.x - slope_x * dm.z) * inverse_z * inverse_x_,
                (dm.y - slope_y * dm.z) * inverse_z * inverse_y_,
                x * x + y * y,
                slope_x * slope_x + slope_y * slope_y,
                (m.x * dm.y - m.y * dm.x) * (inverse_z * inverse_z * inverse_x_ * inverse_y_)};
    }

    /// A great circle has one point nearest to the mirror direction, which is close to the nearest in slopes.
    MICA_HOST_DEVICE constexpr graded_arc graded_edge(const circle_arc<Real>& arc) const {
        const Real nearest = radians_of(dot(arc.second, mirror_), dot(arc.first, mirror_));
        return graded(arc, clamp(nearest, -arc.reach, arc.reach));
    }

    /// A quarter of a rim may come near twice: the search starts from the best of a few points.
    MICA_HOST_DEVICE constexpr graded_arc graded_rim(const circle_arc<Real>& arc) const {
        Real best = Real(0), least = slopes_at(arc, best).q;
        for (const float part : {-1.F, -0.5F, 0.5F, 1.F}) {
            const Real phi = Real(part) * arc.reach, q = slopes_at(arc, phi).q;
            best = select(q < least, phi, best);
            least = minimum(q, least);
        }
        return graded(arc, best);
    }

    /// Graded towards the point nearest to the origin in slopes, by two Gauss-Newton steps from phi.
    MICA_HOST_DEVICE constexpr graded_arc graded(const circle_arc<Real>& arc, Real phi) const {
        auto at = slopes_at(arc, phi);
        const auto speed_squared = [&at] { return maximum(at.dx * at.dx + at.dy * at.dy, Real(1e-20F)); };
        for (int i = 0; i < 2; ++i) {
            const Real step = clamp((at.x * at.dx + at.y * at.dy) / speed_squared(), Real(-1), Real(1));
            phi = clamp(phi - step, -arc.reach, arc.reach);
            at = slopes_at(arc, phi);
        }
        const Real width = clamp(mica::sqrt((Real(1) + at.q) / speed_squared()), Real(1e-5F), Real(2));
        const Real start = inverse_sinh((-arc.reach - phi) / width), end = inverse_sinh((arc.reach - phi) / width);
        return {arc.turned(phi), width, start, end, at.q};
    }

    /// F / q (X dY - Y dX) / dx; with `beyond`, F - F(infinity) for F.
    MICA_HOST_DEVICE constexpr Real integrand(const graded_arc& graded, Real x, const mask_of<Real>& beyond) const {
        const Real growth = mica::exp(x), decay = Real(1) / growth, half_width = Real(0.5F) * graded.width;
        const auto at = slopes_at(graded.arc, half_width * (growth - decay));
        const Real a2 = clamp(at.t / maximum(at.q, Real(1e-20F)), least_, most_);
        const Real w = mica::sqrt(Real(1) + at.t);
        using shape = typename Facets::shape;
        Real f = Real(0);
        if (!all(beyond)) f = shape::within_over_square(a2, at.q, w);
        if (any(beyond)) f = select(beyond, -shape::beyond(a2, at.q, w) / maximum(at.q, Real(1e-20F)), f);
        return f * at.turning * (half_width * (growth + decay));
    }

    /// An integral over part of an arc, and the difference of two rules for it.
    struct estimate {
        Real value, difference;
    };

    /// From one fraction of x to another.
    MICA_HOST_DEVICE constexpr estimate integral(const graded_arc& graded, float from, float to,
                                                 const mask_of<Real>& beyond) const {
        const Real length = graded.end - graded.start;
        const Real reach = Real(0.5F * (to - from)) * length, middle = graded.start + Real(0.5F * (to + from)) * length;
        const Real centre = integrand(graded, middle, beyond);
        constexpr gauss_kronrod rule{}; // here, since a GPU sees no static arrays
        Real kronrod = Real(rule.kronrod[7]) * centre, gauss = Real(rule.gauss[3]) * centre;
        for (int i = 0; i < 7; ++i) {
            const Real away = Real(rule.node[i]) * reach;
            const Real both = integrand(graded, middle - away, beyond) + integrand(graded, middle + away, beyond);
            kronrod = kronrod + Real(rule.kronrod[i]) * both;
            if (i % 2 == 1) gauss = gauss + Real(rule.gauss[i / 2]) * both;
        }
        return {reach * kronrod, abs(reach * (kronrod - gauss))};
    }

    /// The whole arc, halved where the difference is too large. Every lane takes the parts that it would take alone.
    MICA_HOST_DEVICE constexpr Real refined(const graded_arc& graded, estimate whole, Real allowed,
                                            const mask_of<Real>& beyond) const {
        const auto rough = whole.difference > allowed;
        Real value = select(rough, Real(0), whole.value), done = select(rough, Real(0), Real(1));
        int depth = 1, index = 0; // part number `index` of 2^depth
        while (any(done < Real(1))) {
            const float length = 1.F / static_cast<float>(1 << depth), from = static_cast<float>(index) * length;
            const auto open = done <= Real(from);
            if (any(open)) {
                const auto part = integral(graded, from, from + length, beyond);
                const auto enough =
                    open && ((part.difference <= allowed) || (Real(static_cast<float>(depth)) >= Real(most_halvings)));
                value = value + select(enough, part.value, Real(0));
                done = select(enough, Real(from + length), done);
                if (any(open && !enough)) {
                    ++depth;
                    index *= 2;
                    continue;
                }
            }
            for (++index; index % 2 == 0; index /= 2) --depth; // the next part, at the depth where it begins
        }
        return value;
    }

    template <std::size_t Count>
    MICA_HOST_DEVICE constexpr Real area(const std::array<graded_arc, Count>& arcs, const mask_of<Real>& inside) const {
        Real nearest = Real(1e30F);
        for (const auto& graded : arcs)
            nearest = minimum(nearest, select(graded.end > graded.start, graded.nearest, Real(1e30F)));
        const auto beyond = nearest > Real(1);
        const Real enclosed = select(beyond && inside, total_, Real(0));

        std::array<estimate, Count> whole{};
        Real sum = Real(2 * pi_float) * enclosed, size = Real(0);
        for (std::size_t i = 0; i < Count; ++i) {
            if (any(arcs[i].end > arcs[i].start)) whole[i] = integral(arcs[i], 0, 1, beyond);
            sum = sum + whole[i].value;
            size = size + abs(whole[i].value);
        }
        const Real allowed = Real(tolerance) * maximum(abs(sum), Real(1e-3F) * size); // size: what binary32 can resolve
        sum = Real(0);
        for (std::size_t i = 0; i < Count; ++i) sum = sum + refined(arcs[i], whole[i], allowed, beyond);
        return clamp(enclosed + Real(0.5F / pi_float) * sum, Real(0), total_);
    }

    Real total_;
    Real inverse_x_{}, inverse_y_{}; ///< of the roughnesses
    Real least_{}, most_{};          ///< squared roughness
    vector3<Real> wo_, mirror_;
};

} // namespace mica::detail
