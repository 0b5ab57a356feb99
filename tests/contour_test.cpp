// The facet area inside a light's contour (shade/contour_area.hpp) against the same integral in binary64, taken in many pieces
// by Boost's adaptive rule. That the integral is the right one, lights_test.cpp shows by plain sums over the lights.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <gtest/gtest.h>

#include <mica/numeric/pack.hpp>
#include <mica/shade/lights.hpp>

namespace {

using direction = mica::vector3<float>;
using exact_vector = mica::vector3<double>;
constexpr double pi = std::numbers::pi;

exact_vector exact(direction v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// Facets of two roughnesses seen from wo.
struct plain_facets {
    bool beckmann;
    double roughness_x, roughness_y;
    exact_vector wo;

    double within_over_square(double a2, double q, double w) const {
        return beckmann ? mica::detail::beckmann_shape::within_over_square(a2, q, w)
                        : mica::detail::ggx_shape::within_over_square(a2, q, w);
    }

    /// Of F d psi along a curve of directions, curve(s, l, dl / ds), s from `from` to `to`.
    template <class Curve>
    double integral(const Curve& curve, double from, double to) const {
        const auto integrand = [&](double s) {
            exact_vector l, dl;
            curve(s, l, dl);
            const double length = std::sqrt(dot(l, l));
            const exact_vector m = l + length * wo, dm = dl + dot(l, dl) / length * wo;
            const double x = m.x / m.z, y = m.y / m.z, t = x * x + y * y;
            const double q = std::pow(x / roughness_x, 2) + std::pow(y / roughness_y, 2);
            const double a2 = q > 0 ? std::min(t / q, 1.) : roughness_x * roughness_y;
            return within_over_square(a2, q, std::sqrt(1 + t)) * (m.x * dm.y - m.y * dm.x) /
                   (m.z * m.z * roughness_x * roughness_y);
        };
        constexpr int pieces = 64;
        const double step = (to - from) / pieces;
        double sum = 0;
        for (int i = 0; i < pieces; ++i)
            sum += boost::math::quadrature::gauss_kronrod<double, 31>::integrate(integrand, from + i * step,
                                                                                 from + (i + 1) * step, 12, 1e-8);
        return sum;
    }

    double along_edge(exact_vector a, exact_vector b) const {
        const exact_vector start = mica::normalized(a), normal = mica::normalized(cross(a, b));
        const exact_vector side = cross(normal, start);
        return integral(
            [&](double s, exact_vector& l, exact_vector& dl) {
                l = std::cos(s) * start + std::sin(s) * side;
                dl = std::cos(s) * side - std::sin(s) * start;
            },
            0, std::atan2(dot(b, side), dot(b, start)));
    }

    double along_horizon(exact_vector a, exact_vector b) const {
        const double from = std::atan2(a.y, a.x);
        double to = std::atan2(b.y, b.x);
        while (to < from) to += 2 * pi;
        return integral(
            [](double s, exact_vector& l, exact_vector& dl) {
                l = {std::cos(s), std::sin(s), 0};
                dl = {-std::sin(s), std::cos(s), 0};
            },
            from, to);
    }

    double area_of_polygon(const std::array<exact_vector, 4>& corners) const {
        std::vector<exact_vector> kept; // above the horizon or on it
        for (std::size_t i = 0; i < 4; ++i) {
            const auto &a = corners[i], &b = corners[(i + 1) % 4];
            if (a.z >= 0) kept.push_back(a);
            if ((a.z < 0) != (b.z < 0)) {
                kept.push_back(a + a.z / (a.z - b.z) * (b - a));
                kept.back().z = 0;
            }
        }
        double sum = 0;
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const auto &a = kept[i], &b = kept[(i + 1) % kept.size()];
            sum += a.z == 0 && b.z == 0 ? along_horizon(a, b) : along_edge(a, b);
        }
        return sum / (2 * pi);
    }

    /// With a normal that points away from the surface.
    double area_of_disk(exact_vector centre, exact_vector normal, double radius) const {
        const exact_vector u = mica::normalized(cross(normal, exact_vector{0.3, -0.7, 0.2})), v = cross(normal, u);
        const auto rim = [&](double s, exact_vector& l, exact_vector& dl) {
            l = centre + radius * std::cos(s) * u + radius * std::sin(s) * v;
            dl = radius * std::cos(s) * v - radius * std::sin(s) * u;
        };
        const double height = radius * std::hypot(u.z, v.z), top = std::atan2(v.z, u.z);
        if (centre.z >= height) return integral(rim, 0, 2 * pi) / (2 * pi);
        if (centre.z <= -height) return 0;
        const double half = std::acos(-centre.z / height);
        exact_vector out, in, unused;
        rim(top + half, out, unused);
        rim(top - half, in, unused);
        return (integral(rim, top - half, top + half) + along_horizon(out, in)) / (2 * pi);
    }
};

/// A surface and two lights around the mirror direction, near and far, small and large, some cut by the horizon.
struct scene {
    mica::shading_point<float> point{};
    float roughness_x, roughness_y;
    mica::rectangle_light rectangle;
    mica::disk_light disk;

    bool lit() const { return dot(disk.centre, disk.normal) < 0; }

    /// n.v between the two; roughnesses in a ratio up to the given.
    scene(std::mt19937& random, float least_cosine, float most_cosine, float ratio) {
        const auto unit = [&random] { return std::uniform_real_distribution<float>(0, 1)(random); };
        const auto between = [&](float low, float high) { return low * std::pow(high / low, unit()); };
        const auto any = [&] {
            direction d{};
            for (float* const x : {&d.x, &d.y, &d.z}) *x = unit() - 0.5F;
            return d;
        };
        roughness_x = between(0.02F, 1);
        roughness_y = roughness_x / between(0.5F * ratio, ratio);
        if (ratio == 1) roughness_y = roughness_x;
        if (unit() < 0.5F) std::swap(roughness_x, roughness_y);
        const float cosine = between(least_cosine, most_cosine), sine = std::sqrt(1 - cosine * cosine);
        const float azimuth = 2 * static_cast<float>(pi) * unit();
        point.normal = {0, 0, 1};
        point.tangent = {1, 0, 0};
        point.wo = {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};

        const float aside = 1.5F * unit();
        const auto centre = 3.F * mica::normalized(direction{-point.wo.x, -point.wo.y, point.wo.z} + aside * any());
        const float size = between(0.1F, 4), aspect = between(0.05F, 1);
        const auto normal = mica::normalized(-0.4F * centre + any());
        const auto u = mica::normalized(cross(normal, direction{0.3F, 0.5F, 0.8F})), v = cross(normal, u);
        rectangle = {centre, size * u, aspect * size * v, {1, 1, 1}};
        disk = {centre, normal, size, {1, 1, 1}};
    }
};

const mica::microfacet_table& table() {
    static const mica::microfacet_table built;
    return built;
}

/// Relative errors of p, from the smallest.
struct errors {
    std::vector<double> rectangle, disk;

    template <class Facets>
    void add(const scene& seen, const Facets& facets, bool beckmann) {
        const plain_facets plain{beckmann, static_cast<double>(seen.roughness_x), static_cast<double>(seen.roughness_y),
                                 exact(seen.point.wo)};
        const auto facet_area = static_cast<double>(facets.facet_area());
        const auto error = [&](const auto& light, double area) {
            const double expected = area / facet_area;
            const auto p = static_cast<double>(respond(light, seen.point, facets, {1, 1, 1}, table()).probability);
            return std::abs(p - expected) / (expected + 1e-6);
        };
        const auto centre = exact(seen.rectangle.centre), u = exact(seen.rectangle.half_u),
                   v = exact(seen.rectangle.half_v);
        rectangle.push_back(error(
            seen.rectangle, plain.area_of_polygon({centre - u - v, centre - u + v, centre + u + v, centre + u - v})));
        disk.push_back(error(seen.disk, plain.area_of_disk(centre, -1. * exact(seen.disk.normal),
                                                           static_cast<double>(seen.disk.radius))));
    }
};

double part_of(std::vector<double> values, double part) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

constexpr int surfaces = 250;

TEST(ContourArea, AgreesWithBinary64) {
    std::printf("relative error of p%28s: median, 99 %%, largest\n", "");
    std::mt19937 random(7);
    for (const float ratio : {1.F, 4.F, 10.F})
        for (const auto& cosines : {std::pair{0.4F, 1.F}, {0.15F, 0.4F}, {0.05F, 0.15F}}) {
            errors found;
            for (int i = 0; i < surfaces; ++i) {
                const scene seen(random, cosines.first, cosines.second, ratio);
                if (!seen.lit()) continue;
                found.add(seen, mica::ggx<float>{seen.roughness_x, seen.roughness_y}, false);
                found.add(seen, mica::beckmann<float>{seen.roughness_x, seen.roughness_y}, true);
            }
            const auto check = [&](const char* name, const std::vector<double>& values) {
                std::printf("%-9s n.v %4.2f to %4.2f, roughnesses 1:%-2g: %7.1e %7.1e %7.1e\n", name,
                            static_cast<double>(cosines.first), static_cast<double>(cosines.second),
                            static_cast<double>(ratio), part_of(values, 0.5), part_of(values, 0.99),
                            part_of(values, 1));
                EXPECT_GT(values.size(), 400U);
                EXPECT_LE(part_of(values, 0.5), 5e-6);
                EXPECT_LE(part_of(values, 0.99), ratio > 4 ? 5e-3 : 1e-3);
                if (ratio == 1) {
                    EXPECT_LE(part_of(values, 1), 1e-2);
                }
            };
            check("rectangle", found.rectangle);
            check("disk", found.disk);
        }
}

// Lanes that need fewer parts of an arc than others wait; they take no other parts than alone.
TEST(ContourArea, LanesDoNotDisturbEachOther) {
    using pack = mica::pack<float, 4>;
    std::mt19937 random(11);
    for (int round = 0; round < 100; ++round) {
        std::vector<scene> scenes;
        for (int i = 0; i < 4; ++i) scenes.emplace_back(random, 0.05F, 1.F, 4.F);
        mica::shading_point<pack> point{};
        mica::ggx<pack> facets{};
        for (int i = 0; i < 4; ++i) {
            const auto& seen = scenes[static_cast<std::size_t>(i)];
            set_lane(point.normal.z, i, 1.F);
            set_lane(point.tangent.x, i, 1.F);
            set_lane(point.wo.x, i, seen.point.wo.x);
            set_lane(point.wo.y, i, seen.point.wo.y);
            set_lane(point.wo.z, i, seen.point.wo.z);
            set_lane(facets.roughness_x, i, seen.roughness_x);
            set_lane(facets.roughness_y, i, seen.roughness_y);
        }
        const auto compare = [&](const auto& light) {
            const auto together = respond(light, point, facets, {1, 1, 1}, table()).probability;
            for (int i = 0; i < 4; ++i) {
                const auto& seen = scenes[static_cast<std::size_t>(i)];
                const mica::ggx<float> own{seen.roughness_x, seen.roughness_y};
                const float alone = respond(light, seen.point, own, {1, 1, 1}, table()).probability;
                EXPECT_NEAR(lane(together, i), alone, 2e-4F * alone + 1e-7F) << round << ' ' << i;
            }
        };
        compare(scenes[0].rectangle);
        compare(scenes[0].disk);
    }
}

} // namespace
