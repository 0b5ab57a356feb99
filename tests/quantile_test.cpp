// The quantile laws against the binomial, computed and not sampled: n does not increase with xi, so the probability of
// every outcome is found by bisection over the 2^31 uniforms that a stream can give.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/random/uniform_stream.hpp>

#include "statistics.hpp"

namespace {

constexpr std::uint32_t last_uniform = 0x7fffffffU;

/// The uniform of 31 bits.
float uniform_of(std::uint32_t bits) { return mica::uniform_from_bits<float>(bits << 1); }

/// A law's successes at one uniform; a second one, asked for by the rounding of real trials, is given too.
template <class Law>
double successes_at(float trials, float probability, float xi, float rounding_xi = 0.5F) {
    int drawn = 0;
    const auto counts = Law{}(trials, probability, [&] { return drawn++ == 0 ? xi : rounding_xi; });
    return static_cast<double>(counts.successes);
}

/// P(successes >= k): how many of the 2^31 uniforms give that.
template <class Law>
double at_least(double k, float trials, float probability) {
    const auto holds = [&](std::uint32_t bits) {
        return successes_at<Law>(trials, probability, uniform_of(bits)) >= k;
    };
    if (!holds(0)) return 0;
    if (holds(last_uniform)) return 1;
    std::uint32_t yes = 0, no = last_uniform;
    while (no - yes > 1) {
        const std::uint32_t middle = yes + (no - yes) / 2;
        (holds(middle) ? yes : no) = middle;
    }
    return (static_cast<double>(yes) + 1) / 0x1p31;
}

/// How far a law is from the binomial: total variation, and mean and variance relative to the binomial's.
struct deviation {
    double total_variation, mean, variance;
};

template <class Law>
deviation deviation_of(float trials, float probability) {
    const double n = static_cast<double>(trials), p = static_cast<double>(probability), mean = n * p;
    const double spread = std::sqrt(mean * (1 - p));
    const double first = std::max(0., std::floor(mean - 9 * spread - 12));
    const double last = std::min(n, std::ceil(mean + 9 * spread + 40));
    const boost::math::binomial_distribution<double> binomial(n, p);

    double above = at_least<Law>(first, trials, probability);
    double distance = std::abs(1 - above - (first > 0 ? cdf(binomial, first - 1) : 0));
    double first_moment = (1 - above) * (first - 1 - mean), second_moment = 0;
    for (double k = first; k <= last; k += 1) {
        const double next = at_least<Law>(k + 1, trials, probability);
        const double mass = above - next;
        distance += std::abs(mass - pdf(binomial, k));
        first_moment += mass * (k - mean);
        second_moment += mass * (k - mean) * (k - mean);
        above = next;
    }
    const double variance = second_moment - first_moment * first_moment;
    return {(distance + above) / 2, first_moment / mean, variance / (mean * (1 - p)) - 1};
}

/// Calls body(trials, probability, whether successes are the rare side) on the grid of the law's stated error.
void over_the_stated_grid(const std::function<void(float, float, bool)>& body) {
    for (const float trials : {3.F, 4.F, 5.F, 8.F, 12.F, 16.F, 32.F, 64.F, 256.F, 1024.F, 1e5F, 1e7F})
        for (double mean = 1e-3; mean <= 300; mean *= 1.25) {
            const auto p = static_cast<float>(mean / static_cast<double>(trials));
            if (!(p <= 0.5F)) continue;
            body(trials, p, true);
            // The mirrored tail has the resolution of 1 - p and of 1 - xi, 2^-24.
            if (p > 1e-4F) body(trials, 1 - p, false);
        }
}

template <int Gates>
void expect_deviation_at_most(double total_variation, double mean, double variance) {
    deviation worst{0, 0, 0};
    over_the_stated_grid([&](float trials, float p, bool successes_are_rare) {
        const deviation found = deviation_of<mica::quantile_binomial<Gates>>(trials, p);
        // Errors are relative to the rarer of successes and failures.
        const double odds = static_cast<double>(p) / (1 - static_cast<double>(p));
        const double mean_error = std::abs(found.mean) * (successes_are_rare ? 1 : odds);
        EXPECT_LE(found.total_variation, total_variation) << trials << ' ' << p;
        EXPECT_LE(mean_error, mean) << trials << ' ' << p;
        EXPECT_LE(std::abs(found.variance), variance) << trials << ' ' << p;
        worst = {std::fmax(worst.total_variation, found.total_variation), std::fmax(worst.mean, mean_error),
                 std::fmax(worst.variance, std::abs(found.variance))};
    });
    std::printf("%d gates: total variation %.2g, mean %.2g, variance %.2g\n", Gates, worst.total_variation, worst.mean,
                worst.variance);
}

TEST(QuantileBinomial, FourGatesAreAsCloseAsStated) { expect_deviation_at_most<4>(8e-4, 1.2e-3, 9e-3); }
TEST(QuantileBinomial, EightGatesAreAsCloseAsStated) { expect_deviation_at_most<8>(1e-4, 1e-4, 1e-3); }

/// Two gates less, or a rounded Gaussian, is seen by the same measure.
struct rounded_gaussian {
    template <class Xi>
    mica::counts<float> operator()(float n, float p, Xi&& xi) const {
        const float z = -mica::normal_quantile(xi());
        const float drawn = mica::clamp(mica::floor(n * p + std::sqrt(n * p * (1 - p)) * z + 0.5F), 0.F, n);
        return {drawn, n - drawn};
    }
};

TEST(QuantileBinomial, TheMeasureSeesWorseLaws) {
    EXPECT_GE(deviation_of<mica::quantile_binomial<2>>(1e5F, 4e-6F).total_variation, 3e-3);
    EXPECT_GE(deviation_of<rounded_gaussian>(1000, 0.003F).total_variation, 0.05);
}

TEST(QuantileBinomial, KeepsTheMeanOfRareEvents) {
    for (const float trials : {1.F, 5.F, 1e4F, 1e12F}) {
        const auto mean_error = [&](double mean) {
            const auto p = static_cast<float>(mean / static_cast<double>(trials));
            const double expected = static_cast<double>(trials) * static_cast<double>(p);
            // Beyond two successes nothing that a double could see.
            const double found =
                at_least<mica::quantile_binomial<4>>(1, trials, p) + at_least<mica::quantile_binomial<4>>(2, trials, p);
            return std::abs(found / expected - 1);
        };
        EXPECT_LE(mean_error(1e-6), 1e-3) << trials;
        EXPECT_LE(mean_error(1e-8), 5e-2) << trials;
    }
    // boostorg/random #81
    double mean = 0;
    for (double k = 1; k <= 40; ++k) mean += at_least<mica::quantile_binomial<4>>(k, 6.4e16F, 6.27e-17F);
    EXPECT_NEAR(mean, 4.013, 0.04);
}

TEST(QuantileBinomial, IsMonotone) {
    using law = mica::quantile_binomial<4>;
    for (const float trials : {1.F, 3.F, 7.F, 40.F, 1000.F, 1e6F})
        for (const float p : {1e-6F, 0.003F, 0.1F, 0.3F, 0.5F, 0.7F, 0.99F}) {
            double before = successes_at<law>(trials, p, uniform_of(0));
            for (std::uint32_t bits = 0; bits < last_uniform - 300007; bits += 300007) {
                const double now = successes_at<law>(trials, p, uniform_of(bits));
                EXPECT_LE(now, before) << trials << ' ' << p << ' ' << bits;
                EXPECT_LE(now, successes_at<law>(trials + 1, p, uniform_of(bits)));
                EXPECT_LE(now, successes_at<law>(trials, std::min(1.F, p * 1.01F), uniform_of(bits)));
                before = now;
            }
        }
}

TEST(QuantileBinomial, StaysInItsSupport) {
    const float extremes[] = {0x1p-32F, 0x1p-24F, 0.25F, 0.5F, 0.75F, 1 - 0x1p-24F};
    for (const float trials : {0.F, 0.05F, 0.999F, 1.F, 2.5F, 17.F, 1e4F, 1e16F, 3e38F})
        for (const float p : {0.F, 1e-38F, 1e-16F, 0.3F, 0.5F, 0.50001F, 1 - 0x1p-24F, 1.F})
            for (const float xi : extremes)
                for (const float rounding : extremes) {
                    int drawn = 0;
                    const auto counts =
                        mica::quantile_binomial<4>{}(trials, p, [&] { return drawn++ == 0 ? xi : rounding; });
                    EXPECT_EQ(drawn, 2);
                    EXPECT_TRUE(counts.successes >= 0 && counts.successes <= std::ceil(trials)) << trials << ' ' << p;
                    EXPECT_TRUE(counts.failures >= 0 && counts.failures <= std::ceil(trials)) << trials << ' ' << p;
                    EXPECT_EQ(counts.successes, std::floor(counts.successes));
                    if (p == 0) {
                        EXPECT_EQ(counts.successes, 0);
                    }
                    if (p == 1) {
                        EXPECT_EQ(counts.failures, 0);
                    }
                }
}

TEST(QuantileBinomial, RealTrialsHaveTheirMean) {
    for (const float trials : {0.05F, 0.5F, 0.999F, 1.5F, 2.5F, 7.3F, 1000.4F})
        for (const float p : {0.002F, 0.05F, 0.3F, 0.5F, 0.8F}) {
            const float whole = std::floor(trials), part = trials - whole;
            const auto mean_of = [&](float n) {
                double mean = 0;
                const double n_p = static_cast<double>(n) * static_cast<double>(p);
                for (double k = 1; k <= n_p + 12 * std::sqrt(n_p + 1) + 10 && k <= static_cast<double>(n); ++k)
                    mean += at_least<mica::quantile_binomial<4>>(k, n, p);
                return mean;
            };
            const double mean = (1 - static_cast<double>(part)) * (whole > 0 ? mean_of(whole) : 0) +
                                static_cast<double>(part) * mean_of(whole + 1);
            const double expected = static_cast<double>(trials) * static_cast<double>(p);
            EXPECT_NEAR(mean / expected, 1, 1.3e-3) << trials << ' ' << p;
        }
}

/// Mean and variance of a law of one uniform by the midpoint rule, finer towards 0, where many successes lie.
template <class Law>
std::array<double, 2> moments_by_quadrature(float trials, float probability) {
    double first = 0, second = 0;
    const auto add = [&](double low, double high, int points) {
        for (int i = 0; i < points; ++i) {
            const double u = low + (high - low) * (i + 0.5) / points;
            const double n = successes_at<Law>(trials, probability, static_cast<float>(u));
            first += (high - low) / points * n;
            second += (high - low) / points * n * n;
        }
    };
    add(0, 1e-6, 500);
    add(1e-6, 1e-4, 2000);
    add(1e-4, 1e-2, 4000);
    add(1e-2, 1, 20000);
    return {first, second - first * first};
}

TEST(SmoothQuantileBinomial, KeepsMeanAndMostOfTheVariance) {
    using law = mica::smooth_quantile_binomial<4>;
    for (const float trials : {1.F, 2.F, 3.F, 4.F, 5.F, 8.F, 16.F, 64.F, 1024.F, 1e5F})
        for (double n_p = 1e-3; n_p <= std::min(300., static_cast<double>(trials) / 2); n_p *= 1.5) {
            const auto p = static_cast<float>(n_p / static_cast<double>(trials));
            const double expected = static_cast<double>(trials) * static_cast<double>(p);
            const auto [mean, variance] = moments_by_quadrature<law>(trials, p);
            EXPECT_NEAR(mean / expected, 1, 1e-3) << trials << ' ' << p;
            EXPECT_NEAR(variance / (expected * (1 - static_cast<double>(p))), 1, 0.1) << trials << ' ' << p;
        }
    for (const float trials : {0.05F, 0.5F, 0.999F, 1.5F, 2.5F, 7.3F, 1000.4F})
        for (const float p : {0.002F, 0.05F, 0.3F, 0.5F, 0.8F}) {
            const double expected = static_cast<double>(trials) * static_cast<double>(p);
            EXPECT_NEAR(moments_by_quadrature<law>(trials, p)[0] / expected, 1, 1e-3) << trials << ' ' << p;
        }
}

TEST(SmoothQuantileBinomial, SumsToTheTrials) {
    for (std::uint32_t i = 0; i < 20000; ++i) {
        mica::uniform_stream<float> choose{5, i};
        const float trials = std::exp2(20 * choose()), p = choose();
        mica::uniform_stream<float> xi{6, i};
        const auto counts = mica::smooth_quantile_binomial<4>{}(trials, p, xi);
        EXPECT_TRUE(counts.successes >= 0 && counts.failures >= 0);
        EXPECT_NEAR(counts.successes + counts.failures, trials, 2e-7F * trials);
    }
}

/// The largest change of the count along a walk over x, beyond the one that the walk's step explains.
template <class Count>
double largest_jump(double low, double high, int steps, Count count) {
    double worst = 0, before = count(low), change_before = 0;
    for (int i = 1; i <= steps; ++i) {
        const double now = count(low + (high - low) * i / steps);
        const double change = std::abs(now - before);
        if (i > 1) worst = std::fmax(worst, change - 2 * change_before);
        change_before = change;
        before = now;
    }
    return worst;
}

TEST(SmoothQuantileBinomial, HasNoJumpInTrialsAndProbability) {
    using law = mica::smooth_quantile_binomial<4>;
    double across_trials = 0, across_half = 0;
    for (const float xi : {0.01F, 0.2F, 0.4F, 0.5F, 0.63F, 0.9F}) {
        for (const float p : {0.1F, 0.47F, 0.5F, 0.8F})
            across_trials = std::fmax(across_trials, largest_jump(0.25, 12, 200000, [&](double n) {
                                          return successes_at<law>(static_cast<float>(n), p, xi);
                                      }));
        for (const float trials : {0.7F, 3.F, 6.5F, 40.F, 900.F})
            across_half = std::fmax(across_half, largest_jump(0.499, 0.501, 2000, [&](double p) {
                                        return successes_at<law>(trials, static_cast<float>(p), xi);
                                    }));
    }
    std::printf("largest jump: across trials %.2g, across p = 1/2 %.2g\n", across_trials, across_half);
    EXPECT_LE(across_trials, 1e-3);
    EXPECT_LE(across_half, 1e-3);
    // Control: the integer law jumps.
    EXPECT_GE(largest_jump(0.25, 12, 200000,
                           [&](double n) {
                               return successes_at<mica::quantile_binomial<4>>(static_cast<float>(n), 0.5F, 0.4F);
                           }),
              0.5);
}

TEST(QuantileBinomial, LanesEqualScalars) {
    using pack = mica::pack<float, 4>;
    using index = mica::index_of<pack>;
    for (std::uint32_t i = 0; i < 40000; i += 4) {
        mica::uniform_stream<pack> choose{index(8U), index::iota(i)};
        const pack trials = mica::exp(pack(20.F) * choose()), p = choose();
        mica::uniform_stream<pack> xi{index(9U), index::iota(i)}, smooth_xi = xi;
        const auto counts = mica::quantile_binomial<8>{}(trials, p, xi);
        const auto smooth = mica::smooth_quantile_binomial<4>{}(trials, p, smooth_xi);
        for (int lane = 0; lane < 4; ++lane) {
            const auto stream = [&] { return mica::uniform_stream<float>{9U, i + static_cast<std::uint32_t>(lane)}; };
            const auto scalar = mica::quantile_binomial<8>{}(trials[lane], p[lane], stream());
            const auto smooth_scalar = mica::smooth_quantile_binomial<4>{}(trials[lane], p[lane], stream());
            EXPECT_EQ(counts.successes[lane], scalar.successes);
            EXPECT_EQ(counts.failures[lane], scalar.failures);
            EXPECT_EQ(smooth.successes[lane], smooth_scalar.successes);
            EXPECT_EQ(smooth.failures[lane], smooth_scalar.failures);
        }
    }
}

} // namespace
