// Distributions of facet normals, and what lights do in a pixel, against plain sums in binary64 that share no formula with them.

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/quantile.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/shade/glint_kernel.hpp>
#include <mica/shade/lights.hpp>

#include "statistics.hpp"

namespace {

using colour = mica::rgb<float>;
using direction = mica::vector3<float>;
using exact_vector = mica::vector3<double>;
constexpr double pi = std::numbers::pi;

exact_vector exact(direction v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

const mica::microfacet_table& table() {
    static const mica::microfacet_table built;
    return built;
}

/// A point at the origin whose normal is z.
mica::shading_point<float> seen_from(float theta, float phi = 0) {
    mica::shading_point<float> point{};
    point.normal = {0, 0, 1};
    point.tangent = {1, 0, 0};
    point.wo = {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    return point;
}

/// Facets of two roughnesses, in binary64.
struct plain_facets {
    bool beckmann;
    double x, y;

    double density(exact_vector h) const {
        if (!(h.z > 0)) return 0;
        const double p = h.x / h.z / x, q = h.y / h.z / y, slope = p * p + q * q;
        const double shape = beckmann ? std::exp(-slope) : 1 / ((1 + slope) * (1 + slope));
        return shape / (pi * x * y * std::pow(h.z, 4));
    }

    /// The integral of D times a function over the hemisphere, by slopes.
    template <class Function>
    double integral(const Function& function) const {
        constexpr int rings = 4000, spokes = 64;
        double sum = 0;
        for (int i = 0; i < rings; ++i) {
            const double t = (i + 0.5) / rings, u = 1 - (1 - t) * (1 - t); // finer towards the horizon
            const double slope = std::sqrt(beckmann ? -std::log1p(-u) : u / (1 - u));
            for (int j = 0; j < spokes; ++j) {
                const double azimuth = 2 * pi * (j + 0.5) / spokes;
                const double p = x * slope * std::cos(azimuth), q = y * slope * std::sin(azimuth);
                const double w = std::sqrt(1 + p * p + q * q);
                sum += 2 * (1 - t) * w * function(exact_vector{p / w, q / w, 1 / w});
            }
        }
        return sum / (rings * spokes);
    }
};

/// Calls body(facets of the library, the same plain), both distributions.
template <class Body>
void for_both(float x, float y, const Body& body) {
    body(mica::ggx<float>{x, y}, plain_facets{false, static_cast<double>(x), static_cast<double>(y)});
    body(mica::beckmann<float>{x, y}, plain_facets{true, static_cast<double>(x), static_cast<double>(y)});
}

// --- distributions ----------------------------------------------------------------------------------------------

TEST(Distributions, DensityAndArea) {
    for (const auto& roughness :
         {std::pair{0.02F, 0.02F}, {0.1F, 0.1F}, {0.6F, 0.6F}, {1.F, 1.F}, {0.05F, 0.5F}, {0.9F, 0.2F}}) {
        const float x = roughness.first, y = roughness.second;
        for_both(x, y, [&](const auto& facets, const plain_facets& plain) {
            const double area = plain.integral([](exact_vector) { return 1.; });
            EXPECT_NEAR(static_cast<double>(facets.facet_area()), area, 2e-4 * area) << x << ' ' << y << plain.beckmann;
            for (const direction h : {direction{0, 0, 1}, {0.1F, 0.02F, 1}, {0.3F, -0.6F, 0.8F}, {1, 1, 0.1F}}) {
                const auto unit = mica::normalized(h);
                const double density = plain.density(exact(unit));
                EXPECT_NEAR(static_cast<double>(facets.density(unit)), density, 1e-4 * density + 1e-12);
            }
            EXPECT_EQ(facets.density({0.6F, 0, -0.8F}), 0);
            // Facets seen from above cover the surface once: the integral of D n.h is 1, by a sum over directions.
            double covered = 0;
            constexpr int rings = 3000, spokes = 90;
            for (int i = 0; i < rings; ++i) {
                const double tangent = 30 * std::pow((i + 0.5) / rings, 3),
                             step = 90 * std::pow((i + 0.5) / rings, 2) / rings;
                const double c = 1 / std::sqrt(1 + tangent * tangent);
                for (int j = 0; j < spokes; ++j) {
                    const double azimuth = 2 * pi * (j + 0.5) / spokes, s = tangent * c;
                    const direction h{static_cast<float>(s * std::cos(azimuth)),
                                      static_cast<float>(s * std::sin(azimuth)), static_cast<float>(c)};
                    covered += static_cast<double>(facets.density(h)) * c * s * c * c * step * 2 * pi / spokes;
                }
            }
            EXPECT_NEAR(covered, 1, 5e-3) << x << ' ' << y << plain.beckmann;
        });
    }
}

// The square of 1/cos^2 outgrows the exponential: D(h) / D(n) = exp(-t) (1+t)^2 has its largest value 4 / e at t = 1.
TEST(Distributions, BeckmannIsLargestAsideAtRoughnessOne) {
    const mica::beckmann<float> rough{1, 1};
    float largest = 0;
    for (int i = 0; i < 1000; ++i) {
        const float theta = 1.57F * static_cast<float>(i) / 1000;
        largest = std::max(largest, rough.relative_density({std::sin(theta), 0, std::cos(theta)}));
    }
    EXPECT_NEAR(largest, 1.4715F, 1e-3F);
}

TEST(Distributions, MaskingIsSmiths) {
    for (const float theta : {0.F, 0.5F, 1.2F, 1.5F}) {
        const auto w = seen_from(theta, 0.3F).wo;
        const direction back{-w.x, -w.y, w.z};
        EXPECT_NEAR((mica::ggx<float>{0.3F, 0.3F}.masking_shadowing(w, back)),
                    mica::ggx_masking_shadowing(w.z, w.z, 0.3F), 1e-5F);
        // Lambda of Beckmann with the error function (Walter et al. 2007, Eq. 22): (erf(c) - 1) / 2 + exp(-c^2) / (2 c sqrt pi)
        const double c = 1 / (0.3 * std::tan(static_cast<double>(theta)));
        const double lambda = (std::erf(c) - 1) / 2 + std::exp(-c * c) / (2 * c * std::sqrt(pi));
        const float fit = mica::beckmann<float>{0.3F, 0.3F}.lambda(w);
        EXPECT_NEAR(1 / (1 + static_cast<double>(fit)), 1 / (1 + lambda), 4e-3) << theta;
    }
}

// --- area lights ------------------------------------------------------------------------------------------------

/// A light given by points: the sum over its area of D(h) / (4 wo.h) d omega: facet area.
template <class Light, class Points>
double plain_area(const Light& light, const plain_facets& facets, direction wo, const Points& points) {
    double sum = 0;
    points(light, [&](exact_vector at, exact_vector normal, double area) {
        const double square = dot(at, at);
        const exact_vector l = (1 / std::sqrt(square)) * at;
        const double facing = -dot(l, normal);
        if (!(facing > 0 && l.z > 0)) return;
        const exact_vector h = mica::normalized(l + exact(wo));
        sum += facets.density(h) / (4 * dot(h, exact(wo))) * area * facing / square;
    });
    return sum;
}

constexpr int side = 300;

constexpr auto points_of_rectangle = [](const mica::rectangle_light& light, const auto& body) {
    const auto u = exact(light.half_u), v = exact(light.half_v), normal = cross(u, v);
    const double length = std::sqrt(dot(normal, normal));
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            body(exact(light.centre) + ((2 * i + 1.) / side - 1) * u + ((2 * j + 1.) / side - 1) * v,
                 (1 / length) * normal, 4 * length / (side * side));
};

constexpr auto points_of_disk = [](const mica::disk_light& light, const auto& body) {
    const auto normal = exact(light.normal);
    const auto first = mica::normalized(cross(normal, exact_vector{0.3, -0.7, 0.2})), second = cross(normal, first);
    const auto radius = static_cast<double>(light.radius);
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const double r = radius * std::sqrt((i + 0.5) / side), azimuth = 2 * pi * (j + 0.5) / side;
            body(exact(light.centre) + r * std::cos(azimuth) * first + r * std::sin(azimuth) * second, normal,
                 pi * radius * radius / (side * side));
        }
};

/// Lights near the mirror direction and far from it, small and large, some cut by the horizon.
TEST(AreaLights, ProbabilityIsTheFacetAreaOfTheirHalfVectors) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    const auto between = [&](float low, float high) { return low * std::pow(high / low, unit(random)); };
    const auto any = [&] { return direction{unit(random) - 0.5F, unit(random) - 0.5F, unit(random) - 0.5F}; };
    double largest_round = 0, largest_stretched = 0;
    int cut = 0, enclosing = 0;
    for (int i = 0; i < 60; ++i) {
        const bool round = i % 3 != 0;
        const float x = between(0.05F, 1), y = round ? x : x * between(0.25F, 1);
        const float theta = 1.4F * unit(random), phi = 6.28F * unit(random);
        const auto point = seen_from(theta, phi);
        const direction mirror{-point.wo.x, -point.wo.y, point.wo.z};
        const float aside = 1.5F * unit(random);
        const auto centre = 3.F * mica::normalized(mirror + aside * any());
        const float size = between(0.2F, 4);
        const auto normal = mica::normalized(-0.4F * centre + any());
        const auto u = mica::normalized(cross(normal, direction{0.3F, 0.5F, 0.8F})), v = cross(normal, u);
        const mica::rectangle_light rectangle{centre, size * u, 0.6F * size * v, {1, 1, 1}};
        const mica::disk_light disk{centre, normal, size, {1, 1, 1}};
        cut += centre.z < size;
        enclosing += dot(mica::normalized(centre), mirror) > 0.99F;
        for_both(x, y, [&](const auto& facets, const plain_facets& plain) {
            const double facet_area = plain.integral([](exact_vector) { return 1.; });
            const auto check = [&](const auto& light, const auto& points, const char* what) {
                const double expected = plain_area(light, plain, point.wo, points) / facet_area;
                const auto p = static_cast<double>(respond(light, point, facets, {1, 1, 1}, table()).probability);
                const double error = std::abs(p - expected) / (expected + 1e-4);
                double& largest = round ? largest_round : largest_stretched;
                largest = std::max(largest, error);
                EXPECT_LE(error, 0.005) << what << ' ' << i << ": roughness " << x << ' ' << y << ", beckmann "
                                        << plain.beckmann << ", size " << size << ": " << p << ' ' << expected;
            };
            check(rectangle, points_of_rectangle, "rectangle");
            check(disk, points_of_disk, "disk");
        });
    }
    std::printf("largest relative error of p: %.2g, with two roughnesses %.2g\n", largest_round, largest_stretched);
    EXPECT_GT(cut, 5);
    EXPECT_GT(enclosing, 5);
}

// A light around everything: all facets that reflect to above the horizon flash, and all that the albedo says is reflected.
TEST(AreaLights, WhiteFurnace) {
    const mica::rectangle_light sky{{0, 0, 1}, {0, 1e4F, 0}, {1e4F, 0, 0}, {1, 1, 1}};
    for (const float roughness : {0.F, 0.01F, 0.1F, 0.5F, 1.F})
        for (const float theta : {0.F, 0.4F, 0.8F, 1.2F, 1.45F}) {
            const auto point = seen_from(theta, 0.2F * theta);
            const auto response = respond(sky, point, mica::ggx<float>{roughness, roughness}, {1, 1, 1}, table());
            const auto albedo = table().albedo(point.wo.z, roughness);
            EXPECT_NEAR(response.probability, table().visible_fraction(point.wo.z, roughness), 2e-3F)
                << roughness << theta;
            EXPECT_NEAR(response.smooth.g, albedo.scale + albedo.bias, 2e-3F) << roughness << ' ' << theta;
            for_both(roughness, 0.7F * roughness, [&](const auto& facets, const plain_facets&) {
                const auto stretched = respond(sky, point, facets, {1, 1, 1}, table());
                EXPECT_GT(stretched.probability, 0.25F);
                EXPECT_LE(stretched.probability, 1.001F);
            });
        }
}

// --- sun and directional light ----------------------------------------------------------------------------------

// A sun is a far disk.
TEST(Sun, IsAFarDisk) {
    const auto point = seen_from(0.6F, 0.2F);
    for (const float aside : {0.F, 0.3F, 0.8F}) {
        const auto towards = mica::normalized(direction{-point.wo.x + aside, -point.wo.y, point.wo.z});
        const float half_angle = 0.01F;
        const mica::sun_light sun{towards, {1, 1, 1}, half_angle};
        const mica::disk_light disk{100.F * towards, -1.F * towards, 100 * std::tan(half_angle), {1, 1, 1}};
        for_both(0.3F, 0.3F, [&](const auto& facets, const plain_facets& plain) {
            const auto far = respond(disk, point, facets, {1, 1, 1}, table());
            const auto near = respond(sun, point, facets, {1, 1, 1}, table());
            EXPECT_NEAR(near.probability / far.probability, 1, plain.beckmann ? 0.03 : 0.01) << aside;
            EXPECT_GT(dot(near.half_vector, far.half_vector), 0.9999F);
        });
    }
}

TEST(Sun, OfANarrowLobeEveryFacetFlashes) {
    const mica::sun_light sun{{0, 0, 1}, {1, 1, 1}};
    const auto p = [&](float roughness) {
        return respond(sun, seen_from(0), mica::ggx<float>{roughness, roughness}, {1, 1, 1}).probability;
    };
    EXPECT_EQ(p(0.001F), 1); // 5.3 without the limit
    // Omega D(n) / 4 / D_H with Omega = pi half_angle^2 and D(n) = 1 / (pi alpha^2)
    const float expected = 0.00465F * 0.00465F / 4 / 0.01F / 0.01F / mica::total_facet_area(0.01F);
    EXPECT_NEAR(p(0.01F), expected, 1e-3F * expected);
}

TEST(Directional, ProbabilityIsTheRelativeDensity) {
    const auto point = seen_from(0.5F);
    const auto towards = mica::normalized(direction{0.2F, 0.3F, 1});
    const mica::ggx<float> facets{0.4F, 0.2F};
    const auto h = mica::normalized(towards + point.wo);
    for (const float fraction : {1.F, 0.25F}) {
        const auto response =
            respond(mica::directional_light{towards, {2, 1, 0.5F}, fraction}, point, facets, {0.5F, 0.5F, 0.5F});
        EXPECT_FLOAT_EQ(response.probability, fraction * facets.relative_density(h));
        // The radiance is that of the smooth BRDF whatever the fraction.
        const float brdf = facets.density(h) * facets.masking_shadowing(towards, point.wo) *
                           mica::schlick_fresnel(0.5F, dot(towards, h)) / (4 * towards.z * point.wo.z);
        EXPECT_NEAR(response.smooth.r, 2 * brdf * towards.z, 1e-4F * response.smooth.r);
        EXPECT_NEAR(response.smooth.b, 0.5F * brdf * towards.z, 1e-4F * response.smooth.b);
    }
    const mica::beckmann<float> rough{1, 1};
    for (float angle = 0; angle < 1.5F; angle += 0.1F)
        EXPECT_LE(respond(mica::directional_light{seen_from(angle).wo, {1, 1, 1}}, point, rough, {1, 1, 1}).probability,
                  1);
}

// --- everywhere -------------------------------------------------------------------------------------------------

/// Calls body(light) with a light of each kind in a direction.
template <class Body>
void for_each_light(direction towards, const Body& body) {
    const auto side_of = mica::normalized(cross(towards, direction{0.1F, 0.9F, 0.2F}));
    body(mica::directional_light{towards, {1, 2, 3}});
    body(mica::sun_light{towards, {100, 200, 300}});
    body(mica::rectangle_light{3.F * towards, side_of, cross(side_of, -1.F * towards), {1, 2, 3}});
    body(mica::disk_light{3.F * towards, -1.F * towards, 0.7F, {1, 2, 3}});
}

TEST(Lights, AreFiniteEverywhere) {
    for (const float theta : {0.F, 0.8F, 1.57F, 1.6F, 2.5F})
        for (const float from : {0.F, 0.7F, 1.55F, 1.6F, 3.F})
            for (const float roughness : {0.F, 1e-4F, 0.01F, 1.F})
                for_each_light(seen_from(from, 2).wo, [&](const auto& light) {
                    for_both(roughness, 0.5F * roughness, [&](const auto& facets, const plain_facets&) {
                        const auto response = respond(light, seen_from(theta), facets, {0.5F, 0.5F, 0.5F}, table());
                        EXPECT_TRUE(response.probability >= 0 && response.probability <= 1)
                            << theta << from << roughness;
                        EXPECT_TRUE(response.smooth.r >= 0 && std::isfinite(response.smooth.b))
                            << theta << from << roughness;
                        EXPECT_TRUE(std::isfinite(response.half_vector.x));
                        if (theta > 1.58F) {
                            EXPECT_EQ(response.probability, 0);
                            EXPECT_EQ(response.smooth.r, 0);
                        }
                    });
                });
    // In the plane of a light it is dark, wherever it lies.
    for (float turn = 0; turn < 6; turn += 0.01F) {
        const direction u{std::cos(turn), std::sin(turn), 0.5F},
            v = mica::normalized(cross(u, direction{0.3F, -0.2F, 0.7F}));
        const direction away = mica::normalized(cross(u, v)), centre = 3.F * u + 0.7F * v;
        const mica::ggx<float> rough{0.5F, 0.5F};
        EXPECT_EQ(respond(mica::rectangle_light{centre, u, v, {1, 1, 1}}, seen_from(0.5F), rough, {1, 1, 1}, table())
                      .probability,
                  0);
        EXPECT_EQ(respond(mica::disk_light{centre, away, 1, {1, 1, 1}}, seen_from(0.5F), rough, {1, 1, 1}, table())
                      .probability,
                  0);
    }
    // Behind a rectangle and a disk it is dark.
    const auto point = seen_from(0);
    const mica::ggx<float> facets{0.3F, 0.3F};
    EXPECT_EQ(
        respond(mica::rectangle_light{{0, 0, 2}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}}, point, facets, {1, 1, 1}, table())
            .smooth.r,
        0);
    EXPECT_EQ(respond(mica::disk_light{{0, 0, 2}, {0, 0, 1}, 1, {1, 1, 1}}, point, facets, {1, 1, 1}, table()).smooth.r,
              0);
}

TEST(Lights, PacksEqualScalars) {
    using wide = mica::pack<float, 8>;
    mica::shading_point<wide> eight{};
    eight.normal = {wide(0), wide(0), wide(1)};
    eight.tangent = {wide(1), wide(0), wide(0)};
    std::array<mica::shading_point<float>, 8> points;
    for (int i = 0; i < 8; ++i) {
        const auto lane = static_cast<std::size_t>(i);
        points[lane] = seen_from(0.19F * static_cast<float>(i), static_cast<float>(i));
        mica::set_lane(eight.wo.x, i, points[lane].wo.x);
        mica::set_lane(eight.wo.y, i, points[lane].wo.y);
        mica::set_lane(eight.wo.z, i, points[lane].wo.z);
    }
    for_each_light(seen_from(0.9F, 0.4F).wo, [&](const auto& light) {
        const auto together =
            respond(light, eight, mica::ggx<wide>{wide(0.3F), wide(0.2F)}, {0.5F, 0.6F, 0.7F}, table());
        for (int i = 0; i < 8; ++i) {
            const auto alone = respond(light, points[static_cast<std::size_t>(i)], mica::ggx<float>{0.3F, 0.2F},
                                       {0.5F, 0.6F, 0.7F}, table());
            EXPECT_NEAR(mica::lane(together.probability, i), alone.probability, 1e-5F * alone.probability + 1e-7F);
            EXPECT_NEAR(mica::lane(together.smooth.b, i), alone.smooth.b, 1e-5F * alone.smooth.b + 1e-7F);
        }
    });
}

// --- the kernel under them --------------------------------------------------------------------------------------

using kernel = mica::glint_kernel<mica::quantile_binomial<4>>;

template <class Light>
statistics::running_moments ratios(const Light& light, float roughness, float trials, int pixels, float aside) {
    statistics::running_moments sums;
    constexpr float width = 0x1p-10F;
    mica::glint_material material;
    material.roughness = roughness;
    material.log_density = std::log(trials / (width * width));
    auto point = seen_from(0.7F + aside);
    point.derivatives = {width, 0, 0, width};
    const auto response = respond(light, point, mica::ggx<float>{roughness, roughness}, material.f0, table());
    const std::array<mica::light_class<float>, 1> one{{{response.smooth, response.probability}}};
    for (int i = 0; i < pixels; ++i) {
        // Far apart, so that no two share a cell.
        point.uv = {static_cast<float>(i % 256) / 256, static_cast<float>(i / 256 % 256) / 256};
        const auto seed = static_cast<std::uint32_t>(i / 65536);
        sums.add(static_cast<double>(kernel{}(point, material, one, response.half_vector, seed).glint.g /
                                     response.smooth.g));
    }
    return sums;
}

// KK25 Fig. 14: no bands, and the smooth surface where facets are many. p from 1e-4 down to 1e-12, N up to 1e12.
TEST(Sun, ManyFacetsAreSmooth) {
    const mica::sun_light sun{seen_from(0.7F, 3.14159265F).wo, {1, 1, 1}};
    const auto point_probability = [&](float aside) {
        return respond(sun, seen_from(0.7F + aside), mica::ggx<float>{0.04F, 0.04F}, {1, 1, 1}).probability;
    };
    EXPECT_LT(point_probability(0.8F), 1e-6F);
    for (const float aside : {0.F, 0.1F, 0.2F, 0.4F, 0.8F}) {
        const double p = static_cast<double>(point_probability(aside));
        for (const float trials : {1e8F, 1e10F, 1e12F}) {
            const auto seen = ratios(sun, 0.04F, trials, 4096, aside);
            const double deviation = 1 / std::sqrt(static_cast<double>(trials) * p);
            EXPECT_NEAR(seen.mean(), 1, 4.5 * seen.standard_error() + 1e-3) << aside << ' ' << trials;
            if (deviation < 0.2) {
                EXPECT_NEAR(std::sqrt(seen.variance()), deviation, 0.1 * deviation) << aside << ' ' << trials;
            }
            if (trials > 1e11F && p > 1e-6) {
                EXPECT_LT(std::abs(seen.mean() - 1), 0.01);
            }
        }
    }
    // As small as probabilities get: N p = 1, by a light class of its own.
    const std::array<mica::light_class<float>, 1> tiny{{{{1, 1, 1}, 1e-12F}}};
    mica::glint_material material;
    material.log_density = std::log(1e12F * 1048576);
    auto point = seen_from(0.3F);
    point.derivatives = {0x1p-10F, 0, 0, 0x1p-10F};
    statistics::running_moments flashes;
    for (std::uint32_t i = 0; i < 65536; ++i) {
        point.uv = {static_cast<float>(i % 256) / 256, static_cast<float>(i / 256) / 256};
        flashes.add(static_cast<double>(kernel{}(point, material, tiny, {}, 1).glint.g));
    }
    EXPECT_NEAR(flashes.mean(), 1, 4.5 * flashes.standard_error());
    EXPECT_NEAR(flashes.variance(), 1, 0.05);
}

// KK25 Fig. 13: a large rectangle, few facets: nothing of the grid shows in the mean.
TEST(AreaLights, SparseFacetsKeepTheirMean) {
    const mica::rectangle_light large{{-3, 0, 3}, {0, 4, 0}, {2, 0, 2}, {1, 1, 1}};
    EXPECT_GT(respond(large, seen_from(0.7F), mica::ggx<float>{0.04F, 0.04F}, {1, 1, 1}, table()).probability, 0.5F);
    for (const float trials : {0.05F, 0.4F, 0.9F, 3.F}) {
        const auto seen = ratios(large, 0.04F, trials, trials < 0.1F ? 1 << 20 : 1 << 19, 0);
        EXPECT_NEAR(seen.mean(), 1, std::max(0.005, 4.5 * seen.standard_error()))
            << trials << " +- " << seen.standard_error();
        EXPECT_LE(seen.standard_error(), 0.0051) << trials;
    }
}

} // namespace
