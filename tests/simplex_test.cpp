// The cells of a grid: coordinates, the triangle around a point, and the seeds of its vertices.

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <unordered_set>
#include <vector>

#include <gtest/gtest.h>

#include <mica/grid/simplex.hpp>
#include <mica/random/uniform_stream.hpp>

namespace {

using mica::enclosing_simplex;
using mica::grid_coordinates;
using mica::uv_point;
using triangle = std::array<mica::simplex_vertex<float>, 3>;
using grid = mica::tetrahedron_vertex<float>;

constexpr double epsilon = std::numeric_limits<float>::epsilon();
constexpr double pi = 3.14159265358979323846;

// --- the triangle around a point --------------------------------------------------------------------------------

/// The skewed coordinates of a point, independently of the header's rounding.
uv_point<double> skewed(uv_point<float> p) {
    const double u = static_cast<double>(p.u), v = static_cast<double>(p.v);
    return {u - v / std::sqrt(3.), 2 * v / std::sqrt(3.)};
}

void expect_probabilities(const triangle& corners) {
    double sum = 0;
    for (const auto& corner : corners) {
        ASSERT_TRUE(corner.weight >= 0);
        sum += static_cast<double>(corner.weight);
    }
    ASSERT_LE(std::abs(sum - 1), 4 * epsilon);
}

std::vector<uv_point<float>> random_points(unsigned seed, int count, float extent) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> coordinate(-extent, extent);
    std::vector<uv_point<float>> points;
    for (int i = 0; i < count; ++i) points.push_back({coordinate(random), coordinate(random)});
    return points;
}

TEST(Simplex, WeightsAreProbabilities) {
    for (const float extent : {1e-30F, 1e-6F, 1.F, 100.F, 1e6F, 1e9F})
        for (const auto point : random_points(1, 50000, extent)) {
            expect_probabilities(enclosing_simplex(point));
            if (HasFatalFailure()) return;
        }
}

TEST(Simplex, WeightsReproduceThePoint) {
    for (const float extent : {1.F, 100.F})
        for (const auto point : random_points(2, 100000, extent)) {
            double x = 0, y = 0;
            for (const auto& corner : enclosing_simplex(point)) {
                x += static_cast<double>(corner.weight) * corner.i;
                y += static_cast<double>(corner.weight) * corner.j;
            }
            // The skew rounds coordinates of that size.
            ASSERT_LE(std::abs(x - skewed(point).u), 4 * epsilon * static_cast<double>(1 + extent));
            ASSERT_LE(std::abs(y - skewed(point).v), 4 * epsilon * static_cast<double>(1 + extent));
        }
}

TEST(Simplex, CornersAreNeighbours) {
    for (const auto point : random_points(3, 10000, 50)) {
        const auto c = enclosing_simplex(point);
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = a + 1; b < 3; ++b) {
                const int i = c[a].i - c[b].i, j = c[a].j - c[b].j;
                // The six directions of an equilateral lattice: the diagonal (1,1) is none of them.
                ASSERT_TRUE(i * i + j * j + i * j == 1) << i << ' ' << j;
            }
    }
}

// The skew's column order: lattice vectors (1,0) and (1/2, sqrt3/2), both of length 1 and 60 degrees apart. The
// transposed skew of a public port has other ones.
TEST(Simplex, LatticePoints) {
    for (int i = -3; i <= 3; ++i)
        for (int j = -3; j <= 3; ++j) {
            const double u = i + 0.5 * j, v = std::sqrt(0.75) * j;
            float at_vertex = 0;
            for (const auto& corner : enclosing_simplex(uv_point<float>{static_cast<float>(u), static_cast<float>(v)}))
                if (corner.i == i && corner.j == j) at_vertex += corner.weight;
            EXPECT_NEAR(at_vertex, 1.F, 1e-5F) << i << ' ' << j;
        }
}

float weight_in(const triangle& corners, const mica::simplex_vertex<float>& vertex) {
    float sum = 0;
    for (const auto& corner : corners)
        if (corner.i == vertex.i && corner.j == vertex.j) sum += corner.weight;
    return sum;
}

double largest_change(const triangle& before, const triangle& after) {
    float largest = 0;
    for (const auto* corners : {&before, &after})
        for (const auto& corner : *corners) {
            const float change = std::abs(weight_in(before, corner) - weight_in(after, corner));
            if (!(change <= largest)) largest = change;
        }
    return static_cast<double>(largest);
}

/// A weight is linear with height 1 over triangles of height sqrt(3)/2: it changes by at most 2/sqrt(3) per distance.
/// The skew rounds the coordinates.
double step_bound(uv_point<float> a, uv_point<float> b, double extent) {
    const double du = static_cast<double>(a.u) - static_cast<double>(b.u);
    const double dv = static_cast<double>(a.v) - static_cast<double>(b.v);
    return 2 / std::sqrt(3.) * std::hypot(du, dv) + 8 * epsilon * (1 + extent);
}

template <class Triangle>
double largest_jump(int lines, const Triangle& corners_at) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> coordinate(-8, 8);
    double worst = 0;
    for (int line = 0; line < lines; ++line) {
        const double u0 = coordinate(random), v0 = coordinate(random);
        const double u1 = coordinate(random), v1 = coordinate(random);
        const auto path = [=](double s) {
            return uv_point<float>{static_cast<float>(u0 + (u1 - u0) * s), static_cast<float>(v0 + (v1 - v0) * s)};
        };
        constexpr int steps = 5000;
        for (int i = 0; i < steps; ++i) {
            const auto from = path(i * 1. / steps), to = path((i + 1.) / steps);
            const double jump = largest_change(corners_at(from), corners_at(to)) / step_bound(from, to, 8);
            if (!(jump <= worst)) worst = jump;
        }
    }
    return worst;
}

TEST(Simplex, NoJumpAcrossFaces) { EXPECT_LE(largest_jump(100, enclosing_simplex<float>), 1.); }

// Truncation instead of floor, the classic mistake at negative coordinates.
TEST(Simplex, WalksSeeTruncation) {
    const auto truncating = [](uv_point<float> point) {
        auto corners = enclosing_simplex(point);
        const auto at = skewed(point);
        if (at.u < 0)
            for (auto& corner : corners) corner.i += 1;
        return corners;
    };
    EXPECT_GE(largest_jump(20, truncating), 10.);
}

TEST(Simplex, HugeAndUndefinedCoordinates) {
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const float sizes[] = {0, 1, -1, 1e9F, -1e9F, 1e10F, -1e10F, 1e30F, -1e30F, infinity, -infinity, nan};
    constexpr int outermost = 1 << 30;
    for (const float u : sizes)
        for (const float v : sizes) {
            const auto corners = enclosing_simplex(uv_point<float>{u, v});
            expect_probabilities(corners);
            for (const auto& corner : corners) {
                EXPECT_TRUE(corner.i >= -outermost && corner.i <= outermost + 1) << u << ' ' << v;
                EXPECT_TRUE(corner.j >= -outermost && corner.j <= outermost + 1) << u << ' ' << v;
            }
        }
}

// --- the coordinates of a grid ----------------------------------------------------------------------------------

uv_point<float> along_major_axis(const grid& g, double length) {
    const double angle = pi * g.orientation / mica::orientations(g.log2_ratio);
    return {static_cast<float>(-std::sin(angle) * length), static_cast<float>(std::cos(angle) * length)};
}

uv_point<float> across_major_axis(const grid& g, double length) {
    const double angle = pi * g.orientation / mica::orientations(g.log2_ratio);
    return {static_cast<float>(std::cos(angle) * length), static_cast<float>(std::sin(angle) * length)};
}

// A step of one cell along the footprint's long side is one in v, one across it is one in u.
TEST(GridCoordinates, CellsFollowTheFootprint) {
    for (const int level : {-12, -1, 0, 3})
        for (const int log2_ratio : {0, 1, 2, 5, 10})
            for (int k = 0; k < 16; ++k) {
                const int orientation = k * mica::orientations(log2_ratio) / 16;
                const grid g{level, log2_ratio, orientation, 1, 1};
                const auto along = grid_coordinates(along_major_axis(g, std::ldexp(1., level + log2_ratio)), g);
                const auto across = grid_coordinates(across_major_axis(g, std::ldexp(1., level)), g);
                // A cell is 2^log2_ratio times as long as wide, and so is the rounding across it.
                EXPECT_NEAR(along.u, 0.F, 4 * epsilon * std::ldexp(1., log2_ratio));
                EXPECT_NEAR(along.v, 1.F, 4 * epsilon);
                EXPECT_NEAR(across.u, 1.F, 4 * epsilon);
                EXPECT_NEAR(across.v, 0.F, 4 * epsilon);
            }
}

// The whole convention at once: M turned by any angle, its major axis as make_footprint names it, is +v in a grid of
// that orientation, up to half a bin.
TEST(GridCoordinates, AgreeWithTheFootprint) {
    for (int k = 0; k < 64; ++k) {
        const double angle = pi * k / 64;
        const auto u = static_cast<float>(-std::sin(angle)), v = static_cast<float>(std::cos(angle));
        const auto pixel = mica::make_footprint<float>({4 * u, 4 * v, v, -u});
        const int bins = mica::orientations(2);
        const int orientation = static_cast<int>(std::lround(pixel.orientation * static_cast<float>(bins))) % bins;
        const auto axis = grid_coordinates(uv_point<float>{u, v}, grid{0, 2, orientation, 1, 1});
        EXPECT_LE(std::abs(static_cast<double>(axis.u)), std::sin(pi / bins / 2) + 1e-6);
        EXPECT_GE(std::abs(static_cast<double>(axis.v)) * 4, std::cos(pi / bins / 2) - 1e-6);
    }
}

TEST(GridCoordinates, ScaleWithLevelExactly) {
    for (const auto point : random_points(5, 1000, 3)) {
        const auto coarse = grid_coordinates(point, grid{-3, 2, 5, 1, 1});
        const auto fine = grid_coordinates(point, grid{-10, 2, 5, 1, 1});
        ASSERT_EQ(fine.u, 128 * coarse.u);
        ASSERT_EQ(fine.v, 128 * coarse.v);
    }
}

// --- seeds ------------------------------------------------------------------------------------------------------

/// n random 32-bit numbers have n^2 / 2^33 pairs of equals, Poisson distributed; six standard deviations and one more.
/// One-sided: a chain of bijections has fewer, since cells that differ in their last integer only never share a seed.
void expect_no_more_collisions_than_random(const std::vector<std::uint32_t>& seeds) {
    const std::unordered_set<std::uint32_t> distinct(seeds.begin(), seeds.end());
    const double count = static_cast<double>(seeds.size());
    const double collisions = count - static_cast<double>(distinct.size());
    const double expected = count * count / 0x1p33;
    EXPECT_LE(collisions, expected + 6 * std::sqrt(expected) + 1);
}

TEST(Seeds, OfCellsAreDistinct) {
    std::vector<std::uint32_t> seeds;
    for (int j = -512; j < 512; ++j)
        for (int i = -512; i < 512; ++i) seeds.push_back(mica::cell_seed(7U, i, j));
    expect_no_more_collisions_than_random(seeds);
}

TEST(Seeds, OfGridsAreDistinct) {
    std::vector<std::uint32_t> seeds;
    for (int level = -40; level <= 40; ++level)
        for (int log2_ratio = 0; log2_ratio <= 9; ++log2_ratio)
            for (int k = 0; k < mica::orientations(log2_ratio); ++k)
                seeds.push_back(mica::grid_seed(7, grid{level, log2_ratio, k, 1, 1}));
    expect_no_more_collisions_than_random(seeds);
}

TEST(Seeds, OfTheCallerMatter) {
    std::vector<std::uint32_t> seeds;
    for (std::uint32_t seed = 0; seed < 100000; ++seed)
        seeds.push_back(mica::cell_seed(mica::grid_seed(seed, grid{-7, 2, 3, 1, 1}), 0, 0));
    expect_no_more_collisions_than_random(seeds);
}

/// The first uniform that a law draws at a cell, less its mean, over its deviation.
double standardised(std::uint32_t seed) {
    return (static_cast<double>(mica::uniform_stream<float>(seed)()) - 0.5) * std::sqrt(12.);
}

/// Correlation of what two seeds give over many cells, in standard errors.
template <class One, class Other>
double standardised_correlation(const One& one, const Other& other) {
    constexpr int extent = 200;
    double sum = 0;
    for (int j = -extent; j < extent; ++j)
        for (int i = -extent; i < extent; ++i) sum += standardised(one(i, j)) * standardised(other(i, j));
    return sum / (2 * extent);
}

TEST(Seeds, NeighbouringCellsAreIndependent) {
    const std::uint32_t seed = mica::grid_seed(1, grid{-7, 2, 3, 1, 1});
    const auto at = [=](int di, int dj) { return [=](int i, int j) { return mica::cell_seed(seed, i + di, j + dj); }; };
    for (const auto& [di, dj] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 0}, {0, 2}, {256, 0}, {0, 256}})
        EXPECT_LE(std::abs(standardised_correlation(at(0, 0), at(di, dj))), 4.5) << di << ' ' << dj;
}

TEST(Seeds, NeighbouringGridsAreIndependent) {
    const auto of = [](const grid& g, std::uint32_t seed) {
        const std::uint32_t grid_seed = mica::grid_seed(seed, g);
        return [=](int i, int j) { return mica::cell_seed(grid_seed, i, j); };
    };
    const auto one = of({-7, 2, 3, 1, 1}, 1);
    EXPECT_LE(std::abs(standardised_correlation(one, of({-6, 2, 3, 1, 1}, 1))), 4.5);
    EXPECT_LE(std::abs(standardised_correlation(one, of({-7, 3, 3, 1, 1}, 1))), 4.5);
    EXPECT_LE(std::abs(standardised_correlation(one, of({-7, 2, 4, 1, 1}, 1))), 4.5);
    EXPECT_LE(std::abs(standardised_correlation(one, of({-7, 2, 3, 1, 1}, 2))), 4.5);
}

// Cells mirrored or transposed must not share their outcomes either.
TEST(Seeds, NoSymmetry) {
    const std::uint32_t seed = mica::grid_seed(1, grid{-7, 2, 3, 1, 1});
    const auto plain = [=](int i, int j) { return mica::cell_seed(seed, i, j); };
    EXPECT_LE(std::abs(standardised_correlation(plain, [=](int i, int j) { return plain(-i - 1, j); })), 4.5);
    EXPECT_LE(std::abs(standardised_correlation(plain, [=](int i, int j) { return plain(i, -j - 1); })), 4.5);
}

} // namespace
