// Glints under an environment: the counted radiance has the smooth one as its mean, becomes it when facets are many,
// goes dark pixel by pixel when they are few, and is defined whatever the pixel.

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/dual_gated.hpp>
#include <mica/law/exact.hpp>
#include <mica/shade/environment_glints.hpp>

#include "statistics.hpp"

namespace {

using mica::exact_binomial;
using colour = mica::rgb<float>;
using direction = mica::vector3<float>;

constexpr double pi = 3.14159265358979323846;

void expect_mean(const statistics::running_moments& sample, double truth, double precision) {
    EXPECT_LE(sample.standard_error(), precision); // otherwise the test could not see a defect of that size
    EXPECT_LE(std::abs(sample.mean() - truth), 4.5 * sample.standard_error() + 1e-6)
        << "mean " << sample.mean() << " standard error " << sample.standard_error() << " truth " << truth;
}

/// Derivatives and place of a pixel of ratio 1 to 30, turned, 2^-11 to 2^-7 wide.
struct place {
    mica::uv_derivatives<float> derivatives;
    mica::uv_point<float> uv;
};

class random_places {
  public:
    explicit random_places(unsigned seed) : random_(seed) {}

    place operator()() {
        const double width = std::exp2(-11 + 4 * unit_(random_)), ratio = std::pow(30., unit_(random_));
        const double axis = 2 * pi * unit_(random_), c = std::cos(axis), s = std::sin(axis);
        return {{static_cast<float>(ratio * width * c), static_cast<float>(ratio * width * s),
                 static_cast<float>(-width * s), static_cast<float>(width * c)},
                {static_cast<float>(unit_(random_)), static_cast<float>(unit_(random_))}};
    }

  private:
    std::mt19937 random_;
    std::uniform_real_distribution<double> unit_{0, 1};
};

/// Counted over smooth radiance of a pixel under an environment of grey levels, of which its lobe shows the given parts.
template <class Law, std::size_t K>
float glint_ratio(const place& where, float trials, const std::array<float, K>& levels,
                  const std::array<float, K>& indicators, float visible, std::uint32_t seed) {
    std::array<mica::light_class<float>, K> classes;
    float rest = 1;
    for (std::size_t k = K; k-- > 0;) {
        const float radiance = levels[k] * indicators[k];
        classes[k] = {{radiance, radiance, radiance}, k > 0 ? visible * indicators[k] : rest};
        rest -= classes[k].probability;
    }
    const mica::shading_point<float> point{{0, 0, 1}, {0, 0, 1}, where.uv, where.derivatives};
    mica::glint_material material;
    material.log_density = std::log(trials / mica::make_footprint(where.derivatives).area);
    const auto radiance = mica::glint_kernel<Law>{}(point, material, classes, {}, seed);
    return radiance.smooth.g > 0 ? radiance.glint.g / radiance.smooth.g : radiance.glint.g == 0 ? 1.F : -1.F;
}

// --- the ratio --------------------------------------------------------------------------------------------------

template <class Law, std::size_t K>
statistics::running_moments ratios(const std::array<float, K>& levels, const std::array<float, K>& indicators,
                                   float visible, float trials, std::uint32_t seeds) {
    random_places random(1);
    statistics::running_moments sample;
    for (std::uint32_t seed = 0; seed < seeds; ++seed)
        sample.add(static_cast<double>(glint_ratio<Law>(random(), trials, levels, indicators, visible, seed)));
    return sample;
}

TEST(GlintRatio, MeanIsOneForTwoLevels) {
    for (const float visible : {0.3F, 1.F})
        for (const float trials : {0.4F, 7.F, 300.F, 1e6F})
            expect_mean(ratios<exact_binomial, 2>({0, 5}, {0.5F, 0.5F}, visible, trials, 20000), 1, 0.03);
}

TEST(GlintRatio, MeanIsOneForFourLevels) {
    const std::array<float, 4> levels{0, 0.1F, 3, 100};
    for (const auto& indicators : {std::array{0.25F, 0.25F, 0.25F, 0.25F},
                                   {0.1F, 0.8F, 0.09F, 0.01F},
                                   {0.F, 0.F, 0.F, 1.F},
                                   {0.9F, 0.1F, 0.F, 0.F}})
        for (const float trials : {1.5F, 100.F, 1e5F})
            expect_mean(ratios<exact_binomial>(levels, indicators, 0.8F, trials, 15000), 1, 0.06);
}

TEST(GlintRatio, MeanIsOneForEightLevels) {
    const std::array<float, 8> levels{0, 0.01F, 0.1F, 1, 10, 100, 1e3F, 1e4F};
    const std::array<float, 8> indicators{0.2F, 0.3F, 0.2F, 0.1F, 0.1F, 0.06F, 0.03F, 0.01F};
    expect_mean(ratios<exact_binomial>(levels, indicators, 0.55F, 50, 15000), 1, 0.02);
    expect_mean(ratios<exact_binomial>(levels, indicators, 1.F, 1e4F, 5000), 1, 0.005);
}

// A lamp that one facet in a million shows, on many facets.
TEST(GlintRatio, MeanIsOneForRareGlints) {
    expect_mean(ratios<exact_binomial, 3>({0, 1, 1e6F}, {0.9F, 0.099999F, 1e-6F}, 0.9F, 1e7F, 15000), 1, 0.01);
}

// The tolerance must see a law whose mean is off by 3 %.
struct generous_binomial {
    static constexpr bool integer_counts = true;
    template <class Real, class Uniform>
    mica::counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        return exact_binomial{}(trials, Real(1.03) * probability, xi);
    }
};

TEST(GlintRatio, WrongMeanWouldBeSeen) {
    const auto sample = ratios<generous_binomial, 2>({0, 5}, {0.5F, 0.5F}, 0.9F, 300, 20000);
    EXPECT_GE(std::abs(sample.mean() - 1), 4.5 * sample.standard_error());
}

TEST(GlintRatio, ScaleOfTheLevelsDoesNotMatter) {
    random_places random(2);
    for (std::uint32_t seed = 0; seed < 500; ++seed) {
        const auto pixel = random();
        const std::array<float, 3> w{0.5F, 0.3F, 0.2F};
        const float one = glint_ratio<exact_binomial>(pixel, 20.F, std::array{0.F, 1.F, 4.F}, w, 0.7F, seed);
        EXPECT_EQ(one, glint_ratio<exact_binomial>(pixel, 20.F, std::array{0.F, 0x1p90F, 0x1p92F}, w, 0.7F, seed));
        EXPECT_EQ(one, glint_ratio<exact_binomial>(pixel, 20.F, std::array{0.F, 0x1p-90F, 0x1p-88F}, w, 0.7F, seed));
    }
}

TEST(GlintRatio, WithoutFacetsOrLightIsOne) {
    const auto pixel = random_places(3)();
    const std::array<float, 3> levels{0, 1, 4}, w{0.5F, 0.3F, 0.2F};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(glint_ratio<exact_binomial>(pixel, 0.F, levels, w, 0.7F, 1), 1.F);
    EXPECT_EQ(glint_ratio<exact_binomial>(pixel, 10.F, levels, w, 0.F, 1), 1.F); // nothing seen
    EXPECT_EQ(glint_ratio<exact_binomial>(pixel, 10.F, levels, w, nan, 1), 1.F);
    EXPECT_EQ(glint_ratio<exact_binomial>(pixel, 10.F, std::array{0.F, 0.F, 0.F}, w, 0.7F, 1), 1.F);      // black
    EXPECT_EQ(glint_ratio<exact_binomial>(pixel, 10.F, levels, std::array{1.F, 0.F, 0.F}, 0.7F, 1), 1.F); // dark lobe
}

TEST(GlintRatio, FiniteForTinyAndHugeArguments) {
    random_places random(4);
    for (const float trials : {1e-30F, 1e-20F, 1e-5F, 1e10F, 1e30F})
        for (const float visible : {1e-30F, 1e-10F, 1.F})
            for (std::uint32_t seed = 0; seed < 100; ++seed) {
                const std::array<float, 3> levels{0, 1e-3F, 1e30F}, w{0, 0.999F, 1e-3F};
                const auto pixel = random();
                const float exact = glint_ratio<exact_binomial>(pixel, trials, levels, w, visible, seed);
                const float gated = glint_ratio<mica::dual_gated_binomial>(pixel, trials, levels, w, visible, seed);
                ASSERT_TRUE(std::isfinite(exact) && exact >= 0) << trials << ' ' << visible << ' ' << exact;
                ASSERT_TRUE(std::isfinite(gated) && gated >= 0) << trials << ' ' << visible << ' ' << gated;
            }
}

// --- the kernel -------------------------------------------------------------------------------------------------

using environment_of_four = mica::prefiltered_environment<4>;
constexpr float filter_roughnesses[] = {0, 0.1F, 0.3F, 1};

environment_of_four environment_from(const std::vector<colour>& texels) {
    const mica::environment_map map(32, 16, texels);
    return environment_of_four(map, mica::environment_levels<4>(map), filter_roughnesses);
}

/// Sky, ground, and a lamp.
environment_of_four sky_and_lamp() {
    std::vector<colour> texels(32 * 16, {0.05F, 0.04F, 0.03F});
    for (std::size_t i = 0; i < 32 * 8; ++i) texels[i] = {0.3F, 0.5F, 0.9F};
    texels[32 * 5 + 12] = {200, 180, 150};
    return environment_from(texels);
}

const mica::microfacet_table& table() {
    static const mica::microfacet_table built;
    return built;
}

struct uniform_source {
    std::mt19937 random{5};
    std::uniform_real_distribution<float> unit{0, 1};
    float operator()() { return unit(random); }
};

direction random_direction(uniform_source& uniform) {
    const float y = 2 * uniform() - 1, azimuth = 6.2831853F * uniform(), r = std::sqrt(1 - y * y);
    return {r * std::cos(azimuth), y, r * std::sin(azimuth)};
}

template <class Law = exact_binomial>
mica::glint_radiance<float> shaded(const mica::shading_point<float>& point, const mica::glint_material& material,
                                   const environment_of_four& environment, std::uint32_t seed) {
    return mica::shade(mica::glint_kernel<Law>{}, point, material, environment, table(), seed);
}

bool defined(const colour& c) {
    return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b) && c.r >= 0 && c.g >= 0 && c.b >= 0;
}

TEST(Shade, DefinedForRandomPoints) {
    const auto environment = sky_and_lamp();
    random_places places(6);
    uniform_source uniform;
    for (std::uint32_t i = 0; i < 20000; ++i) {
        const auto where = places();
        const mica::shading_point<float> point{random_direction(uniform), random_direction(uniform), where.uv,
                                               where.derivatives};
        mica::glint_material material;
        material.roughness = uniform();
        material.log_density = 40 * uniform();
        const auto radiance = shaded<mica::dual_gated_binomial>(point, material, environment, i);
        ASSERT_TRUE(defined(radiance.glint) && defined(radiance.smooth));
        const bool from_behind = mica::dot(point.normal, point.wo) <= 0;
        ASSERT_TRUE(!from_behind || (radiance.smooth.r == 0 && radiance.glint.r == 0));
    }
}

// No facets to count in them: the smooth radiance.
TEST(Shade, DegenerateFootprintsAreSmooth) {
    const auto environment = sky_and_lamp();
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    for (const auto& derivatives : std::vector<mica::uv_derivatives<float>>{
             {0, 0, 0, 0}, {nan, 0, 0, 1}, {1, 0, 0, infinity}, {1, 1, 0, 0}, {1e-30F, 0, 0, 1e-30F}}) {
        const auto radiance = shaded({{0, 0, 1}, {0, 0, 1}, {0.3F, 0.4F}, derivatives}, {}, environment, 1);
        EXPECT_TRUE(defined(radiance.glint) && radiance.smooth.g > 0);
        EXPECT_EQ(radiance.glint.g, radiance.smooth.g);
    }
}

TEST(Shade, DefinedForDegeneratePoints) {
    const auto environment = sky_and_lamp();
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const mica::uv_derivatives<float> ordinary{1e-3F, 0, 0, 1e-3F}, huge{1e30F, 0, 0, 1e30F};
    const direction up{0, 0, 1}, undefined{nan, 0, 1}, grazing{1, 0, 1e-7F};
    for (const mica::shading_point<float>& point : {mica::shading_point<float>{up, undefined, {0, 0}, ordinary},
                                                    {undefined, up, {0, 0}, ordinary},
                                                    {up, grazing, {0, 0}, ordinary},
                                                    {up, up, {nan, nan}, ordinary},
                                                    {up, up, {infinity, -infinity}, ordinary},
                                                    {up, up, {1e30F, -1e30F}, ordinary},
                                                    {up, up, {0, 0}, huge}})
        for (const float roughness : {0.F, 1e-6F, 0.1F, 1.F})
            for (const float log_density : {-100.F, 0.F, 13.F, 100.F}) {
                mica::glint_material material;
                material.roughness = roughness;
                material.log_density = log_density;
                const auto radiance = shaded(point, material, environment, 2);
                EXPECT_TRUE(defined(radiance.glint) && defined(radiance.smooth)) << roughness << ' ' << log_density;
            }
}

TEST(Shade, SameSeedSamePicture) {
    const auto environment = sky_and_lamp();
    const direction up{0, 0.6F, 0.8F};
    int different = 0;
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const mica::shading_point<float> point{up, up, {0.3F, 0.7F}, {1e-3F, 0, 0, 1e-3F}};
        const auto one = shaded(point, {}, environment, seed);
        ASSERT_EQ(one.glint.g, shaded(point, {}, environment, seed).glint.g);
        ASSERT_EQ(one.smooth.g, shaded(point, {}, environment, seed + 1).smooth.g);
        different += one.glint.g != shaded(point, {}, environment, seed + 1).glint.g;
    }
    EXPECT_GE(different, 20);
}

struct patch_statistics {
    double deviation; ///< of glint / smooth, root mean square
    double dark;      ///< share of pixels without any glint
};

/// A flat patch seen obliquely.
patch_statistics patch(const environment_of_four& environment, float log_density) {
    mica::glint_material material;
    material.log_density = log_density;
    material.roughness = 0.3F;
    const direction normal{0, 1, 0}, wo{0, 0.8F, 0.6F};
    double squares = 0, dark = 0;
    constexpr int size = 48;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const mica::shading_point<float> point{
                normal, wo, {static_cast<float>(x) / 512, static_cast<float>(y) / 512}, {1.F / 512, 0, 0, 1.F / 512}};
            const auto radiance = shaded(point, material, environment, 3);
            const double ratio = static_cast<double>(radiance.glint.g) / static_cast<double>(radiance.smooth.g);
            squares += (ratio - 1) * (ratio - 1);
            dark += ratio == 0;
        }
    return {std::sqrt(squares / (size * size)), dark / (size * size)};
}

// The deviation falls as one over the square root of the number of facets.
TEST(Shade, ConvergesToTheSmoothRadiance) {
    const auto environment = sky_and_lamp();
    const double log_pixel = 2 * std::log(512.);
    double before = patch(environment, static_cast<float>(log_pixel + std::log(1e3))).deviation;
    for (const double facets : {1e5, 1e7, 1e9}) {
        const double after = patch(environment, static_cast<float>(log_pixel + std::log(facets))).deviation;
        EXPECT_LE(after, before / 5); // a tenth is expected, of 48 x 48 correlated pixels
        before = after;
    }
    EXPECT_LE(before, 0.01);
}

TEST(Shade, SparseFacetsLeavePixelsDark) {
    const auto environment = sky_and_lamp();
    const double log_pixel = 2 * std::log(512.);
    double before = 0;
    for (const double facets : {30., 1., 0.1, 0.01, 0.001}) {
        const double dark = patch(environment, static_cast<float>(log_pixel + std::log(facets))).dark;
        EXPECT_GE(dark, before);
        before = dark;
    }
    EXPECT_GE(before, 0.95);
    EXPECT_LE(patch(environment, static_cast<float>(log_pixel + std::log(1e4))).dark, 0.01);
}

// White furnace: a sphere in a uniform environment. Smooth, it shows the directional albedo; with glints, in the mean.
TEST(WhiteFurnace, MeanIsSmoothRadiance) {
    const auto environment = environment_from(std::vector<colour>(32 * 16, {1, 1, 1}));
    random_places places(7);
    for (const float roughness : {0.02F, 0.2F, 0.7F, 1.F})
        for (const float n_dot_v : {0.05F, 0.4F, 0.99F}) {
            mica::glint_material material;
            material.roughness = roughness;
            material.f0 = {1, 1, 1};
            statistics::running_moments glint;
            for (std::uint32_t seed = 0; seed < 1500; ++seed) {
                const auto where = places();
                const direction wo{std::sqrt(1 - n_dot_v * n_dot_v), 0, n_dot_v};
                const auto radiance = shaded({{0, 0, 1}, wo, where.uv, where.derivatives}, material, environment, seed);
                const auto albedo = table().albedo(n_dot_v, roughness);
                ASSERT_NEAR(radiance.smooth.g, albedo.scale + albedo.bias, 2e-5F);
                ASSERT_LE(radiance.smooth.g, 1 + 2e-5F);
                glint.add(static_cast<double>(radiance.glint.g / radiance.smooth.g));
            }
            expect_mean(glint, 1, 0.05);
        }
}

} // namespace
