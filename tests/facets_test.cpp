// Explicit facets: in a footprint of any shape they flash as a binomial of those that are there says, and with uniform
// positions as a Poisson distribution; blended variates agree with them.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <mica/grid/distributed.hpp>
#include <mica/law/exact.hpp>
#include <mica/reference/facets.hpp>

#include "statistics.hpp"

namespace {

using mica::reference::ellipse;
using mica::reference::facet_positions;
using mica::reference::facet_set;
using mica::reference::flash;

/// Footprints of one shape that hold so many facets, anywhere.
class random_footprints {
  public:
    random_footprints(double facets, double ratio, double density, unsigned seed)
        : width_(std::sqrt(facets / (density * ratio))), ratio_(ratio), random_(seed) {}

    ellipse operator()() {
        const double turn = 6.283185307 * unit_(random_), c = std::cos(turn), s = std::sin(turn);
        return {unit_(random_), unit_(random_), ratio_ * width_ * c, ratio_ * width_ * s, -width_ * s, width_ * c};
    }

  private:
    double width_, ratio_;
    std::mt19937 random_;
    std::uniform_real_distribution<double> unit_{0, 1};
};

class Facets : public ::testing::TestWithParam<std::pair<double, double>> {}; // facets, ratio

// Given that there are n facets, n p of them flash on average, with variance n p q, and none does with probability q^n.
TEST_P(Facets, FlashAsTheirBinomial) {
    const auto [facets, ratio] = GetParam();
    for (const auto positions : {facet_positions::uniform, facet_positions::jittered})
        for (const double p : {0.02, 0.2, 0.5}) {
            statistics::running_moments standardised;
            double dark = 0, expected_dark = 0, dark_variance = 0;
            for (unsigned seed = 0; seed < 4; ++seed) {
                const facet_set set(400, positions, seed);
                random_footprints random(facets, ratio, set.density(), seed);
                // So many that they hardly share facets.
                const int pixels = static_cast<int>(set.density() / facets / 2);
                for (int i = 0; i < pixels; ++i) {
                    const auto [n, flashes] = set.count(random(), flash::with_probability(p));
                    const auto count = static_cast<double>(n), lit = static_cast<double>(flashes);
                    if (n > 0) standardised.add((lit - count * p) / std::sqrt(count * p * (1 - p)));
                    const double none = std::pow(1 - p, count);
                    dark += flashes == 0;
                    expected_dark += none;
                    dark_variance += none * (1 - none);
                }
            }
            EXPECT_LE(std::abs(standardised.mean()), 4.5 * standardised.standard_error());
            EXPECT_LE(std::abs(dark - expected_dark), 4.5 * std::sqrt(dark_variance) + 3);
            // The kurtosis is at most 3 + 1 / (n p q).
            const double error = std::sqrt((2 + 1 / (facets * p * (1 - p))) / standardised.count());
            EXPECT_LE(std::abs(standardised.variance() - 1), 6 * error) << facets << ' ' << ratio << ' ' << p;
        }
}

TEST_P(Facets, NumberInAFootprint) {
    const auto [facets, ratio] = GetParam();
    for (const auto positions : {facet_positions::uniform, facet_positions::jittered}) {
        statistics::running_moments number;
        for (unsigned seed = 0; seed < 4; ++seed) {
            const facet_set set(400, positions, 10 + seed);
            random_footprints random(facets, ratio, set.density(), seed);
            const int pixels = static_cast<int>(set.density() / facets / 2);
            for (int i = 0; i < pixels; ++i)
                number.add(static_cast<double>(set.count(random(), flash::with_probability(0.5)).facets));
        }
        EXPECT_LE(std::abs(number.mean() - facets), 6 * number.standard_error());
        const double relative = number.variance() / facets;
        if (positions == facet_positions::uniform)
            EXPECT_LE(std::abs(relative - 1), 6 * std::sqrt((2 + 1 / facets) / number.count()));
        else
            EXPECT_LE(relative, 1.) << "jittered positions vary less";
    }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Facets,
                         ::testing::Values(std::pair{0.5, 1.}, std::pair{8., 4.}, std::pair{50., 16.},
                                           std::pair{50., 1.}, std::pair{200., 64.}));

// With uniform positions the flashes in a footprint are Poisson distributed with mean N p.
TEST(Facets, OfUniformPositionsArePoisson) {
    const double facets = 20, p = 0.1, mean = facets * p;
    statistics::running_moments flashes, dark;
    for (unsigned seed = 0; seed < 20; ++seed) {
        const facet_set set(400, facet_positions::uniform, 100 + seed);
        random_footprints random(facets, 4, set.density(), seed);
        for (int i = 0; i < 4000; ++i) {
            const auto count = set.count(random(), flash::with_probability(p)).flashes;
            flashes.add(static_cast<double>(count));
            dark.add(count == 0);
        }
    }
    EXPECT_LE(std::abs(flashes.mean() - mean), 6 * flashes.standard_error());
    EXPECT_LE(std::abs(flashes.variance() / mean - 1), 6 * std::sqrt((2 + 1 / mean) / flashes.count()));
    EXPECT_LE(std::abs(dark.mean() - std::exp(-mean)), 6 * dark.standard_error());
}

// Footprints that hold just N facets, and blended variates of N: the same mean, variance and share of dark pixels.
TEST(Facets, AgreeWithBlendedVariates) {
    const std::size_t facets = 30;
    const float p = 0.05F;
    statistics::running_moments flashes, dark, counts, dark_counts;
    for (unsigned seed = 0; seed < 20; ++seed) {
        const facet_set set(400, facet_positions::jittered, 200 + seed);
        random_footprints random(static_cast<double>(facets), 5, set.density(), seed);
        for (int i = 0; i < 4000; ++i) {
            const auto found = set.count(random(), flash::with_probability(static_cast<double>(p)));
            if (found.facets != facets) continue;
            flashes.add(static_cast<double>(found.flashes));
            dark.add(found.flashes == 0);
        }
    }
    for (std::uint32_t i = 0; i < 100000; ++i) {
        mica::uniform_stream<float> place(3, i);
        const mica::uv_point<float> uv{place(), place()};
        const auto pixel = mica::make_footprint<float>({0.004F, 0.003F, -0.0006F, 0.0008F});
        const auto vertices = mica::make_grid_vertices(pixel, uv, static_cast<float>(facets), i);
        const float count = mica::distributed_binomial<mica::exact_binomial>{}(vertices, p);
        counts.add(static_cast<double>(count));
        dark_counts.add(count == 0);
    }
    ASSERT_GE(flashes.count(), 5000);
    const auto differ = [](const auto& a, const auto& b) {
        return std::abs(a.mean() - b.mean()) / std::hypot(a.standard_error(), b.standard_error());
    };
    EXPECT_LE(differ(flashes, counts), 4.5);
    EXPECT_LE(differ(dark, dark_counts), 4.5);
    EXPECT_LE(std::abs(flashes.variance() / counts.variance() - 1), 6 * std::sqrt(2.7 / flashes.count()));
}

TEST(Facets, BadArgumentsFail) {
    EXPECT_THROW(facet_set(0, facet_positions::uniform, 1), std::invalid_argument);
    const facet_set set(10, facet_positions::uniform, 1);
    EXPECT_EQ(set.count({0.5, 0.5, 0, 0, 0, 0}, flash::with_probability(1)).facets, 0U); // no footprint, no facets
    const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {infinity, -infinity, nan}) {
        EXPECT_EQ(set.count({0.5, 0.5, bad, 0, 0, 1}, flash::with_probability(1)).facets, 0U);
        EXPECT_EQ(set.count({0.5, bad, 1, 0, 0, 1}, flash::with_probability(1)).facets, 0U);
    }
    EXPECT_THROW(set.count({0.5, 0.5, 1e30, 0, 0, 1e30}, flash::with_probability(1)), std::invalid_argument);
    // All of them, twice in each direction.
    EXPECT_NEAR(static_cast<double>(set.count({0.5, 0.5, 2, 0, 0, 2}, flash::with_probability(1)).flashes), 400, 40);
}

} // namespace
