// The kernel and its effects: whatever it is composed of, its mean is the smooth radiance, it evaluates the binomials that
// it says, packs and scalars agree, and nothing jumps.

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/shade/glint_kernel.hpp>

#include "statistics.hpp"

namespace {

using mica::angular_grid;
using mica::blended_variates;
using mica::effects;
using mica::glint_kernel;
using mica::interpolated_counts;
using mica::light_class;
using mica::no_glints;
using mica::one_grid;
using mica::smooth_where_dense;
using mica::softened_variates;
using mica::tinted_glints;
using mica::varied_density;
using colour = mica::rgb<float>;
using law = mica::quantile_binomial<4>;
using point = mica::shading_point<float>;
template <std::size_t K>
using light = std::array<light_class<float>, K>;

constexpr float pixel_width = 0x1p-9F;

/// A pixel of ratio 2.
point pixel_at(float u, float v) {
    return {{0, 0, 1}, {0, 0, 1}, {u, v}, {2 * pixel_width, 0, 0, pixel_width}, {1, 0, 0}, {}};
}

mica::glint_material facets(float trials) {
    mica::glint_material material;
    material.log_density = std::log(trials / (2 * pixel_width * pixel_width));
    return material;
}

/// Three lamps that leave most facets dark, and an environment of four classes, all of whose facets flash somewhere.
const light<3> lamps{{{{5, 1, 0.2F}, 0.02F}, {{0.1F, 1, 3}, 0.1F}, {{1, 1, 1}, 0.003F}}};
const light<4> sky{{{{0.1F, 0.1F, 0.2F}, 0.6F}, {{0.3F, 0.3F, 0.3F}, 0.3F}, {{2, 1, 0.5F}, 0.09F}, {{1, 3, 1}, 0.01F}}};

// --- what it evaluates ------------------------------------------------------------------------------------------

/// The quantile law, counting its calls.
struct counting_law {
    static constexpr bool integer_counts = true;
    inline static std::size_t calls = 0;
    template <class Real, class Uniform>
    mica::counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        ++calls;
        return law{}(trials, probability, xi);
    }
};

template <class Kernel, std::size_t K>
void expect_binomials(const light<K>& lights, std::size_t categories, std::size_t expected) {
    counting_law::calls = 0;
    Kernel{}(pixel_at(0.3F, 0.4F), facets(100), lights, {0.1F, 0.2F, 0.9F}, 1);
    EXPECT_EQ(counting_law::calls, expected);
    EXPECT_EQ(Kernel::binomials(categories), expected);
}

TEST(Composition, BinomialsPerPixel) {
    const light<1> lamp{lamps[0]};
    using angular = effects<angular_grid>;
    expect_binomials<glint_kernel<no_glints>>(lamp, 1, 0);
    expect_binomials<glint_kernel<counting_law>>(lamp, 1, 1);
    expect_binomials<glint_kernel<counting_law, blended_variates, angular>>(lamp, 1, 1);
    expect_binomials<glint_kernel<counting_law, interpolated_counts>>(lamp, 1, 12);
    expect_binomials<glint_kernel<counting_law, interpolated_counts, angular>>(lamp, 1, 48);
    expect_binomials<glint_kernel<counting_law>>(lamps, 3, 3); // not 3 x 48
    expect_binomials<glint_kernel<counting_law>>(sky, 3, 3);   // K - 1
    expect_binomials<glint_kernel<counting_law, interpolated_counts>>(sky, 3, 36);
    expect_binomials<glint_kernel<counting_law, interpolated_counts, effects<one_grid>>>(sky, 3, 9);
    expect_binomials<glint_kernel<counting_law, interpolated_counts, effects<one_grid, angular_grid>>>(lamp, 1, 12);
    expect_binomials<glint_kernel<counting_law, blended_variates, effects<varied_density, tinted_glints>>>(sky, 3, 3);
}

TEST(Composition, EffectsTakeNoRoomThatTheyDoNotNeed) {
    EXPECT_EQ(sizeof(glint_kernel<law>), 1U);
    EXPECT_EQ(sizeof(glint_kernel<law, blended_variates, effects<tinted_glints>>), sizeof(float));
}

// --- the mean ---------------------------------------------------------------------------------------------------

/// The mean of a pixel's bands over many realisations, as parts of the smooth ones.
template <class Kernel, std::size_t K>
void expect_mean_is_smooth(const Kernel& kernel, const light<K>& lights, float trials, const char* what,
                           double tolerance = 0) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1);
    std::array<statistics::running_moments, 3> bands;
    for (std::uint32_t seed = 0; seed < 30000; ++seed) {
        const mica::vector3<float> half_vector{unit(random) - 0.5F, unit(random) - 0.5F, 0.8F};
        const auto radiance = kernel(pixel_at(unit(random), unit(random)), facets(trials), lights, half_vector, seed);
        bands[0].add(static_cast<double>(radiance.glint.r / radiance.smooth.r));
        bands[1].add(static_cast<double>(radiance.glint.g / radiance.smooth.g));
        bands[2].add(static_cast<double>(radiance.glint.b / radiance.smooth.b));
    }
    for (const auto& band : bands)
        EXPECT_LE(std::abs(band.mean() - 1), 4.5 * band.standard_error() + tolerance)
            << what << ", " << K << " classes, N " << trials << ": " << band.mean() << " +- " << band.standard_error();
}

template <class Kernel>
void expect_mean_is_smooth(const Kernel& kernel, const char* what, double tolerance = 0) {
    for (const float trials : {0.7F, 20.F, 3000.F}) {
        expect_mean_is_smooth(kernel, lamps, trials, what, tolerance);
        expect_mean_is_smooth(kernel, sky, trials, what, tolerance);
    }
}

template <class Interpolation, class... Effect>
constexpr auto composed(Interpolation interpolation, Effect... effect) {
    return glint_kernel<law, Interpolation, effects<Effect...>>{interpolation, {effect...}};
}

TEST(Kernel, MeanIsSmooth) {
    expect_mean_is_smooth(composed(blended_variates{}), "variates");
    expect_mean_is_smooth(composed(interpolated_counts{}), "counts");
    expect_mean_is_smooth(composed(softened_variates{0.2F}), "softened");
    expect_mean_is_smooth(composed(blended_variates{}, angular_grid{0.1F}), "angular grid");
    expect_mean_is_smooth(composed(blended_variates{}, varied_density{0.7F}), "varied density", 0.002);
    expect_mean_is_smooth(composed(blended_variates{}, tinted_glints{0.7F}), "tinted", 0.002);
    expect_mean_is_smooth(composed(blended_variates{}, smooth_where_dense{0.2F}), "smooth where dense");
    expect_mean_is_smooth(composed(interpolated_counts{}, one_grid{3}), "one grid");
    expect_mean_is_smooth(composed(blended_variates{}, angular_grid{0.1F}, varied_density{0.5F}, tinted_glints{0.5F},
                                   smooth_where_dense{0.1F}),
                          "all together", 0.002);
}

TEST(Kernel, LightsThatCoverEachOtherKeepTheirMean) {
    const light<3> overlapping{{{{5, 1, 0.2F}, 0.9F}, {{0.1F, 1, 3}, 0.7F}, {{1, 1, 1}, 0.4F}}};
    for (const float trials : {0.7F, 20.F})
        expect_mean_is_smooth(composed(blended_variates{}), overlapping, trials, "");
}

// --- lanes ------------------------------------------------------------------------------------------------------

using wide = mica::pack<float, 8>;

wide lanes_from(const auto& value) {
    wide result{};
    for (int i = 0; i < 8; ++i) mica::set_lane(result, i, value(i));
    return result;
}

TEST(Kernel, PacksEqualScalars) {
    const auto kernel = composed(blended_variates{}, angular_grid{0.05F}, varied_density{0.5F}, tinted_glints{0.4F},
                                 smooth_where_dense{0.1F});
    std::array<light_class<wide>, 4> classes;
    for (std::size_t k = 0; k < 4; ++k)
        classes[k] = {{wide(sky[k].smooth.r), wide(sky[k].smooth.g), wide(sky[k].smooth.b)}, wide(sky[k].probability)};
    for (std::uint32_t seed = 0; seed < 500; ++seed) {
        const auto u = [seed](int i) { return 0.001F * static_cast<float>(seed) + 0.1F * static_cast<float>(i); };
        const float trials = 0.5F * static_cast<float>(1U << seed % 16);
        const mica::shading_point<wide> eight{
            {wide(0), wide(0), wide(1)}, {wide(0), wide(0), wide(1)},
            {lanes_from(u), wide(0.3F)}, {wide(2 * pixel_width), wide(0), wide(0), wide(pixel_width)},
            {wide(1), wide(0), wide(0)}, {}};
        const auto together = kernel(eight, facets(trials), classes, {lanes_from(u), wide(0.1F), wide(0.9F)}, seed);
        for (int i = 0; i < 8; ++i) {
            const auto alone = kernel(pixel_at(u(i), 0.3F), facets(trials), sky, {u(i), 0.1F, 0.9F}, seed);
            EXPECT_FLOAT_EQ(mica::lane(together.glint.r, i), alone.glint.r);
            EXPECT_FLOAT_EQ(mica::lane(together.glint.b, i), alone.glint.b);
        }
    }
}

// --- effect by effect -------------------------------------------------------------------------------------------

// The three scales of WDH20: less than 4 particles in a footprint, 4 to 64, and more, which are smooth.
TEST(SmoothWhereDense, ThreeScales) {
    const light<1> half{{{{1, 1, 1}, 0.5F}}};
    const auto all = composed(blended_variates{});
    const auto switched = composed(blended_variates{}, smooth_where_dense{0.125F}); // at N = 64
    const auto radiance = [&half](const auto& kernel, float trials, std::uint32_t seed) {
        return kernel(pixel_at(0.1F, 0.2F), facets(trials), half, {}, seed).glint.g;
    };
    for (std::uint32_t seed = 0; seed < 2000; ++seed) {
        for (const float trials : {0.5F, 3.F, 15.9F})
            EXPECT_FLOAT_EQ(radiance(switched, trials, seed), radiance(all, trials, seed));
        for (const float trials : {64.1F, 1e3F, 1e12F}) EXPECT_EQ(radiance(switched, trials, seed), 1.F);
        // In between the deviation is sqrt(1 / 36) = 0.1667, a third of the way from one tolerance to two.
        EXPECT_NEAR(radiance(switched, 36, seed) - 1, (radiance(all, 36, seed) - 1) / 3, 1e-4);
    }
}

TEST(SmoothWhereDense, DoesNotJump) {
    const auto kernel = composed(blended_variates{}, smooth_where_dense{0.125F});
    const light<1> half{{{{1, 1, 1}, 0.5F}}};
    float before = 0, largest = 0;
    for (int i = 0; i <= 20000; ++i) {
        const float trials = 10 * std::pow(10.F, static_cast<float>(i) / 20000);
        const auto smooth_kernel =
            glint_kernel<mica::smooth_quantile_binomial<4>, blended_variates, effects<smooth_where_dense>>{
                {}, kernel.effect};
        const float now = smooth_kernel(pixel_at(0.1F, 0.2F), facets(trials), half, {}, 3).glint.g;
        if (i > 0) largest = std::max(largest, std::abs(now - before));
        before = now;
    }
    EXPECT_LT(largest, 0.002F);
}

TEST(VariedDensity, SpreadsTheCounts) {
    const light<1> lamp{{{{1, 1, 1}, 0.1F}}};
    statistics::running_moments even, varied;
    const float deviation = 0.4F;
    for (std::uint32_t seed = 0; seed < 20000; ++seed) {
        const auto at = pixel_at(0.1F, 0.2F);
        even.add(static_cast<double>(composed(blended_variates{})(at, facets(1e4F), lamp, {}, seed).glint.g));
        varied.add(static_cast<double>(
            composed(blended_variates{}, varied_density{deviation})(at, facets(1e4F), lamp, {}, seed).glint.g));
    }
    // The blend of the vertices' z is standard normal: the variance of exp(s z - s^2 / 2) is exp(s^2) - 1.
    EXPECT_NEAR(even.variance(), 0.9 / 1000, 5e-5);
    const double lognormal = std::expm1(0.16);
    EXPECT_NEAR(varied.variance(), lognormal, 0.1 * lognormal);
}

TEST(TintedGlints, ColoursFewAndNotMany) {
    const light<1> lamp{{{{1, 1, 1}, 0.01F}}};
    const auto kernel = composed(blended_variates{}, tinted_glints{0.5F});
    for (const float flashes : {0.5F, 1e6F}) {
        statistics::running_moments colourfulness;
        for (std::uint32_t seed = 0; seed < 3000; ++seed) {
            const auto glint = kernel(pixel_at(0.1F, 0.2F), facets(100 * flashes), lamp, {}, seed).glint;
            if (glint.g > 0) colourfulness.add(static_cast<double>(std::log(glint.r / glint.b)));
        }
        // The difference of two bands has three times the variance of one.
        const double deviation = std::sqrt(colourfulness.variance());
        if (flashes < 1)
            EXPECT_NEAR(deviation, 0.5 * std::sqrt(3.), 0.1);
        else
            EXPECT_LT(deviation, 2e-3);
    }
}

// A glint keeps its colour from pixel to pixel while it is alone.
TEST(TintedGlints, StayWhatTheyAre) {
    const light<1> lamp{{{{1, 1, 1}, 0.01F}}};
    const auto kernel = composed(blended_variates{}, tinted_glints{0.5F});
    statistics::running_moments change;
    for (std::uint32_t seed = 0; seed < 20000; ++seed) {
        const auto here = kernel(pixel_at(0.1F, 0.2F), facets(10), lamp, {}, seed).glint;
        const auto beside = kernel(pixel_at(0.1F + 0.1F * pixel_width, 0.2F), facets(10), lamp, {}, seed).glint;
        if (here.g > 0 && beside.g > 0)
            change.add(static_cast<double>(std::log(here.r / here.b) - std::log(beside.r / beside.b)));
    }
    EXPECT_GT(change.count(), 500U);
    EXPECT_LT(std::sqrt(change.variance()), 0.1);
}

// Counts of half vectors within a tenth of a cell are nearly the same, of those three cells apart independent.
TEST(AngularGrid, GlintsLiveAsLongAsTheirHalfVector) {
    const light<1> lamp{{{{1, 1, 1}, 0.1F}}};
    const float roughness = 0.05F;
    const auto kernel = composed(blended_variates{}, angular_grid{roughness});
    const auto correlation = [&](float distance) {
        double products = 0, squares = 0;
        constexpr std::uint32_t samples = 10000;
        for (std::uint32_t seed = 0; seed < samples; ++seed) {
            const float x = 0.001F * static_cast<float>(seed % 1000);
            const auto at = [&](float h) {
                return static_cast<double>(
                    kernel(pixel_at(x, 0.2F), facets(1000), lamp, {h, 0.3F, 0.9F}, seed).glint.g - 1);
            };
            const double first = at(x);
            products += first * at(x + distance * roughness);
            squares += first * first;
        }
        return products / squares;
    };
    EXPECT_GT(correlation(0.1F), 0.95);
    EXPECT_NEAR(correlation(3), 0, 4.5 / std::sqrt(10000.));
}

TEST(OneGrid, FramesAverageToAllGrids) {
    const light<1> lamp{{{{1, 1, 1}, 0.02F}}};
    double difference = 0;
    for (std::uint32_t seed = 0; seed < 50; ++seed) {
        const auto at = pixel_at(0.02F * static_cast<float>(seed), 0.2F);
        const float all = composed(interpolated_counts{})(at, facets(100), lamp, {}, seed).glint.g;
        statistics::running_moments frames;
        for (std::uint32_t frame = 0; frame < 4000; ++frame)
            frames.add(static_cast<double>(
                composed(interpolated_counts{}, one_grid{frame})(at, facets(100), lamp, {}, seed).glint.g));
        // The grids' trials are drawn as one quarter of N and as N, so the counts of a vertex differ, and their mean does not.
        difference += frames.mean() - static_cast<double>(all);
    }
    EXPECT_NEAR(difference / 50, 0, 0.4);
}

// --- a moving camera --------------------------------------------------------------------------------------------

constexpr int side = 32;
using frame = std::array<float, side * side>;

/// A patch seen by a camera that pans, turns and moves away by an octave, as the time goes from 0 to 1, and whose eye turns
/// around the light.
template <class Kernel>
frame frame_at(const Kernel& kernel, float time) {
    const light<1> lamp{{{{1, 1, 1}, 0.01F}}};
    const float width = pixel_width * std::exp2(time), c = std::cos(time) * width, s = std::sin(time) * width;
    mica::glint_material material;
    material.log_density = std::log(3 / (pixel_width * pixel_width));
    frame radiance;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const float across = static_cast<float>(x) - side / 2.F, down = static_cast<float>(y) - side / 2.F;
            const point seen{
                {0, 0, 1},     {0, 0, 1}, {0.3F + 0.02F * time + c * across - s * down, 0.3F + s * across + c * down},
                {c, s, -s, c}, {1, 0, 0}, {}};
            radiance[static_cast<std::size_t>(y * side + x)] =
                kernel(seen, material, lamp, {0.2F * time, 0.1F, 0.9F}, 1).glint.g;
        }
    return radiance;
}

/// The larger side of the largest set of neighbouring pixels that are marked; unmarks them.
int largest_extent(std::array<bool, side * side>& marked) {
    int largest = 0;
    for (int first = 0; first < side * side; ++first) {
        if (!marked[static_cast<std::size_t>(first)]) continue;
        std::vector<int> waiting{first};
        marked[static_cast<std::size_t>(first)] = false;
        int left = side, right = -1, top = side, bottom = -1;
        while (!waiting.empty()) {
            const int x = waiting.back() % side, y = waiting.back() / side;
            waiting.pop_back();
            left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
            for (int j = std::max(y - 1, 0); j <= std::min(y + 1, side - 1); ++j)
                for (int i = std::max(x - 1, 0); i <= std::min(x + 1, side - 1); ++i)
                    if (auto& mark = marked[static_cast<std::size_t>(j * side + i)]; mark) {
                        mark = false;
                        waiting.push_back(j * side + i);
                    }
        }
        largest = std::max({largest, right - left + 1, bottom - top + 1});
    }
    return largest;
}

// Between two frames only single glints come and go: what changes at once is no larger than a glint is, and no frame changes
// much more than others do, though the camera passes two levels of the grids, and many orientations and half vectors.
template <class Kernel>
void expect_no_popping(const Kernel& kernel, const char* what) {
    constexpr int frames = 400;
    int largest_glint = 0, largest_change = 0;
    statistics::running_moments changes;
    double most = 0;
    frame before = frame_at(kernel, 0);
    for (int i = 1; i <= frames; ++i) {
        const frame now = frame_at(kernel, static_cast<float>(i) / frames);
        std::array<bool, side * side> lit, changed;
        double count = 0;
        for (std::size_t k = 0; k < now.size(); ++k) {
            lit[k] = now[k] > 0;
            changed[k] = (now[k] > 0) != (before[k] > 0);
            count += changed[k];
        }
        changes.add(count);
        most = std::max(most, count);
        largest_glint = std::max(largest_glint, largest_extent(lit));
        largest_change = std::max(largest_change, largest_extent(changed));
        before = now;
    }
    std::printf("%s: a frame changes %.1f of %d pixels, at most %.0f; glints are up to %d wide, changes %d\n", what,
                changes.mean(), side * side, most, largest_glint, largest_change);
    EXPECT_LE(largest_change, largest_glint) << what;
    EXPECT_LE(most, changes.mean() + 6 * std::sqrt(changes.variance())) << what;
    EXPECT_LT(changes.mean(), 0.01 * side * side) << what;
    EXPECT_GT(changes.mean(), 0.5) << what;
}

TEST(MovingCamera, NothingPops) {
    expect_no_popping(composed(blended_variates{}), "variates");
    expect_no_popping(composed(blended_variates{}, angular_grid{0.05F}), "angular grid");
    expect_no_popping(composed(blended_variates{}, varied_density{0.5F}), "varied density");
}

TEST(Kernel, SameBytesForTheSameSeed) {
    const auto kernel = composed(blended_variates{}, tinted_glints{0.4F});
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        const auto first = kernel(pixel_at(0.1F, 0.7F), facets(50), sky, {}, seed).glint;
        const auto again = kernel(pixel_at(0.1F, 0.7F), facets(50), sky, {}, seed).glint;
        EXPECT_EQ(first.r, again.r);
        EXPECT_EQ(first.b, again.b);
    }
}

} // namespace
