// Environments parted into crisp classes, by brightness and by colour, with occluders in their shares; held against facets
// that reflect single texels.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/quantile.hpp>
#include <mica/shade/environment_glints.hpp>

#include "statistics.hpp"

namespace {

using colour = mica::rgb<float>;
using direction = mica::vector3<float>;
using mica::environment_classes;
using mica::environment_map;
using mica::prefiltered_classes;
using kernel = mica::glint_kernel<mica::quantile_binomial<4>>;

const mica::microfacet_table& table() {
    static const mica::microfacet_table built;
    return built;
}

/// A map of radiance(direction).
template <class Radiance>
environment_map map_of(std::size_t width, const Radiance& radiance) {
    const std::size_t height = width / 2;
    std::vector<colour> texels;
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x)
            texels.push_back(
                radiance(mica::direction_of({(static_cast<float>(x) + 0.5F) / static_cast<float>(width),
                                             (static_cast<float>(y) + 0.5F) / static_cast<float>(height)})));
    return environment_map(width, height, std::move(texels));
}

/// Red, green and blue lamps of equal luminance around +z, so many degrees apart, over nearly nothing.
environment_map lamps(float degrees) {
    constexpr float radians = std::numbers::pi_v<float> / 180;
    const float from_middle = std::asin(std::sin(degrees * radians / 2) / std::sin(60 * radians));
    std::array<direction, 3> towards;
    for (std::size_t i = 0; i < 3; ++i) {
        const float turn = static_cast<float>(i) * 120 * radians, s = std::sin(from_middle);
        towards[i] = {s * std::cos(turn), s * std::sin(turn), std::cos(from_middle)};
    }
    const colour colours[] = {{3.5F, 0.3F, 0.3F}, {0.3F, 1.3F, 0.3F}, {0.5F, 0.5F, 7.4F}};
    return map_of(512, [&](direction w) {
        for (std::size_t i = 0; i < 3; ++i)
            if (dot(w, towards[i]) > std::cos(2.5F * radians)) return (100 / luminance(colours[i])) * colours[i];
        return colour{0.02F, 0.02F, 0.02F};
    });
}

/// The radiance of a sky with a sun, bright and dim parts, of many colours.
auto sky_under(direction sun) {
    return [sun](direction w) {
        if (dot(w, sun) > 0.998F) return colour{5000, 4500, 3500};
        return w.y > 0 ? colour{0.2F + 0.3F * w.y, 0.3F + 0.5F * w.y, 0.4F + w.y * w.y}
                       : colour{0.05F, 0.04F + 0.02F * (w.x + 1), 0.03F};
    };
}

environment_map sky() { return map_of(128, sky_under(mica::normalized(direction{1, 2, 1}))); }

/// A pixel of the normal +z, seen from it.
mica::shading_point<float> pixel() {
    mica::shading_point<float> point{};
    point.normal = point.wo = {0, 0, 1};
    point.tangent = {1, 0, 0};
    point.derivatives = {0x1p-10F, 0, 0, 0x1p-10F};
    return point;
}

mica::glint_material material_of(float roughness, float trials) {
    mica::glint_material material;
    material.roughness = roughness;
    material.log_density = std::log(trials * 0x1p20F);
    return material;
}

/// What facets of the pixel's lobe do, one by one: which texel each shows.
class texel_facets {
  public:
    template <class Visible>
    texel_facets(const environment_map& map, float roughness, const Visible& visible) : map_(map) {
        const auto& image = map.image();
        const auto alpha = static_cast<double>(roughness);
        double total = 0;
        for (std::size_t y = 0; y < image.height; ++y)
            for (std::size_t x = 0; x < image.width; ++x) {
                const auto w = mica::direction_of({(static_cast<float>(x) + 0.5F) / static_cast<float>(image.width),
                                                   (static_cast<float>(y) + 0.5F) / static_cast<float>(image.height)});
                const double cosine = static_cast<double>(w.z), square = (1 + cosine) / 2; // of the half angle
                const double q = 1 - square + alpha * alpha * square;
                const double weight =
                    cosine > 0 ? cosine / (q * q) * mica::texel_solid_angle(image.width, image.height, y) : 0;
                total += weight;
                if (visible(w) > 0)
                    cumulated_.push_back(visible_ += weight);
                else
                    cumulated_.push_back(visible_);
            }
        for (double& sum : cumulated_) sum /= total;
    }

    /// The part of the lobe that is visible.
    double share() const { return cumulated_.back(); }

    /// The radiance that a random facet of the lobe shows.
    template <class Random>
    colour operator()(Random& random) const {
        const double place = std::uniform_real_distribution<double>(0, 1)(random);
        const auto found = std::upper_bound(cumulated_.begin(), cumulated_.end(), place);
        if (found == cumulated_.end()) return {0, 0, 0};
        return map_.image().texels[static_cast<std::size_t>(found - cumulated_.begin())];
    }

  private:
    const environment_map& map_;
    std::vector<double> cumulated_;
    double visible_ = 0;
};

constexpr auto nothing_hidden = [](direction) { return 1.F; };

// --- classes ----------------------------------------------------------------------------------------------------

// Between the geometric means of neighbouring levels.
TEST(Classes, ByBrightnessAreBoundedByGeometricMeans) {
    const auto map = map_of(16, [](direction w) { return w.y > 0.9F ? colour{256, 256, 256} : colour{1, 1, 1}; });
    const auto classes = environment_classes<5>::by_brightness(map); // levels 1, 4, 16, 64, 256
    const std::pair<float, std::size_t> expected[] = {{0, 0},    {0.001F, 0}, {1.99F, 0}, {2.01F, 1}, {7.9F, 1},
                                                      {8.1F, 2}, {33, 3},     {127, 3},   {129, 4},   {1e9F, 4}};
    for (const auto& [luminance, k] : expected)
        EXPECT_EQ(classes.class_of({luminance, luminance, luminance}), k) << luminance;
}

TEST(Classes, OfDegenerateMaps) {
    const auto black = map_of(8, [](direction) { return colour{0, 0, 0}; });
    const auto white = map_of(8, [](direction) { return colour{1, 1, 1}; });
    const auto brightest = map_of(8, [](direction) { return colour{1e30F, 1e30F, 1e30F}; });
    const float roughness[] = {0.3F};
    for (const auto* map : {&black, &white, &brightest})
        for (const auto& classes :
             {environment_classes<4>::by_brightness(*map), environment_classes<4>::by_colour(*map)}) {
            const auto seen = prefiltered_classes<4>(*map, classes, roughness)({0, 0, 1}, 0.3F);
            float share = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                EXPECT_TRUE(std::isfinite(seen.radiance[k].g));
                share += seen.share[k];
            }
            EXPECT_NEAR(share, 1, 1e-5F);
        }
    EXPECT_EQ(environment_classes<4>::by_brightness(white).class_of({1, 1, 1}), 3U); // as KK25's top level
    EXPECT_THROW(environment_classes<4>::by_brightness(white, 0), std::invalid_argument);
}

// Texels below the floor count as it, so that no class is spent on the dark: levels 1 and 256 here, not 2^-10 and 256.
TEST(Classes, ByBrightnessStartAtTheFloor) {
    const auto map = map_of(16, [](direction w) {
        return w.y > 0 ? colour{256, 256, 256} : 0x1p-10F * colour{1, 1, 1};
    });
    const auto classes = environment_classes<2>::by_brightness(map, 1);
    EXPECT_EQ(classes.class_of({15, 15, 15}), 0U);
    EXPECT_EQ(classes.class_of({17, 17, 17}), 1U);
}

// Means by light. Greys of 0, 3.5 and 8 stops, of 3/4, 6/25 and 1/100 of the sphere: the lower two have their mean by light at
// 2.7, and the bound between it and 8 is at 5.4; by solid angle alone it would be at 4.4, and without any mean at 4.
TEST(Classes, ByColourHaveTheirCentresWhereTheLightIs) {
    const auto grey = [](float stops) { return std::exp2(stops) * colour{1, 1, 1}; };
    const auto map = map_of(256, [&](direction w) { return grey(w.y > 0.98F ? 8.F : w.y > 0.5F ? 3.5F : 0.F); });
    const auto classes = environment_classes<2>::by_colour(map);
    EXPECT_EQ(classes.class_of(grey(5)), 0U);
    EXPECT_EQ(classes.class_of(grey(5.8F)), 1U);
}

// Lamps of one brightness are one class by brightness, and a class each by colour.
TEST(Classes, ByColourPartLampsThatBrightnessCannot) {
    const auto map = lamps(50);
    const colour red{350, 30, 30}, green{30, 130, 30}, blue{50, 50, 740};
    const auto by_colour = environment_classes<4>::by_colour(map);
    EXPECT_EQ(by_colour.class_of({0.02F, 0.02F, 0.02F}), 0U);
    std::array<bool, 4> taken{true, false, false, false};
    for (const auto& lamp : {red, green, blue}) {
        EXPECT_FALSE(taken[by_colour.class_of(lamp)]);
        taken[by_colour.class_of(lamp)] = true;
    }
}

// Nothing is lost by parting: the classes add up to the radiance that is filtered whole.
TEST(Classes, AddUpToTheWhole) {
    const auto map = sky();
    const float roughnesses[] = {0.2F, 0.6F};
    const mica::prefiltered_environment<2> whole(map, mica::environment_levels<2>(map), roughnesses);
    for (const auto& classes : {environment_classes<6>::by_brightness(map), environment_classes<6>::by_colour(map)}) {
        const prefiltered_classes<6> parted(map, classes, roughnesses);
        for (float azimuth = 0; azimuth < 6.2F; azimuth += 0.37F)
            for (const float roughness : {0.2F, 0.3F, 0.6F}) {
                const auto r = mica::normalized(direction{std::cos(azimuth), std::sin(2 * azimuth), std::sin(azimuth)});
                const auto seen = parted(r, roughness);
                const colour expected = whole(r, roughness).radiance;
                colour sum{0, 0, 0};
                float share = 0;
                for (std::size_t k = 0; k < 6; ++k) {
                    sum = sum + seen.radiance[k];
                    share += seen.share[k];
                }
                // The blocks of light are placed by its brightness, which here is that of all bands, so to a rounding.
                EXPECT_NEAR(sum.r, expected.r, 1e-4F * expected.r);
                EXPECT_NEAR(sum.b, expected.b, 1e-4F * expected.b);
                EXPECT_NEAR(share, 1, 1e-4F);
            }
    }
}

// --- glints of lamps --------------------------------------------------------------------------------------------

/// Chromaticity (r, b) of pixels that glint, and how many do.
struct chromaticity {
    statistics::running_moments red, blue;
    double glinting = 0, samples = 0, saturated = 0; ///< saturated: one band has three fifths of all
    float reddest = 0;

    void add(colour c, float threshold) {
        ++samples;
        if (!(luminance(c) > threshold)) return;
        ++glinting;
        const auto sum = static_cast<double>(c.r + c.g + c.b);
        red.add(static_cast<double>(c.r) / sum);
        blue.add(static_cast<double>(c.b) / sum);
        if (static_cast<double>(std::max({c.r, c.g, c.b})) > 0.6 * sum) ++saturated;
        reddest = std::max(reddest, c.r / (c.r + c.g + c.b));
    }
};

template <class Environment>
chromaticity of_kernel(const Environment& environment, float roughness, float trials, float threshold) {
    chromaticity seen;
    auto point = pixel();
    for (std::uint32_t i = 0; i < 65536; ++i) {
        point.uv = {static_cast<float>(i % 256) / 256, static_cast<float>(i / 256) / 256};
        seen.add(shade(kernel{}, point, material_of(roughness, trials), environment, table(), 1U).glint, threshold);
    }
    return seen;
}

chromaticity of_facets(const environment_map& map, float roughness, float trials, float threshold) {
    const texel_facets facets(map, roughness, nothing_hidden);
    const float visible = table().visible_fraction(1, roughness);
    const auto albedo = table().albedo(1, roughness);
    const auto f0 = mica::glint_material{}.f0;
    const colour reflectance = albedo.scale * f0 + colour{albedo.bias, albedo.bias, albedo.bias};
    chromaticity seen;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int i = 0; i < 65536; ++i) {
        colour sum{0, 0, 0};
        for (float n = std::floor(trials + unit(random)); n > 0; --n)
            if (unit(random) < visible) sum = sum + facets(random);
        seen.add((1 / (trials * visible)) * (reflectance * sum), threshold);
    }
    return seen;
}

/// Facets by their normals, which share nothing with the lobe of the filtered map: density D / D_H per solid angle, by
/// rejection from directions even over the hemisphere; the texel that the reflected eye ray meets. What they have in common
/// with the model is its reflectance alone. The model filters with D(h) n.l as all image-based lighting does (KK25 Eq. 11),
/// so how many glint differs (at roughness 0.3 by a third where the lamps are near the mirror direction); their colours do
/// not.
chromaticity of_normals(const environment_map& map, float roughness, float trials, float threshold) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1);
    const auto normal = [&] {
        for (;;) {
            const float cosine = unit(random), azimuth = 2 * std::numbers::pi_v<float> * unit(random);
            const float q = roughness * roughness / (1 - (1 - roughness * roughness) * cosine * cosine);
            if (unit(random) >= q * q) continue; // D over its largest
            const float sine = std::sqrt(1 - cosine * cosine);
            return direction{sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
        }
    };
    const auto& image = map.image();
    const auto shown = [&](direction w) {
        const auto point = mica::equirect_of(w);
        const auto x = static_cast<std::size_t>(point.u * static_cast<float>(image.width));
        const auto y = static_cast<std::size_t>(point.v * static_cast<float>(image.height));
        return image.at(std::min(x, image.width - 1), std::min(y, image.height - 1));
    };
    const auto albedo = table().albedo(1, roughness);
    const colour reflectance = albedo.scale * mica::glint_material{}.f0 + colour{albedo.bias, albedo.bias, albedo.bias};
    const float visible = table().visible_fraction(1, roughness);
    chromaticity seen;
    for (int i = 0; i < 65536; ++i) {
        colour sum{0, 0, 0};
        for (float n = std::floor(trials + unit(random)); n > 0; --n) {
            const auto h = normal();
            const direction w{2 * h.z * h.x, 2 * h.z * h.y, 2 * h.z * h.z - 1}; // the eye at +z
            if (w.z > 0) sum = sum + shown(w);
        }
        seen.add((1 / (trials * visible)) * (reflectance * sum), threshold);
    }
    return seen;
}

void print(const char* what, float degrees, const chromaticity& seen) {
    std::printf("%-12s lamps %2.0f degrees apart: %.4f glint, red %.3f +- %.3f, blue %.3f +- %.3f, saturated %.3f\n",
                what, static_cast<double>(degrees), seen.glinting / seen.samples, seen.red.mean(),
                std::sqrt(seen.red.variance()), seen.blue.mean(), std::sqrt(seen.blue.variance()),
                seen.saturated / seen.glinting);
}

// KK25 Fig. 11. Mean and spread of the chromaticity as the facets have it; published levels are white where the lobe
// sees all lamps: without spread.
TEST(ColouredLamps, GlintsKeepTheirLampsColour) {
    for (const float degrees : {6.F, 50.F}) {
        const auto map = lamps(degrees);
        const float roughness[] = {0.3F};
        const float trials = 20, threshold = 2;
        const auto expected = of_facets(map, 0.3F, trials, threshold);
        const auto normals = of_normals(map, 0.3F, trials, threshold);
        const auto seen = of_kernel(prefiltered_classes<4>(map, environment_classes<4>::by_colour(map), roughness),
                                    0.3F, trials, threshold);
        const auto published =
            of_kernel(mica::prefiltered_environment<8>(map, mica::environment_levels<8>(map), roughness), 0.3F, trials,
                      threshold);
        print("facets", degrees, expected);
        print("normals", degrees, normals);
        print("by colour", degrees, seen);
        print("published", degrees, published);
        EXPECT_NEAR(seen.glinting / seen.samples, expected.glinting / expected.samples,
                    0.1 * expected.glinting / expected.samples);
        for (const auto* facets : {&expected, &normals}) {
            EXPECT_NEAR(seen.red.mean(), facets->red.mean(), 0.05);
            EXPECT_NEAR(seen.blue.mean(), facets->blue.mean(), 0.05);
            EXPECT_NEAR(std::sqrt(seen.red.variance()), std::sqrt(facets->red.variance()), 0.05);
            EXPECT_NEAR(std::sqrt(seen.blue.variance()), std::sqrt(facets->blue.variance()), 0.05);
            EXPECT_NEAR(seen.saturated / seen.glinting, facets->saturated / facets->glinting, 0.05);
        }
        EXPECT_GT(std::sqrt(seen.blue.variance()), 0.25) << "white";
        EXPECT_LT(std::sqrt(published.blue.variance()), 0.05) << "published levels are expected to be white";
    }
}

// --- occluders --------------------------------------------------------------------------------------------------

// A wall hides what lies towards +x: no glint of its lamps is left, and the mean is that of the facets.
TEST(Occluder, TakesTheGlintsOfWhatItHides) {
    const auto map = lamps(50);
    const auto wall = [](direction w) { return w.x > 0 ? 0.F : 1.F; }; // the red lamp's side
    const float roughness[] = {0.3F};
    const auto classes = environment_classes<4>::by_colour(map);
    const prefiltered_classes<4> occluded(map, classes, roughness, wall), open(map, classes, roughness);
    const float trials = 20;
    const auto seen = of_kernel(occluded, 0.3F, trials, 2), unhidden = of_kernel(open, 0.3F, trials, 2);
    EXPECT_LT(seen.red.mean() + 2 * std::sqrt(seen.red.variance()), 0.5); // green and blue glints only
    EXPECT_LT(seen.reddest, 0.25F); // in any pixel: green has 0.18 of red, blue 0.06
    EXPECT_GT(unhidden.reddest, 0.7F);
    EXPECT_GT(unhidden.red.mean() + 2 * std::sqrt(unhidden.red.variance()), 0.8);

    // The mean, by the sum over all visible texels.
    const auto lobe = occluded({0, 0, 1}, 0.3F);
    const texel_facets facets(map, 0.3F, wall);
    float share = 0;
    colour radiance{0, 0, 0};
    for (std::size_t k = 0; k < 4; ++k) {
        share += lobe.share[k];
        radiance = radiance + lobe.radiance[k];
    }
    EXPECT_NEAR(static_cast<double>(share), facets.share(), 0.01 * facets.share());
    const auto hidden_map = map_of(512, [&](direction w) { return wall(w) * map(w); });
    const auto expected = prefiltered_classes<4>(hidden_map, environment_classes<4>::by_brightness(hidden_map),
                                                 roughness)({0, 0, 1}, 0.3F);
    colour sum{0, 0, 0};
    for (const auto& one : expected.radiance) sum = sum + one;
    EXPECT_NEAR(radiance.r, sum.r, 0.01F * sum.r);
    EXPECT_NEAR(radiance.g, sum.g, 0.01F * sum.g);
    EXPECT_NEAR(radiance.b, sum.b, 0.01F * sum.b);

    statistics::running_moments ratio;
    auto point = pixel();
    const auto material = material_of(0.3F, 2000);
    for (std::uint32_t i = 0; i < 65536; ++i) {
        point.uv = {static_cast<float>(i % 256) / 256, static_cast<float>(i / 256) / 256};
        const auto shaded = shade(kernel{}, point, material, occluded, table(), 1U);
        ratio.add(static_cast<double>(shaded.glint.b / shaded.smooth.b));
    }
    EXPECT_NEAR(ratio.mean(), 1, std::max(0.01, 4.5 * ratio.standard_error()));
    EXPECT_LT(ratio.standard_error(), 0.004);
}

// A white room of which half is hidden: half of the facets are dark.
TEST(Occluder, LeavesTheShareThatIsVisible) {
    const auto map = map_of(128, [](direction) { return colour{1, 1, 1}; });
    const float roughness[] = {0.2F};
    const auto wall = [](direction w) { return w.x > 0 ? 0.F : 1.F; };
    const prefiltered_classes<2> half(map, environment_classes<2>::by_brightness(map), roughness, wall);
    EXPECT_NEAR(half({0, 0, 1}, 0.2F).share[1], 0.5F, 0.005F);
    EXPECT_NEAR(half({0, 0, 1}, 0.2F).radiance[1].g, 0.5F, 0.005F);
    EXPECT_LT(half({1, 0, 0}, 0.2F).share[1], 0.02F);
    EXPECT_GT(half({-1, 0, 0}, 0.2F).share[1], 0.98F);

    // What is hidden is of no class; the dimmest has the facets that reflect nothing, and no more.
    const auto classes = light_classes(pixel(), material_of(0.2F, 20), half, table());
    const float visible = table().visible_fraction(1, 0.2F);
    EXPECT_NEAR(classes[1].probability, visible / 2, 0.005F);
    EXPECT_NEAR(classes[0].probability, 1 - visible, 0.005F);
}

// --- every frame ------------------------------------------------------------------------------------------------

/// The mean over blocks of side x side texels: the same environment in a smaller map.
environment_map reduced(const environment_map& map, std::size_t side) {
    const auto& image = map.image();
    std::vector<colour> texels;
    for (std::size_t y = 0; y < image.height; y += side)
        for (std::size_t x = 0; x < image.width; x += side) {
            colour sum{0, 0, 0};
            float whole = 0;
            for (std::size_t j = y; j < y + side; ++j)
                for (std::size_t i = x; i < x + side; ++i) {
                    const auto weight = static_cast<float>(mica::texel_solid_angle(image.width, image.height, j));
                    sum = sum + weight * image.at(i, j);
                    whole += weight;
                }
            texels.push_back((1 / whole) * sum);
        }
    return environment_map(image.width / side, image.height / side, std::move(texels));
}

struct filter_error {
    float radiance = 0, share = 0; ///< radiance over its largest
};

filter_error largest_error(const prefiltered_classes<4>& fine, const prefiltered_classes<4>& coarse, float roughness) {
    float largest = 0;
    filter_error error;
    for (float v = -0.99F; v < 1; v += 0.03F)
        for (float azimuth = 0; azimuth < 6.28F; azimuth += 0.03F) {
            const float s = std::sqrt(1 - v * v);
            const direction r{s * std::cos(azimuth), v, s * std::sin(azimuth)};
            const auto a = fine(r, roughness), b = coarse(r, roughness);
            float whole = 0, difference = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                whole += luminance(a.radiance[k]);
                difference += luminance(b.radiance[k]) - luminance(a.radiance[k]);
                error.share = std::max(error.share, std::abs(b.share[k] - a.share[k]));
            }
            largest = std::max(largest, whole);
            error.radiance = std::max(error.radiance, std::abs(difference));
        }
    error.radiance /= largest;
    return error;
}

// What changes from frame to frame is filtered more coarsely, by what prefilter.hpp says. A sun can be anywhere between the
// texels of the result: one place says little.
TEST(EveryFrame, ErrorAsStated) {
    struct stated {
        float roughness;
        filter_error most;
    };
    for (const stated& row :
         {stated{0.16F, {0.19F, 0.06F}}, stated{0.3F, {0.07F, 0.025F}}, stated{0.6F, {0.02F, 0.01F}}}) {
        const float roughnesses[] = {row.roughness};
        filter_error error;
        for (int i = 0; i < 12; i += 2) {
            const float v = -0.9F + 1.8F * (static_cast<float>(i) + 0.5F) / 12, azimuth = 2.4F * static_cast<float>(i);
            const float s = std::sqrt(1 - v * v);
            const auto map = map_of(1024, sky_under({s * std::cos(azimuth), v, s * std::sin(azimuth)}));
            const auto small = reduced(map, 8);
            const prefiltered_classes<4> fine(map, environment_classes<4>::by_brightness(map), roughnesses);
            const prefiltered_classes<4> coarse(small, environment_classes<4>::by_brightness(small), roughnesses, {},
                                                {}, mica::every_frame);
            const auto here = largest_error(fine, coarse, row.roughness);
            error = {std::max(error.radiance, here.radiance), std::max(error.share, here.share)};
        }
        std::printf("every frame, roughness %.2f: radiance to %.3f of its largest, shares to %.3f\n",
                    static_cast<double>(row.roughness), static_cast<double>(error.radiance),
                    static_cast<double>(error.share));
        EXPECT_LE(error.radiance, row.most.radiance);
        EXPECT_LE(error.share, row.most.share);
    }
}

} // namespace
