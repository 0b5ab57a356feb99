// Environment maps, their partition into levels (KK25 Eq. 18 and 19), and the prefilter against the plain sum over all
// texels in double.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <mica/shade/environment.hpp>
#include <mica/shade/prefilter.hpp>

namespace {

using mica::environment_levels;
using mica::environment_map;
using mica::prefiltered_environment;
using colour = mica::rgb<float>;
using direction = mica::vector3<float>;

constexpr double pi = 3.14159265358979323846;
constexpr double epsilon = std::numeric_limits<float>::epsilon();

class random_directions {
  public:
    explicit random_directions(unsigned seed) : random_(seed) {}

    direction operator()() {
        const double y = 2 * unit_(random_) - 1, azimuth = 2 * pi * unit_(random_);
        const double r = std::sqrt(1 - y * y);
        return {static_cast<float>(r * std::cos(azimuth)), static_cast<float>(y),
                static_cast<float>(r * std::sin(azimuth))};
    }

  private:
    std::mt19937 random_;
    std::uniform_real_distribution<double> unit_{0, 1};
};

// --- directions and texels --------------------------------------------------------------------------------------

TEST(Equirect, Convention) {
    const auto middle = mica::equirect_of({0, 0, -1});
    EXPECT_FLOAT_EQ(middle.u, 0.5F);
    EXPECT_FLOAT_EQ(middle.v, 0.5F);
    EXPECT_FLOAT_EQ(mica::equirect_of({1, 0, 0}).u, 0.75F); // right of the middle
    EXPECT_FLOAT_EQ(mica::equirect_of({-1, 0, 0}).u, 0.25F);
    EXPECT_FLOAT_EQ(mica::equirect_of({0, 1, 0}).v, 0.F); // top
    EXPECT_FLOAT_EQ(mica::equirect_of({0, -1, 0}).v, 1.F);
    EXPECT_EQ(mica::equirect_of({0.F, 0, 1}).u, 0.F); // the seam, from either side
    EXPECT_EQ(mica::equirect_of({-0.F, 0, 1}).u, 0.F);
}

TEST(Equirect, RoundTripFromDirections) {
    random_directions random(1);
    for (int i = 0; i < 100000; ++i) {
        const direction w = random();
        const auto point = mica::equirect_of(w);
        ASSERT_TRUE(point.u >= 0 && point.u < 1 && point.v >= 0 && point.v <= 1);
        const direction back = mica::direction_of(point) - w;
        // acos loses half the digits at the poles.
        const float tolerance = std::abs(w.y) < 0.9F ? 4e-6F : 1e-3F;
        ASSERT_LE(std::sqrt(mica::dot(back, back)), tolerance);
    }
}

TEST(Equirect, RoundTripFromPoints) {
    for (int i = 0; i < 64; ++i)
        for (int j = 1; j < 64; ++j) {
            const mica::equirect_point point{static_cast<float>(i) / 64, static_cast<float>(j) / 64};
            const auto back = mica::equirect_of(mica::direction_of(point));
            const float apart = std::abs(back.u - point.u);
            EXPECT_LE((std::min)(apart, 1 - apart), 1e-6F);
            EXPECT_NEAR(back.v, point.v, 3e-6F);
        }
}

TEST(Equirect, SolidAnglesSumToTheSphere) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {8, 4}, {1024, 512}, {5, 77}}) {
        const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
        double sum = 0;
        for (std::size_t y = 0; y < h; ++y) {
            EXPECT_GT(mica::texel_solid_angle(w, h, y), 0.);
            sum += static_cast<double>(w) * mica::texel_solid_angle(w, h, y);
        }
        EXPECT_NEAR(sum, 4 * pi, 1e-12);
    }
}

// --- maps -------------------------------------------------------------------------------------------------------

std::string failure_of(std::size_t width, std::size_t height, std::vector<colour> texels) {
    try {
        environment_map(width, height, std::move(texels));
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "none";
}

::testing::AssertionResult names(const std::string& message, const std::string& parameter) {
    if (message.find(parameter) != std::string::npos) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << '"' << message << "\" does not name " << parameter;
}

TEST(EnvironmentMap, FailuresNameTheParameter) {
    const colour grey{1, 1, 1};
    EXPECT_TRUE(names(failure_of(0, 1, {}), "width"));
    EXPECT_TRUE(names(failure_of(1, 0, {}), "height"));
    EXPECT_TRUE(names(failure_of(2, 2, {grey, grey, grey}), "texels"));
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    for (const float bad : {nan, -1.F, -1e-30F, -infinity}) {
        EXPECT_TRUE(names(failure_of(1, 1, {{bad, 1, 1}}), "radiance"));
        EXPECT_TRUE(names(failure_of(1, 1, {{1, bad, 1}}), "radiance"));
        EXPECT_TRUE(names(failure_of(1, 1, {{1, 1, bad}}), "radiance"));
    }
    EXPECT_EQ(failure_of(1, 1, {grey}), "none");
}

TEST(EnvironmentMap, HugeRadianceCountsAsLargest) {
    const environment_map map(1, 1, {{std::numeric_limits<float>::infinity(), 3e38F, 1}});
    EXPECT_EQ(map.image().at(0, 0).r, 1e30F);
    EXPECT_EQ(map.image().at(0, 0).g, 1e30F);
    EXPECT_EQ(map.image().at(0, 0).b, 1.F);
}

TEST(EnvironmentMap, BilinearWeightsSumToOneEverywhere) {
    const environment_map map(5, 3, std::vector<colour>(15, {2, 3, 4}));
    random_directions random(2);
    for (int i = 0; i < 20000; ++i) {
        const colour c = map(random());
        ASSERT_NEAR(c.r, 2.F, 1e-6F);
        ASSERT_NEAR(c.b, 4.F, 2e-6F);
    }
    for (const direction& w : {direction{0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {-0.F, 0, 1}, {0, 0, -1}})
        EXPECT_NEAR(map(w).g, 3.F, 1e-6F);
}

TEST(EnvironmentMap, TexelCentresAreTheTexels) {
    std::vector<colour> texels;
    for (int i = 0; i < 8 * 4; ++i) texels.push_back({static_cast<float>(i), 0, 0});
    const environment_map map(8, 4, texels);
    for (std::size_t y = 0; y < 4; ++y)
        for (std::size_t x = 0; x < 8; ++x) {
            const mica::equirect_point centre{(static_cast<float>(x) + 0.5F) / 8, (static_cast<float>(y) + 0.5F) / 4};
            EXPECT_NEAR(map(mica::direction_of(centre)).r, map.image().at(x, y).r, 1e-4F);
        }
}

// --- levels -----------------------------------------------------------------------------------------------------

environment_map grey_map(const std::vector<float>& luminances) {
    std::vector<colour> texels;
    for (const float l : luminances) texels.push_back({l, l, l});
    return environment_map(luminances.size(), 1, texels);
}

std::vector<float> random_luminances(double log10_low, double log10_high) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> exponent(log10_low, log10_high);
    std::vector<float> values;
    for (int i = 0; i < 2000; ++i) values.push_back(static_cast<float>(std::pow(10, exponent(random))));
    return values;
}

/// sum w = 1, w >= 0, at most two neighbours, sum L_k w_k = L for every texel.
template <std::size_t K>
void expect_partition(const environment_map& map, float floor) {
    const environment_levels<K> levels(map, floor);
    const auto& radiance = levels.radiance();
    EXPECT_EQ(radiance[0], 0.F);
    for (std::size_t k = 1; k < K; ++k) EXPECT_GE(radiance[k], radiance[k - 1]);
    for (const auto& texel : map.image().texels) {
        const float luminance = mica::luminance(texel);
        const auto w = levels.indicators(luminance);
        double sum = 0, mean = 0;
        int used = 0;
        for (std::size_t k = 0; k < K; ++k) {
            ASSERT_TRUE(w[k] >= 0 && w[k] <= 1);
            sum += static_cast<double>(w[k]);
            mean += static_cast<double>(w[k]) * static_cast<double>(radiance[k]);
            used += w[k] > 0;
        }
        ASSERT_LE(std::abs(sum - 1), epsilon);
        ASSERT_LE(used, 2);
        // w[above] is rounded relative to the level above, which may be far brighter than L.
        double above = 0;
        for (std::size_t k = K; k-- > 0 && radiance[k] > luminance;) above = static_cast<double>(radiance[k]);
        ASSERT_LE(std::abs(mean - static_cast<double>(luminance)),
                  2 * epsilon * (static_cast<double>(luminance) + above));
    }
}

template <class Count>
class Levels : public ::testing::Test {};
using level_counts = ::testing::Types<std::integral_constant<std::size_t, 2>, std::integral_constant<std::size_t, 3>,
                                      std::integral_constant<std::size_t, 4>, std::integral_constant<std::size_t, 8>,
                                      std::integral_constant<std::size_t, 16>>;
TYPED_TEST_SUITE(Levels, level_counts);

TYPED_TEST(Levels, PartitionRandomLuminances) {
    constexpr std::size_t K = TypeParam::value;
    expect_partition<K>(grey_map(random_luminances(-6, 5)), 1e-3F);
    expect_partition<K>(grey_map(random_luminances(-6, 5)), 1e-5F);
    expect_partition<K>(grey_map(random_luminances(0, 0.5)), 1e-2F);
}

TYPED_TEST(Levels, AreSpacedAsInThePaper) {
    constexpr std::size_t K = TypeParam::value;
    const environment_levels<K> levels(grey_map({0.01F, 3, 700}), 1e-3F);
    for (std::size_t k = 1; k < K; ++k) {
        const double part = static_cast<double>(k) / (K - 1);
        const double expected = 0.01 * std::pow(700 / 0.01, part);
        EXPECT_NEAR(static_cast<double>(levels.radiance()[k]) / expected, 1, 1e-6) << k;
    }
}

TYPED_TEST(Levels, TopIsTheBrightestTexel) {
    constexpr std::size_t K = TypeParam::value;
    for (const float sun : {1e-4F, 0.7F, 12345.67F, 9.9e29F}) {
        const auto map = grey_map({sun / 3, sun, 0});
        const float brightest = mica::luminance(colour{sun, sun, sun});
        EXPECT_EQ(environment_levels<K>(map).radiance()[K - 1], brightest);
        EXPECT_EQ(environment_levels<K>(map).indicators(brightest)[K - 1], 1.F);
    }
}

TYPED_TEST(Levels, ConstantIsAllOfTheTop) {
    constexpr std::size_t K = TypeParam::value;
    for (const float radiance : {1e-6F, 1.F, 1e6F}) { // 1e-6 is below the floor
        const auto map = grey_map(std::vector<float>(7, radiance));
        expect_partition<K>(map, 1e-3F);
        EXPECT_EQ(environment_levels<K>(map).indicators(mica::luminance(map.image().at(0, 0)))[K - 1], 1.F);
    }
}

TYPED_TEST(Levels, BlackIsAllOfTheDark) {
    constexpr std::size_t K = TypeParam::value;
    const auto map = grey_map({0, 0, 0});
    expect_partition<K>(map, 1e-3F);
    EXPECT_EQ(environment_levels<K>(map).indicators(0)[0], 1.F);
}

TYPED_TEST(Levels, NearlyConstant) {
    constexpr std::size_t K = TypeParam::value;
    const float next = std::nextafter(1.F, 2.F);
    expect_partition<K>(grey_map({1, next, 1, next}), 1e-3F);
    expect_partition<K>(grey_map({1, std::nextafter(next, 2.F), next}), 1e-3F);
}

TYPED_TEST(Levels, AllBelowTheFloor) {
    constexpr std::size_t K = TypeParam::value;
    expect_partition<K>(grey_map({1e-5F, 2e-5F, 9e-5F, 0}), 1e-2F);
    expect_partition<K>(grey_map({1e-40F, 2e-40F, 0}), 1e-2F);
}

TEST(EnvironmentLevels, FloorKeepsLevelsFromTheDark) {
    const auto map = grey_map({1e-20F, 10});
    EXPECT_NEAR(environment_levels<3>(map, 1e-3F).radiance()[1], 0.1F, 1e-6F); // sqrt(1e-3 10)
}

TEST(EnvironmentLevels, BeyondTheTopIsTheTop) {
    const environment_levels<4> levels(grey_map({0.1F, 10}));
    const auto w = levels.indicators(1e6F);
    EXPECT_EQ(w[3], 1.F);
    EXPECT_EQ(w[0] + w[1] + w[2], 0.F);
}

TEST(EnvironmentLevels, BadFloorFails) {
    const auto map = grey_map({1, 2});
    for (const float floor : {0.F, -1.F, std::numeric_limits<float>::quiet_NaN()})
        EXPECT_THROW((environment_levels<4>(map, floor)), std::invalid_argument);
}

// --- prefilter --------------------------------------------------------------------------------------------------

/// A room that is hard to filter: a texture everywhere, lamps, and a sun of one texel, 1e5 times as bright.
environment_map hard_map(std::size_t width, std::size_t height) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> texture(0.2F, 1.F);
    std::vector<colour> texels;
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const bool lamp = x * 16 / width == 3 && y * 16 / height == 6;
            const float lamp_light = lamp ? 100.F : 0.F;
            texels.push_back({texture(random) + lamp_light, texture(random) + lamp_light, texture(random)});
        }
    texels[(height / 3) * width + width * 5 / 8] = {1e5F, 0.9e5F, 0.7e5F};
    return environment_map(width, height, texels);
}

direction sun_of(const environment_map& map) {
    const auto width = map.image().width, height = map.image().height;
    return mica::direction_of({(static_cast<float>(width * 5 / 8) + 0.5F) / static_cast<float>(width),
                               (static_cast<float>(height / 3) + 0.5F) / static_cast<float>(height)});
}

/// All over the sphere, and half of them around the sun, where the error is.
std::vector<direction> test_directions(const environment_map& map, double roughness, int count) {
    random_directions random(5);
    std::mt19937 source(6);
    std::normal_distribution<double> around(0, 1.5 * roughness);
    std::vector<direction> result{sun_of(map), {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
    for (int i = 0; i < count; ++i) {
        const direction sun = sun_of(map);
        const direction beside{sun.x + static_cast<float>(around(source)), sun.y + static_cast<float>(around(source)),
                               sun.z + static_cast<float>(around(source))};
        result.push_back(mica::normalized(beside));
        result.push_back(random());
    }
    return result;
}

/// The kernel's weight from l around r, D(h) n.l with n = v = r.
double kernel(direction r, direction l, double alpha) {
    const double cosine = static_cast<double>(r.x) * static_cast<double>(l.x) +
                          static_cast<double>(r.y) * static_cast<double>(l.y) +
                          static_cast<double>(r.z) * static_cast<double>(l.z);
    if (cosine <= 0) return 0;
    const double n_dot_h = std::sqrt((1 + std::fmin(cosine, 1)) / 2);
    return cosine * mica::ggx_distribution(n_dot_h, alpha);
}

/// The plain sum over all texels, in double: luminance, at the texels' centres.
class plain_sum {
  public:
    explicit plain_sum(const environment_map& map) {
        const auto& image = map.image();
        for (std::size_t y = 0; y < image.height; ++y)
            for (std::size_t x = 0; x < image.width; ++x)
                texels_.push_back(
                    {mica::direction_of({(static_cast<float>(x) + 0.5F) / static_cast<float>(image.width),
                                         (static_cast<float>(y) + 0.5F) / static_cast<float>(image.height)}),
                     mica::texel_solid_angle(image.width, image.height, y),
                     static_cast<double>(mica::luminance(image.at(x, y)))});
    }

    double operator()(direction r, double alpha) const {
        double sum = 0, total = 0;
        for (const auto& texel : texels_) {
            const double weight = kernel(r, texel.centre, alpha) * texel.solid_angle;
            sum += weight * texel.luminance;
            total += weight;
        }
        return sum / total;
    }

  private:
    struct texel {
        direction centre;
        double solid_angle, luminance;
    };
    std::vector<texel> texels_;
};

struct filter_error {
    double relative = 0, to_peak = 0;
};

/// Errors of `filtered`, a function of direction, against the plain sum over the map.
template <class Filtered>
filter_error error_of(const environment_map& map, double roughness, int directions, const Filtered& filtered) {
    const plain_sum plain(map);
    double peak = 0, relative = 0, absolute = 0;
    for (const auto& r : test_directions(map, roughness, directions)) {
        const double truth = plain(r, roughness);
        const double error = std::abs(static_cast<double>(filtered(r)) - truth);
        peak = std::fmax(peak, truth);
        if (!(error <= absolute)) absolute = error;
        if (!(error / truth <= relative)) relative = error / truth;
    }
    return {relative, absolute / peak};
}

constexpr float filter_roughnesses[] = {0.02F, 0.05F, 0.1F, 0.2F, 0.4F, 0.7F, 1.F};

// The method itself: blocks of texels instead of texels. On a map whose texels are finer than the narrowest lobe.
TEST(Prefilter, BlocksAgreeWithThePlainSum) {
    const auto map = hard_map(256, 128);
    std::vector<std::array<float, 3>> values;
    for (const auto& texel : map.image().texels) values.push_back({texel.r, texel.g, texel.b});
    const mica::detail::texel_pyramid<3, 3> pyramid(256, 128, values);
    for (const float roughness : filter_roughnesses) {
        const auto error = error_of(map, static_cast<double>(roughness), 60, [&](direction r) {
            const auto value = pyramid.filtered(r, roughness, 0.3F, 0.12F);
            return mica::luminance(colour{value[0], value[1], value[2]});
        });
        std::printf("blocks, roughness %.2f: largest error %.2g relative, %.2g of the peak\n",
                    static_cast<double>(roughness), error.relative, error.to_peak);
        EXPECT_LE(error.to_peak, 0.02) << roughness;
    }
}

// What a program gets: the filtered images, interpolated. A lobe narrower than a texel (.02 here) is the map itself.
TEST(Prefilter, AgreesWithThePlainSum) {
    const auto map = hard_map(128, 64);
    const environment_levels<4> levels(map);
    const prefiltered_environment<4> environment(map, levels, filter_roughnesses);
    for (const float roughness : filter_roughnesses) {
        if (roughness < 0.04F) continue;
        const auto error = error_of(map, static_cast<double>(roughness), 150,
                                    [&](direction r) { return mica::luminance(environment(r, roughness).radiance); });
        std::printf("images, roughness %.2f: largest error %.2g relative, %.2g of the peak\n",
                    static_cast<double>(roughness), error.relative, error.to_peak);
        EXPECT_LE(error.to_peak, 0.03) << roughness;
    }
}

TEST(Prefilter, NarrowLobesAreTheMap) {
    const auto map = hard_map(128, 64);
    const environment_levels<4> levels(map);
    const prefiltered_environment<4> environment(map, levels, std::array{0.F, 0.02F, 0.1F});
    random_directions random(7);
    for (int i = 0; i < 1000; ++i) {
        const direction r = random();
        for (const float roughness : {0.F, 0.02F}) {
            const colour filtered = environment(r, roughness).radiance, texel = map(r);
            ASSERT_NEAR(filtered.r, texel.r, 4 * epsilon * texel.r);
            ASSERT_NEAR(filtered.b, texel.b, 4 * epsilon * texel.b);
        }
    }
}

TEST(Prefilter, ConstantStaysConstant) {
    const environment_map map(64, 32, std::vector<colour>(64 * 32, {3, 2, 1}));
    const prefiltered_environment<4> environment(map, environment_levels<4>(map), filter_roughnesses);
    random_directions random(8);
    for (int i = 0; i < 2000; ++i)
        for (const float roughness : {0.F, 0.02F, 0.07F, 0.3F, 1.F}) {
            const auto lobe = environment(random(), roughness);
            ASSERT_NEAR(lobe.radiance.r, 3.F, 3e-5F);
            ASSERT_NEAR(lobe.radiance.g, 2.F, 2e-5F);
            ASSERT_NEAR(lobe.radiance.b, 1.F, 1e-5F);
            ASSERT_NEAR(lobe.indicator[3], 1.F, 1e-5F);
        }
}

template <std::size_t K>
void expect_identities(const environment_map& map) {
    const environment_levels<K> levels(map);
    const prefiltered_environment<K> environment(map, levels, std::array{0.F, 0.1F, 0.5F, 1.F});
    double worst = 0;
    for (const auto& r : test_directions(map, 0.3, 300))
        for (const float roughness : {0.F, 0.05F, 0.1F, 0.4F, 1.F}) {
            const auto lobe = environment(r, roughness);
            double sum = 0, mean = 0;
            for (std::size_t k = 0; k < K; ++k) {
                ASSERT_GE(lobe.indicator[k], 0.F);
                sum += static_cast<double>(lobe.indicator[k]);
                mean += static_cast<double>(lobe.indicator[k]) * static_cast<double>(levels.radiance()[k]);
            }
            ASSERT_LE(std::abs(sum - 1), 1e-5);
            const double error = std::abs(mean / static_cast<double>(mica::luminance(lobe.radiance)) - 1);
            if (!(error <= worst)) worst = error;
        }
    std::printf("K = %zu: sum L w = L to %.2g\n", K, worst);
    EXPECT_LE(worst, 1e-4);
}

TEST(Prefilter, IndicatorsPartitionTheRadiance) {
    expect_identities<2>(hard_map(128, 64));
    expect_identities<4>(hard_map(128, 64));
    expect_identities<8>(hard_map(100, 37)); // sizes that are no powers of two
}

// Between the given roughnesses linear in perceptual roughness, beyond them the nearest.
TEST(Prefilter, InterpolatesRoughness) {
    const auto map = hard_map(64, 32);
    const prefiltered_environment<2> environment(map, environment_levels<2>(map), std::array{0.09F, 0.25F, 0.81F});
    const auto at = [&](float roughness) { return environment(sun_of(map), roughness).radiance.r; };
    EXPECT_NEAR(at(0.16F) / ((at(0.09F) + at(0.25F)) / 2), 1.F, 1e-5F);
    EXPECT_NEAR(at(0.49F) / (at(0.25F) * 0.5F + at(0.81F) * 0.5F), 1.F, 1e-5F);
    EXPECT_EQ(at(0.F), at(0.09F));
    EXPECT_EQ(at(1.F), at(0.81F));
    EXPECT_NEAR(at(0.24999F) / at(0.25F), 1.F, 1e-3F); // no jump where one image takes over from the next
    EXPECT_NEAR(at(0.25001F) / at(0.25F), 1.F, 1e-3F);
}

// Rows may run side by side, so none may depend on another.
struct backward_loop {
    template <class Body>
    void operator()(std::size_t count, const Body& body) const {
        for (std::size_t i = count; i-- > 0;) body(i);
    }
};

TEST(Prefilter, RowsInAnyOrder) {
    const auto map = hard_map(64, 32);
    const environment_levels<2> levels(map);
    const std::array roughness{0.3F};
    const prefiltered_environment<2> forward(map, levels, roughness), backward(map, levels, roughness, backward_loop{});
    random_directions random(9);
    for (int i = 0; i < 500; ++i) {
        const direction r = random();
        ASSERT_EQ(forward(r, 0.3F).radiance.g, backward(r, 0.3F).radiance.g);
    }
}

TEST(Prefilter, TinyAndBlackMaps) {
    for (const auto& map : {environment_map(1, 1, {{0, 0, 0}}), environment_map(1, 1, {{2, 2, 2}}),
                            environment_map(3, 1, {{0, 0, 0}, {1e30F, 1e30F, 1e30F}, {1, 1, 1}}),
                            environment_map(1, 5, std::vector<colour>(5, {1e-40F, 0, 0}))}) {
        const prefiltered_environment<4> environment(map, environment_levels<4>(map),
                                                     std::array{0.F, 0.01F, 0.3F, 1.F});
        random_directions random(10);
        for (int i = 0; i < 100; ++i)
            for (const float roughness : {0.F, 0.005F, 0.1F, 1.F}) {
                const auto lobe = environment(random(), roughness);
                ASSERT_TRUE(std::isfinite(lobe.radiance.r) && lobe.radiance.r >= 0);
                float sum = 0;
                for (const float w : lobe.indicator) sum += w;
                ASSERT_NEAR(sum, 1.F, 1e-5F);
            }
    }
}

TEST(Prefilter, BadRoughnessesFail) {
    const auto map = grey_map({1, 2});
    const environment_levels<2> levels(map);
    const auto build = [&](std::vector<float> roughnesses) { prefiltered_environment<2>(map, levels, roughnesses); };
    EXPECT_THROW(build({}), std::invalid_argument);
    EXPECT_THROW(build({-0.1F}), std::invalid_argument);
    EXPECT_THROW(build({std::numeric_limits<float>::quiet_NaN()}), std::invalid_argument);
    EXPECT_THROW(build({0.2F, 0.1F}), std::invalid_argument);
    EXPECT_THROW(build({0.2F, 0.2F}), std::invalid_argument);
    EXPECT_NO_THROW(build({0.F, 0.2F}));
}

/// The blocks' directions are sums of radiance; they must neither overflow nor vanish.
TEST(Prefilter, ScalesWithTheMap) {
    const auto filtered_at = [](float scale) {
        std::vector<colour> texels;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 128; ++x) {
                const float radiance = scale * (1 + (x < 64 ? 3.F : 0.F) + (y < 32 ? 1.F : 0.F));
                texels.push_back({radiance, radiance, radiance});
            }
        const mica::environment_map map(128, 64, std::move(texels));
        const float roughness = 0.3F;
        const mica::prefiltered_environment<2> filtered(map, mica::environment_levels<2>(map, 1e-35F), {&roughness, 1});
        return filtered({0.6F, 0.64F, 0.48F}, roughness).radiance.r / scale;
    };
    const float expected = filtered_at(1);
    for (const float scale : {1e-30F, 1e-20F, 1e10F, 1e20F, 1e29F})
        EXPECT_NEAR(filtered_at(scale), expected, 1e-4) << scale;
}

} // namespace
