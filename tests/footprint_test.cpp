// The footprint against a singular value decomposition in long double that shares no formula with it: sums and
// differences of the singular values from the sums and differences of the matrix entries (Blinn 1996, "Consider the
// lowly 2x2 matrix").

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <mica/grid/footprint.hpp>

namespace {

using mica::footprint;
using mica::make_footprint;
using mica::uv_derivatives;

constexpr long double pi = 3.14159265358979323846264338327950288L;

struct decomposition {
    long double sigma_max, sigma_min, area, orientation;
};

template <class Real>
decomposition singular_values(const uv_derivatives<Real>& m) {
    const long double xu = m.du_dx, xv = m.dv_dx, yu = m.du_dy, yv = m.dv_dy;
    const long double half_sum = std::hypot((xu + yv) / 2, (xv - yu) / 2);
    const long double half_difference = std::hypot((xu - yv) / 2, (xv + yu) / 2);
    const long double axis = (std::atan2(xv + yu, xu - yv) + std::atan2(xv - yu, xu + yv)) / 2; // from +u
    long double orientation = axis / pi - 0.5L;                                                 // from +v
    orientation -= std::floor(orientation);
    return {half_sum + half_difference, std::abs(half_sum - half_difference), std::abs(xu * yv - yu * xv), orientation};
}

/// M = turn(axis) diag(sigma_max, sigma_min) turn(pixel): the major axis at `axis` half turns from +v towards -u.
template <class Real>
uv_derivatives<Real> derivatives_of(double sigma_max, double sigma_min, double axis, double pixel) {
    const double turn_axis = static_cast<double>(pi) * (axis + 0.5), turn_pixel = static_cast<double>(pi) * pixel;
    const double c = std::cos(turn_axis), s = std::sin(turn_axis);
    const double cp = std::cos(turn_pixel), sp = std::sin(turn_pixel);
    return {static_cast<Real>(c * sigma_max * cp - s * sigma_min * sp),
            static_cast<Real>(s * sigma_max * cp + c * sigma_min * sp),
            static_cast<Real>(-c * sigma_max * sp - s * sigma_min * cp),
            static_cast<Real>(-s * sigma_max * sp + c * sigma_min * cp)};
}

template <class Real>
uv_derivatives<Real> random_derivatives(std::mt19937& random, double largest_ratio) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double sigma_min = std::pow(10., -8 + 8 * unit(random));
    const double ratio = std::pow(largest_ratio, unit(random));
    const double axis = unit(random), pixel = 2 * unit(random);
    return derivatives_of<Real>(ratio * sigma_min, sigma_min, axis, pixel);
}

long double relative_error(long double value, long double truth) { return std::abs(value - truth) / truth; }

/// Orientations are points of a circle of length 1.
long double circular_distance(long double a, long double b) {
    const long double difference = std::abs(a - b);
    return std::fmin(difference, 1 - difference);
}

template <class Real>
struct worst_errors {
    long double sigma_max = 0, sigma_min = 0, area = 0, ratio = 0;

    void add(const uv_derivatives<Real>& m) {
        const auto pixel = make_footprint(m);
        const auto truth = singular_values(m);
        raise(sigma_max, relative_error(pixel.sigma_max, truth.sigma_max));
        raise(sigma_min, relative_error(pixel.sigma_min, truth.sigma_min));
        raise(area, relative_error(pixel.area, truth.area));
        raise(ratio, relative_error(pixel.ratio, truth.sigma_max / truth.sigma_min));
    }

  private:
    // NaN wins and stays, so that it fails the comparison at the end.
    static void raise(long double& worst, long double error) {
        if (!(error <= worst)) worst = error;
    }
};

template <class Real>
worst_errors<Real> measured_errors(double largest_ratio) {
    std::mt19937 random(1);
    worst_errors<Real> worst;
    for (int i = 0; i < 200000; ++i) worst.add(random_derivatives<Real>(random, largest_ratio));
    std::printf("largest relative error, ratio up to %g: sigma_max %.2Lg, sigma_min %.2Lg, area %.2Lg, ratio %.2Lg\n",
                largest_ratio, worst.sigma_max, worst.sigma_min, worst.area, worst.ratio);
    return worst;
}

TEST(Footprint, SingularValuesInFloat) {
    // 1e-6 is what the header states, three orders inside what a level needs.
    const auto worst = measured_errors<float>(1e5);
    EXPECT_LE(worst.sigma_max, 1e-6L);
    EXPECT_LE(worst.sigma_min, 1e-6L);
    EXPECT_LE(worst.area, 1e-6L);
    EXPECT_LE(worst.ratio, 1e-6L);
}

TEST(Footprint, SingularValuesInDouble) {
    const auto worst = measured_errors<double>(1e5);
    EXPECT_LE(worst.sigma_max, 1e-14L);
    EXPECT_LE(worst.sigma_min, 1e-13L); // that of the reference: 1e-19 times the ratio, twice
    EXPECT_LE(worst.area, 1e-13L);
    EXPECT_LE(worst.ratio, 1e-13L);
}

// The textbook sigma_min^2 = T/2 - root must fail the test that the quotient passes.
TEST(Footprint, TextbookFormulaWouldBeSeen) {
    std::mt19937 random(1);
    int beyond = 0;
    for (int i = 0; i < 1000; ++i) {
        const auto m = random_derivatives<float>(random, 1e5);
        const float a = m.du_dx * m.du_dx + m.du_dy * m.du_dy;
        const float d = m.dv_dx * m.dv_dx + m.dv_dy * m.dv_dy;
        const float b = m.du_dx * m.dv_dx + m.du_dy * m.dv_dy;
        const float textbook = std::sqrt((a + d) / 2 - std::sqrt((a - d) * (a - d) / 4 + b * b));
        if (!(relative_error(textbook, singular_values(m).sigma_min) <= 1e-3L)) ++beyond;
    }
    // It loses the digits of sigma_min as epsilon r^2: beyond 1e-3 from ratio 100 on, which 3/5 of the draws exceed.
    EXPECT_GE(beyond, 300);
}

// A power of two in the scale changes exponents only, so glints do not crawl when a texture is rescaled.
TEST(Footprint, PowerOfTwoScalesExactly) {
    std::mt19937 random(2);
    for (int i = 0; i < 1000; ++i) {
        const auto m = random_derivatives<float>(random, 1e4);
        const auto one = make_footprint(m);
        const auto scaled = make_footprint<float>({32 * m.du_dx, 32 * m.dv_dx, 32 * m.du_dy, 32 * m.dv_dy});
        EXPECT_EQ(scaled.sigma_max, 32 * one.sigma_max);
        EXPECT_EQ(scaled.sigma_min, 32 * one.sigma_min);
        EXPECT_EQ(scaled.area, 1024 * one.area);
        EXPECT_EQ(scaled.ratio, one.ratio);
        EXPECT_EQ(scaled.orientation, one.orientation);
    }
}

// From +v towards -u, in half turns: the axis of orientation o is (-sin pi o, cos pi o).
TEST(Footprint, OrientationOfAxisAlignedFootprints) {
    for (const float zero : {0.F, -0.F})
        for (const float sign : {1.F, -1.F}) {
            EXPECT_EQ(make_footprint<float>({1, zero, zero, sign * 3}).orientation, 0.F); // along v, b = 0, d > a
            EXPECT_EQ(make_footprint<float>({zero, sign * 3, 1, zero}).orientation, 0.F); // the same, x and y exchanged
            EXPECT_EQ(make_footprint<float>({sign * 3, zero, zero, 1}).orientation, 0.5F); // along u
            EXPECT_EQ(make_footprint<float>({zero, 1, sign * 3, zero}).orientation, 0.5F);
        }
}

TEST(Footprint, OrientationOfDiagonals) {
    // Major axis (-1,1)/sqrt2, an eighth of a turn from +v towards -u; then (1,1)/sqrt2.
    EXPECT_NEAR(make_footprint<float>({-3, 3, 1, 1}).orientation, 0.25F, 1e-6F);
    EXPECT_NEAR(make_footprint<float>({3, 3, -1, 1}).orientation, 0.75F, 1e-6F);
}

TEST(Footprint, CircleHasSomeOrientation) {
    const auto circle = make_footprint<float>({2, 0, 0, 2});
    EXPECT_EQ(circle.ratio, 1.F);
    EXPECT_EQ(circle.sigma_max, 2.F);
    EXPECT_EQ(circle.sigma_min, 2.F);
    EXPECT_EQ(circle.area, 4.F);
    EXPECT_TRUE(circle.orientation >= 0 && circle.orientation < 1);
}

TEST(Footprint, OrientationAgreesWithReference) {
    std::mt19937 random(3);
    for (int i = 0; i < 100000; ++i) {
        const auto m = random_derivatives<float>(random, 1e5);
        const auto truth = singular_values(m);
        const long double ratio = truth.sigma_max / truth.sigma_min;
        // Rounding of a, b and d moves the axis by about epsilon (r^2 + 1) / (r^2 - 1) radians.
        const long double condition = (ratio * ratio + 1) / (ratio * ratio - 1);
        const float orientation = make_footprint(m).orientation;
        ASSERT_TRUE(orientation >= 0 && orientation < 1);
        ASSERT_LE(circular_distance(orientation, truth.orientation),
                  2 * condition * std::numeric_limits<float>::epsilon());
    }
}

// Half a turn in small steps, through the place where 180 degrees become 0.
TEST(Footprint, OrientationContinuousAcrossTheSeam) {
    constexpr int steps = 20000;
    for (const double ratio : {1.5, 4., 100., 1e4}) {
        float before = make_footprint(derivatives_of<float>(ratio, 1, 0.5, 0.1)).orientation;
        for (int i = 1; i <= steps; ++i) {
            const double axis = 0.5 + static_cast<double>(i) / steps;
            const float after = make_footprint(derivatives_of<float>(ratio, 1, axis, 0.1)).orientation;
            ASSERT_TRUE(after >= 0 && after < 1);
            ASSERT_LE(circular_distance(before, after), 1.0L / steps + 2e-6L) << "ratio " << ratio << " axis " << axis;
            before = after;
        }
    }
}

// A hair to either side of +v, where rounding could return 1 instead of 0.
TEST(Footprint, OrientationBelowOne) {
    for (const float tilt : {1e-3F, 1e-7F, 1e-8F, 1e-20F, 1e-38F, 1e-45F})
        for (const float sign : {1.F, -1.F}) {
            const float orientation = make_footprint<float>({1, 0, sign * tilt, 3}).orientation;
            EXPECT_TRUE(orientation >= 0 && orientation < 1) << tilt * sign;
            EXPECT_LE(circular_distance(orientation, 0), 1e-3L) << tilt * sign;
        }
}

void expect_nothing_covered(const footprint<float>& pixel) {
    EXPECT_EQ(pixel.area, 0.F);
    EXPECT_EQ(pixel.sigma_max, 0.F);
    EXPECT_EQ(pixel.sigma_min, 0.F);
    EXPECT_EQ(pixel.ratio, 1.F);
    EXPECT_EQ(pixel.orientation, 0.F);
}

TEST(Footprint, ZeroAndNonFiniteCoverNothing) {
    expect_nothing_covered(make_footprint<float>({0, 0, 0, 0}));
    expect_nothing_covered(make_footprint<float>({-0.F, 0, -0.F, 0}));
    const float infinity = std::numeric_limits<float>::infinity();
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::quiet_NaN(), infinity, -infinity}) {
        expect_nothing_covered(make_footprint<float>({bad, 1, 1, 2}));
        expect_nothing_covered(make_footprint<float>({1, bad, 1, 2}));
        expect_nothing_covered(make_footprint<float>({1, 1, bad, 2}));
        expect_nothing_covered(make_footprint<float>({1, 1, 2, bad}));
        expect_nothing_covered(make_footprint<float>({bad, bad, bad, bad}));
    }
}

TEST(Footprint, RankOne) {
    // One column 0, the columns parallel, one row 0.
    for (const auto& m :
         {uv_derivatives<float>{3, 4, 0, 0}, uv_derivatives<float>{0, 0, 3, 4}, uv_derivatives<float>{3, 4, 6, 8},
          uv_derivatives<float>{3, 0, 4, 0}, uv_derivatives<float>{0, 3, 0, -4}}) {
        const auto pixel = make_footprint(m);
        const auto truth = singular_values(m);
        EXPECT_EQ(pixel.area, 0.F);
        EXPECT_EQ(pixel.ratio, mica::largest_footprint_ratio);
        EXPECT_NEAR(pixel.sigma_max, static_cast<float>(truth.sigma_max), 1e-5F);
        EXPECT_EQ(pixel.sigma_min, pixel.sigma_max / mica::largest_footprint_ratio);
        EXPECT_LE(circular_distance(pixel.orientation, truth.orientation), 1e-6L);
    }
}

TEST(Footprint, TinyAndHuge) {
    const auto tiny = make_footprint<float>({1e-30F, 0, 0, 2e-30F});
    EXPECT_FLOAT_EQ(tiny.sigma_max, 2e-30F);
    EXPECT_FLOAT_EQ(tiny.sigma_min, 1e-30F);
    EXPECT_FLOAT_EQ(tiny.ratio, 2.F);
    EXPECT_EQ(tiny.area, 0.F); // 2e-60 is below the range of float
    const auto huge = make_footprint<float>({1e30F, 0, 0, 2e30F});
    EXPECT_FLOAT_EQ(huge.sigma_max, 2e30F);
    EXPECT_FLOAT_EQ(huge.sigma_min, 1e30F);
    EXPECT_EQ(huge.area, std::numeric_limits<float>::max());
}

/// What holds for every footprint.
void expect_within_range(const uv_derivatives<float>& m) {
    const auto pixel = make_footprint(m);
    const float largest = std::numeric_limits<float>::max();
    EXPECT_TRUE(pixel.area >= 0 && pixel.area <= largest);
    EXPECT_TRUE(pixel.sigma_min >= 0 && pixel.sigma_min <= pixel.sigma_max && pixel.sigma_max <= largest);
    EXPECT_TRUE(pixel.ratio >= 1 && pixel.ratio <= mica::largest_footprint_ratio);
    EXPECT_TRUE(pixel.orientation >= 0 && pixel.orientation < 1);
    if (::testing::Test::HasFailure())
        ADD_FAILURE() << "M = " << m.du_dx << ' ' << m.dv_dx << ' ' << m.du_dy << ' ' << m.dv_dy;
}

TEST(Footprint, MixedMagnitudes) {
    const float sizes[] = {0, 1e-45F, -1e-38F, 1e-30F, -1e-19F, 1e-7F,
                           1, -1.F,   1e7F,    -1e19F, 1e30F,   -std::numeric_limits<float>::max()};
    for (const float xu : sizes)
        for (const float xv : sizes)
            for (const float yu : sizes)
                for (const float yv : sizes) {
                    expect_within_range({xu, xv, yu, yv});
                    if (HasFailure()) return;
                }
}

} // namespace
