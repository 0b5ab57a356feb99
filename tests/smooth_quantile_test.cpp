// tests/smooth_quantile_test.cpp: smooth_quantile_binomial keeps the mean, most of the variance, and has no jump.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>

#include <gtest/gtest.h>

#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>
#include <mica/random/uniform_stream.hpp>

#include "stated_grid.hpp"

namespace {

using law = mica::smooth_quantile_binomial<4>;

template <class Law, class Real>
mica::counts<Real> counts_at(Real trials, Real probability, Real xi) {
    return Law{}(trials, probability, [&] { return xi; });
}

template <class Law, class Real>
Real successes_at(Real trials, Real probability, Real xi) {
    return counts_at<Law>(trials, probability, xi).successes;
}

struct moments {
    double mean, variance;
};

/// Of the rarer of successes and failures, over xi, by the midpoint rule with 128 points to every octave towards 0 and
/// towards 1, in binary32.
moments rarer_counts_of(float trials, float probability) {
    const auto p = static_cast<double>(probability);
    const double expected = static_cast<double>(trials) * std::min(p, 1 - p);
    double first = 0, second = 0;
    const auto add = [&](double xi, double weight) {
        const auto u = static_cast<float>(xi);
        const auto counts = counts_at<law>(trials, probability, std::min(u, 1 - 0x1p-24F));
        const double n = static_cast<double>(p > 0.5 ? counts.failures : counts.successes);
        first += weight * (n - expected);
        second += weight * (n - expected) * (n - expected);
    };
    constexpr int points = 128, octaves_to_0 = 32, octaves_to_1 = 24;
    for (int octave = 1; octave <= octaves_to_0; ++octave)
        for (int i = 0; i < points; ++i) {
            const double width = std::ldexp(1., -octave - 1) / points;
            const double from_end = std::ldexp(1., -octave - 1) + width * (i + 0.5);
            add(from_end, width);
            if (octave <= octaves_to_1) add(1 - from_end, width);
        }
    add(0x1p-34, 0x1p-33);
    add(1 - 0x1p-26, 0x1p-25);
    return {expected + first, second - first * first};
}

/// Relative errors of mean and variance of the rarer of successes and failures.
struct errors {
    double mean, variance;
};

errors errors_of(float trials, float probability) {
    const auto p = static_cast<double>(probability);
    const double n = static_cast<double>(trials), rarer = std::min(p, 1 - p);
    const auto found = rarer_counts_of(trials, probability);
    const double variance = n < 1 ? n * rarer * (1 - n * rarer) : n * p * (1 - p);
    return {std::abs(found.mean / (n * rarer) - 1), std::abs(found.variance / variance - 1)};
}

TEST(SmoothQuantileBinomial, KeepsMeanAndVarianceOverTheStatedGrid) {
    errors worst{0, 0};
    const auto expect = [&](float trials, float p) {
        const auto found = errors_of(trials, p);
        EXPECT_TRUE(found.mean <= 1e-3) << trials << ' ' << p << ' ' << found.mean;
        EXPECT_TRUE(found.variance <= 1e-1) << trials << ' ' << p << ' ' << found.variance;
        worst = {std::max(worst.mean, found.mean), std::max(worst.variance, found.variance)};
    };
    stated_grid::each(expect);
    for (const float trials : {1.F, 2.F})
        for (const float p : {1e-3F, 0.02F, 0.1F, 0.3F, 0.45F, 0.5F, 0.55F, 0.8F, 0.98F, 0.999F}) expect(trials, p);
    std::printf("integer trials: mean %.2g, variance %.2g\n", worst.mean, worst.variance);
}

/// Relative to N p q between 1 and 3, to N p (1 - N p) below 1: one facet that may be there.
TEST(SmoothQuantileBinomial, KeepsMeanAndVarianceOfRealTrials) {
    errors few{0, 0}, lone{0, 0}, many{0, 0};
    for (const float p : {1e-3F, 0.01F, 0.05F, 0.1F, 0.3F, 0.42F, 0.47F, 0.5F, 0.53F, 0.7F, 0.95F, 0.999F}) {
        for (float n = 1.02F; n < 3; n += 0.06F) {
            const auto found = errors_of(n, p);
            few = {std::max(few.mean, found.mean), std::max(few.variance, found.variance)};
        }
        for (float n = 0.05F; n < 1; n += 0.05F) {
            const auto found = errors_of(n, p);
            lone = {std::max(lone.mean, found.mean), std::max(lone.variance, found.variance)};
        }
        for (float n = 3.05F; n < 1000; n *= 1.17F) {
            const auto found = errors_of(n, p);
            many = {std::max(many.mean, found.mean), std::max(many.variance, found.variance)};
        }
    }
    std::printf("mean: N < 1 %.2g, 1 to 3 %.2g, beyond %.2g; variance: %.2g, %.2g, %.2g\n", lone.mean, few.mean,
                many.mean, lone.variance, few.variance, many.variance);
    EXPECT_TRUE(few.mean <= 1e-3 && lone.mean <= 1e-3 && many.mean <= 1e-3);
    EXPECT_TRUE(few.variance <= 0.25);
    EXPECT_TRUE(lone.variance <= 0.1);
    EXPECT_TRUE(many.variance <= 0.15);
}

TEST(SmoothQuantileBinomial, HasTheMeanOfSingledOutRealTrials) {
    for (const float trials : {0.05F, 0.5F, 0.999F, 1.5F, 2.5F, 7.3F, 1000.4F})
        for (const float p : {1e-3F, 0.002F, 0.05F, 0.3F, 0.45F, 0.5F, 0.55F, 0.8F, 0.999F}) {
            const double error = errors_of(trials, p).mean;
            EXPECT_TRUE(error <= 1e-3) << trials << ' ' << p << ' ' << error;
        }
}

/// The other measure of the suite agrees, and sees the fault of a single gate.
TEST(SmoothQuantileBinomial, EnumerationAgreesAndSeesTooFewGates) {
    for (const auto& [n, p] : {std::pair{5.F, 0.4F}, {16.F, 0.1F}, {1000.F, 0.02F}}) {
        const auto found = enumeration::deviation_of<law>(n, p);
        const auto [mean, variance] = rarer_counts_of(n, p);
        const double expected = static_cast<double>(n) * static_cast<double>(p);
        EXPECT_TRUE(std::abs(found.mean - mean / expected) <= 1e-4) << n << ' ' << found.mean << ' ' << mean / expected;
        EXPECT_TRUE(std::abs(found.variance - variance / (expected * (1 - static_cast<double>(p)))) <= 1e-3)
            << n << ' ' << found.variance;
    }
    double worst = 0;
    stated_grid::each([&](float n, float p) {
        if (p <= 0.5F)
            worst =
                std::max(worst, std::abs(enumeration::deviation_of<mica::smooth_quantile_binomial<1>>(n, p).mean - 1));
    });
    EXPECT_TRUE(worst >= 0.02) << worst;
}

TEST(SmoothQuantileBinomial, SumsToTheTrials) {
    for (std::uint32_t i = 0; i < 200'000; ++i) {
        mica::uniform_stream<float> choose{5, i};
        const float trials = std::exp2(26 * choose()), p = choose();
        const auto [successes, failures] = law{}(trials, p, mica::uniform_stream<float>{6, i});
        EXPECT_TRUE(successes >= 0 && failures >= 0 && successes <= trials && failures <= trials);
        const double sum = static_cast<double>(successes) + static_cast<double>(failures);
        EXPECT_TRUE(std::abs(sum - static_cast<double>(trials)) <=
                    0x1p-24 * static_cast<double>(std::max(successes, failures)))
            << trials << ' ' << p << ' ' << successes << ' ' << failures; // one is N less the other, rounded
    }
}

TEST(SmoothQuantileBinomial, DoesNotIncreaseInXi) {
    for (const double trials : {0.4, 1., 1.5, 2.7, 5., 5.5, 40., 1e6})
        for (const double p : {1e-6, 0.01, 0.3, 0.46, 0.5, 0.52, 0.9}) {
            double before = trials + 1;
            for (int i = 1; i < 20000; ++i) {
                const double now = successes_at<law, double>(trials, p, i / 20000.);
                EXPECT_TRUE(now <= before + 1e-12 * trials) << trials << ' ' << p << ' ' << i;
                before = now;
            }
        }
}

using walk = std::function<double(double)>;

/// The largest jump of f between a and b: where f changes by more than `least`, the halves are searched until they
/// cannot be halved any more. A slope becomes small on the way, a jump stays.
double largest_jump(const walk& f, double a, double at_a, double b, double at_b, double least) {
    if (std::abs(at_a - at_b) <= least) return 0;
    const double middle = a + (b - a) / 2;
    if (std::abs(b - a) <= 1e-13 * std::abs(a)) return std::abs(at_a - at_b);
    const double at_middle = f(middle);
    return std::max(largest_jump(f, a, at_a, middle, at_middle, least),
                    largest_jump(f, middle, at_middle, b, at_b, least));
}

double largest_jump(double from, double to, int steps, const walk& f) {
    double worst = 0, before = f(from), x = from;
    for (int i = 1; i <= steps; ++i) {
        const double next = from + (to - from) * i / steps, at_next = f(next);
        worst = std::max(worst, largest_jump(f, x, before, next, at_next, 5e-4));
        x = next;
        before = at_next;
    }
    return worst;
}

constexpr double walked_xi[] = {0.001, 0.01, 0.2, 0.4, 0.5, 0.63, 0.9, 0.999};

/// In double, where a ramp 1e-10 wide is still a slope and not a jump.
TEST(SmoothQuantileBinomial, HasNoJump) {
    double in_trials = 0, in_probability = 0, in_xi = 0;
    for (const double xi : walked_xi) {
        for (const double p : {0.003, 0.1, 0.44, 0.47, 0.5, 0.53, 0.8})
            in_trials = std::max(
                in_trials, largest_jump(0.25, 12, 3000, [&](double n) { return successes_at<law, double>(n, p, xi); }));
        for (const double n : {0.7, 1., 1.3, 3., 4.5, 5., 6.5, 40.})
            in_probability = std::max(in_probability, largest_jump(0.001, 0.999, 3000, [&](double p) {
                                          return successes_at<law, double>(n, p, xi);
                                      }));
    }
    for (const double n : {0.7, 1., 1.3, 3., 4.5, 5., 6.5, 40.})
        for (const double p : {0.003, 0.1, 0.44, 0.47, 0.5, 0.53, 0.8})
            in_xi = std::max(in_xi, largest_jump(0.001, 0.999, 3000,
                                                 [&](double xi) { return successes_at<law, double>(n, p, xi); }));
    std::printf("largest jump beyond 5e-4: in N %.2g, in p %.2g, in xi %.2g\n", in_trials, in_probability, in_xi);
    EXPECT_TRUE(in_trials <= 1e-3 && in_probability <= 1e-3 && in_xi <= 1e-3);
    // Controls: the integer law jumps, and so does a walk that jumps by two thousandths.
    EXPECT_TRUE(largest_jump(0.25, 12, 3000, [](double n) {
                    return successes_at<mica::quantile_binomial<4>, double>(n, 0.5, 0.4);
                }) >= 0.5);
    EXPECT_TRUE(largest_jump(0, 1, 100, [](double x) { return x + (x > 0.37 ? 0.002 : 0); }) >= 1.9e-3);
}

/// In binary32 across the seams, from one number to the next: integer N, N = 1, p = 1/2 and p = 0.45.
TEST(SmoothQuantileBinomial, HasNoJumpBetweenNeighbouringFloats) {
    double across_trials = 0, across_probability = 0;
    for (const double wide_xi : walked_xi) {
        const auto xi = static_cast<float>(wide_xi);
        const auto largest_step = [&](float at, const auto& count) {
            float low = at;
            for (int i = 0; i < 50; ++i) low = std::nextafter(low, 0.F);
            double worst = 0;
            for (int i = 0; i < 100; ++i) {
                const float high = std::nextafter(low, 1e30F);
                worst = std::max(worst, std::abs(static_cast<double>(count(high)) - static_cast<double>(count(low))));
                low = high;
            }
            return worst;
        };
        for (const float p : {0.003F, 0.1F, 0.44F, 0.47F, 0.5F, 0.53F, 0.8F})
            for (float n = 1; n < 20; ++n)
                across_trials = std::max(
                    across_trials, largest_step(n, [&](float trials) { return successes_at<law>(trials, p, xi); }));
        for (const float n : {0.7F, 1.F, 1.3F, 3.F, 4.5F, 5.F, 6.5F, 40.F, 300.F})
            for (const float p : {0.45F, 0.5F, 0.55F})
                across_probability = std::max(across_probability,
                                              largest_step(p, [&](float at) { return successes_at<law>(n, at, xi); }));
    }
    std::printf("largest step between neighbouring floats: in N %.2g, in p %.2g\n", across_trials, across_probability);
    EXPECT_TRUE(across_trials <= 1e-3);
    EXPECT_TRUE(across_probability <= 1e-3);
}

} // namespace
