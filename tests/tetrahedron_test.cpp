// The four grids of a footprint: what the weights promise, that none of them jumps anywhere, and that the cut is the
// published one. The published tessellation (DB23 Fig. 7, ../shared/spec/grid.md) is transcribed here in double, as a
// table of vertex names, and the weights follow from the vertices' coordinates by signed volumes: it shares nothing
// with the header's prisms. With a defect planted in it, it also shows that the walks see a jump.

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <mica/grid/tetrahedron.hpp>

namespace {

using mica::enclosing_tetrahedron;
using mica::footprint;

constexpr double epsilon = std::numeric_limits<float>::epsilon();

footprint<float> pixel_of(double lambda, double ratio, double orientation) {
    const auto sigma_min = static_cast<float>(std::exp2(lambda));
    const auto r = static_cast<float>(ratio);
    // Rounding to float may give 1, which make_footprint never returns: it is 0.
    auto half_turns = static_cast<float>(orientation - std::floor(orientation));
    if (half_turns >= 1) half_turns = 0;
    return {r * sigma_min * sigma_min, r * sigma_min, sigma_min, r, half_turns};
}

/// A pixel's coordinates as they are after rounding to float, in double.
struct coordinates {
    double lambda, ratio, orientation;
};

coordinates coordinates_of(const footprint<float>& pixel) {
    return {std::log2(static_cast<double>(pixel.sigma_min)), static_cast<double>(pixel.ratio),
            static_cast<double>(pixel.orientation)};
}

/// What rounding in float may move a weight by: the coordinate lambda, and a few operations.
double rounding(double lambda) { return epsilon * (16 + 2 * std::abs(lambda)); }

struct weighted_grid {
    int level, log2_ratio, orientation;
    double weight;

    bool same_grid(const weighted_grid& other) const {
        return level == other.level && log2_ratio == other.log2_ratio && orientation == other.orientation;
    }
};
using grid_weights = std::array<weighted_grid, 4>;

grid_weights weights_of(const footprint<float>& pixel) {
    grid_weights result;
    const auto grids = enclosing_tetrahedron(pixel, 1.F);
    for (std::size_t i = 0; i < 4; ++i)
        result[i] = {grids[i].level, grids[i].log2_ratio, grids[i].orientation, static_cast<double>(grids[i].weight)};
    return result;
}

double weight_in(const grid_weights& grids, const weighted_grid& grid) {
    double sum = 0;
    for (const auto& other : grids)
        if (other.same_grid(grid)) sum += other.weight;
    return sum;
}

/// Largest change of the weight of any grid, those that appear or vanish included. NaN if any weight is.
double largest_change(const grid_weights& before, const grid_weights& after) {
    double largest = 0;
    for (const auto* grids : {&before, &after})
        for (const auto& grid : *grids) {
            const double change = std::abs(weight_in(before, grid) - weight_in(after, grid));
            if (!(change <= largest)) largest = change;
        }
    return largest;
}

// --- the published tessellation ---------------------------------------------------------------------------------

enum class defect { none, unwrapped_seam, exchanged_vertices };

using point3 = std::array<double, 3>;

double signed_volume(const point3& a, const point3& b, const point3& c, const point3& d) {
    const point3 x{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const point3 y{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const point3 z{d[0] - a[0], d[1] - a[1], d[2] - a[2]};
    return x[0] * (y[1] * z[2] - y[2] * z[1]) - x[1] * (y[0] * z[2] - y[2] * z[0]) + x[2] * (y[0] * z[1] - y[1] * z[0]);
}

/// The names of the four vertices, upper case for the next level.
std::string_view published_tetrahedron(bool centre, double t, double rho, double L, defect planted) {
    const double x = (L - (1 - rho)) / rho;
    if (centre) {
        if (!(L > 1 - rho)) return "abcB";
        return x > t ? "aBAC" : "CBca";
    }
    if (t < 0.5 && 2 * t < rho) {
        if (!(L > 1 - rho)) return "abcB";
        return x > 2 * t / rho ? "aACB" : "caCB";
    }
    if (1 - 2 * (t - 0.5) > rho) {
        if (!(L < 1 - rho)) return "cBCD";
        // Planted: b moves up before d, so that the faces to the neighbours in orientation no longer agree.
        if (planted == defect::exchanged_vertices) return L > 1 - t - rho / 2 ? "dDBc" : "bdcB";
        return L / (1 - rho) > (t - 0.5 + (1 - rho) / 2) / (1 - rho) ? "bBDc" : "dbcD";
    }
    if (!(L > 1 - rho)) return "decD";
    return x > (2 * (t - 0.5) - (1 - rho)) / rho ? "cECD" : "eDcE";
}

/// Degrees, as published.
grid_weights published_weights(const coordinates& pixel, defect planted) {
    const int level = static_cast<int>(std::floor(pixel.lambda));
    const double L = pixel.lambda - level;
    const int ring = std::ilogb(pixel.ratio);
    const bool centre = ring == 0;
    const double r0 = std::exp2(ring);
    const double rho = (pixel.ratio - r0) / r0;

    const double theta = 180 * pixel.orientation;
    const double g = 90 / std::fmax(r0, 2);
    const double m = std::floor(theta / g) * g + g / 2;
    const double bin0 = theta < m ? m - g / 2 : m;
    double t = (theta - bin0) / (g / 2);
    const auto names = published_tetrahedron(centre, t, rho, L, planted);
    if (centre) t *= rho;

    const auto named = [&](char name) {
        const bool up = name < 'a';
        const int log2_ratio = (up ? name - 'A' : name - 'a') % 2 == 0 ? ring + 1 : ring; // a, c, e: upper ring
        const double position = name == 'a' || name == 'A' || name == 'b' || name == 'B' ? 0
                                : !centre && (name == 'c' || name == 'C')                ? 0.5
                                                                                         : 1;
        const int count = mica::orientations(log2_ratio);
        const double degrees = centre && log2_ratio == 0 ? 0 : bin0 + position * g / 2;
        int index = static_cast<int>(std::lround(degrees / 180 * count));
        if (planted != defect::unwrapped_seam) index %= count;
        return std::pair{weighted_grid{level + up, log2_ratio, index, 0},
                         point3{position, static_cast<double>(log2_ratio - ring), up ? 1. : 0.}};
    };
    std::array<point3, 4> corner;
    grid_weights result;
    for (std::size_t i = 0; i < 4; ++i) std::tie(result[i], corner[i]) = named(names[i]);
    const double volume = signed_volume(corner[0], corner[1], corner[2], corner[3]);
    for (std::size_t i = 0; i < 4; ++i) {
        auto replaced = corner;
        replaced[i] = {t, rho, L};
        result[i].weight = signed_volume(replaced[0], replaced[1], replaced[2], replaced[3]) / volume;
    }
    return result;
}

// --- random pixels ----------------------------------------------------------------------------------------------

class random_pixels {
  public:
    explicit random_pixels(unsigned seed) : random_(seed) {}

    footprint<float> operator()(double log2_largest_ratio, double deepest_level) {
        const double lambda = deepest_level * (2 * unit_(random_) - 1);
        const double ratio = std::exp2(log2_largest_ratio * unit_(random_));
        return pixel_of(lambda, ratio, unit_(random_));
    }

  private:
    std::mt19937 random_;
    std::uniform_real_distribution<double> unit_{0, 1};
};

TEST(Tetrahedron, NumberOfOrientations) {
    EXPECT_EQ(mica::orientations(0), 1);
    for (int log2_ratio = 1; log2_ratio <= 21; ++log2_ratio)
        EXPECT_EQ(mica::orientations(log2_ratio), 4 * (1 << log2_ratio));
}

void expect_valid(const footprint<float>& pixel, float scale) {
    double weights = 0, shares = 0;
    for (const auto& grid : enclosing_tetrahedron(pixel, scale)) {
        ASSERT_TRUE(grid.weight >= 0 && grid.share >= 0);
        ASSERT_TRUE(grid.log2_ratio >= 0 && grid.log2_ratio <= 21);
        ASSERT_TRUE(grid.orientation >= 0 && grid.orientation < mica::orientations(grid.log2_ratio));
        ASSERT_TRUE(grid.level >= mica::smallest_level && grid.level <= mica::largest_level + 1);
        weights += static_cast<double>(grid.weight);
        shares += static_cast<double>(grid.share);
    }
    ASSERT_LE(std::abs(weights - 1), 4 * epsilon);
    ASSERT_LE(std::abs(shares - 1), 4 * epsilon);
}

TEST(Tetrahedron, WeightsAndSharesAreProbabilities) {
    random_pixels random(1);
    for (int i = 0; i < 300000; ++i) {
        expect_valid(random(20, 42), 1.5F);
        if (HasFatalFailure()) return;
    }
}

// The lattice's own points, where tests for > and < decide.
TEST(Tetrahedron, ValidOnFacesAndVertices) {
    for (const double level : {-3., -0.5, 0., 0.25, 1.})
        for (const double ratio : {1., 1.25, 1.5, 2., 2.5, 3., 4., 6., 0x1p20})
            for (int i = 0; i < 64; ++i) {
                expect_valid(pixel_of(level, ratio, i / 64.), 1.F);
                if (HasFatalFailure()) return;
            }
}

TEST(Tetrahedron, SharesAreWeightsTimesAreas) {
    random_pixels random(2);
    for (int i = 0; i < 100000; ++i) {
        const auto grids = enclosing_tetrahedron(random(20, 20), 1.5F);
        double total = 0;
        for (const auto& grid : grids)
            total += static_cast<double>(grid.weight) * std::exp2(grid.log2_ratio + 2 * grid.level);
        for (const auto& grid : grids) {
            const double share = static_cast<double>(grid.weight) * std::exp2(grid.log2_ratio + 2 * grid.level) / total;
            ASSERT_LE(std::abs(static_cast<double>(grid.share) - share), 4 * epsilon);
        }
    }
}

/// sum w x over the four grids, x their coordinates (t, rho, lambda); t times rho in the centre.
point3 barycentre(const footprint<float>& pixel) {
    const int ring = std::ilogb(pixel.ratio);
    const double bins = mica::orientations(ring == 0 ? 1 : ring);
    const double bin = std::floor(static_cast<double>(pixel.orientation) * bins);
    point3 sum{0, 0, 0};
    for (const auto& grid : enclosing_tetrahedron(pixel, 1.F)) {
        double t = grid.orientation * bins / mica::orientations(grid.log2_ratio) - bin;
        if (t < 0) t += bins; // across the seam
        if (grid.log2_ratio == 0) t = 0;
        const point3 position{t, static_cast<double>(grid.log2_ratio - ring), static_cast<double>(grid.level)};
        for (std::size_t i = 0; i < 3; ++i) sum[i] += static_cast<double>(grid.weight) * position[i];
    }
    return sum;
}

TEST(Tetrahedron, WeightsReproduceThePoint) {
    random_pixels random(3);
    for (int i = 0; i < 300000; ++i) {
        const auto pixel = random(20, 20);
        const auto truth = coordinates_of(pixel);
        const int ring = std::ilogb(pixel.ratio);
        const double rho = truth.ratio / std::exp2(ring) - 1;
        const double position = truth.orientation * mica::orientations(ring == 0 ? 1 : ring);
        const double t = (position - std::floor(position)) * (ring == 0 ? rho : 1);
        const auto found = barycentre(pixel);
        ASSERT_LE(std::abs(found[0] - t), 8 * epsilon);
        ASSERT_LE(std::abs(found[1] - rho), 8 * epsilon);
        // The weights sum to 1 within 4 epsilon, and here they multiply levels of up to 21.
        ASSERT_LE(std::abs(found[2] - truth.lambda), 8 * epsilon * (1 + std::abs(truth.lambda)));
    }
}

TEST(Tetrahedron, IsThePublishedTessellation) {
    random_pixels random(4);
    double worst = 0;
    for (int i = 0; i < 300000; ++i) {
        const auto pixel = random(i % 2 == 0 ? 3 : 14, 20);
        const auto truth = coordinates_of(pixel);
        const double difference = largest_change(weights_of(pixel), published_weights(truth, defect::none));
        ASSERT_LE(difference, rounding(truth.lambda))
            << "lambda " << truth.lambda << " ratio " << truth.ratio << " orientation " << truth.orientation;
        worst = std::fmax(worst, difference);
    }
    std::printf("largest difference from the published weights: %.2g\n", worst);
}

// --- no jump ----------------------------------------------------------------------------------------------------
//
// In every tetrahedron a weight is linear in (t, rho, L), in the centre bilinear in (t, rho), with derivatives of at
// most 2 by t (2t, rho - 2t, 2t - 1), 1 by rho and 1 by L. So, if nothing jumps, a step changes a weight by at most
// 2 dt + d rho + dL, where dt is measured in the finer and d rho in the lower of the rings it meets, plus rounding.

double step_bound(const coordinates& a, const coordinates& b) {
    const double apart = std::abs(a.orientation - b.orientation);
    const double turn = std::fmin(apart, 1 - apart);
    const int finer = (std::max)(1, std::ilogb(std::fmax(a.ratio, b.ratio)));
    const double lower = std::exp2(std::ilogb(std::fmin(a.ratio, b.ratio)));
    return 2 * turn * mica::orientations(finer) + std::abs(a.ratio - b.ratio) / lower + std::abs(a.lambda - b.lambda) +
           2 * rounding(std::fmax(std::abs(a.lambda), std::abs(b.lambda)));
}

/// The largest ratio of change to bound along a path: at most 1 where nothing jumps.
template <class Weights, class Path>
double largest_jump(int steps, const Path& path, const Weights& weights) {
    double worst = 0;
    auto pixel = path(0.);
    auto before = weights(pixel);
    for (int i = 1; i <= steps; ++i) {
        const auto next = path(static_cast<double>(i) / steps);
        const auto after = weights(next);
        const double jump = largest_change(before, after) / step_bound(coordinates_of(pixel), coordinates_of(next));
        if (!(jump <= worst)) worst = jump;
        pixel = next;
        before = after;
    }
    return worst;
}

/// As many steps over half a turn as make small ones in t, where float still resolves them.
int steps_around(double ratio) { return static_cast<int>(std::fmin(200 * 4 * ratio, 200000)); }

template <class Weights>
double largest_jump_around(double ratio, double lambda, const Weights& weights) {
    const auto path = [=](double s) { return pixel_of(lambda, ratio, 0.37 + s); }; // through the seam
    return largest_jump(steps_around(ratio), path, weights);
}

TEST(Tetrahedron, NoJumpThroughLevels) {
    for (const double ratio : {1., 1.3, 1.9999, 2., 2.7, 5.5, 100., 1e4})
        for (const double orientation : {0., 0.013, 0.3, 0.77, 0.99999}) {
            const auto path = [=](double s) { return pixel_of(-3 + 6 * s, ratio, orientation); };
            EXPECT_LE(largest_jump(6000, path, weights_of), 1.) << ratio << ' ' << orientation;
        }
}

TEST(Tetrahedron, NoJumpThroughRatios) {
    for (const double lambda : {-2.9, -0.01, 0., 0.4, 0.75})
        for (const double orientation : {0., 0.013, 0.3, 0.77, 0.99999}) {
            const auto path = [=](double s) { return pixel_of(lambda, std::pow(1e4, s), orientation); };
            EXPECT_LE(largest_jump(20000, path, weights_of), 1.) << lambda << ' ' << orientation;
        }
}

TEST(Tetrahedron, NoJumpThroughOrientations) {
    for (const double ratio : {1.01, 1.6, 2., 2.4, 3.9, 7., 50., 1e3, 1e4})
        for (const double lambda : {-0.9, -0.4, 0.1})
            EXPECT_LE(largest_jump_around(ratio, lambda, weights_of), 1.) << ratio << ' ' << lambda;
}

/// A line through level, ratio (in its logarithm) and orientation that crosses many cells in random directions.
template <class Weights>
double largest_jump_on_lines(int lines, double log2_largest_ratio, const Weights& weights) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    double worst = 0;
    for (int i = 0; i < lines; ++i) {
        const double lambda = 6 * unit(random) - 3, rise = 4 * unit(random) - 2;
        const double from = log2_largest_ratio * unit(random), to = log2_largest_ratio * unit(random);
        const double turn = unit(random), turned = 4 * (unit(random) - 0.5) / std::exp2(std::fmax(from, to));
        const auto path = [=](double s) {
            return pixel_of(lambda + rise * s, std::exp2(from + (to - from) * s), turn + turned * s);
        };
        const double jump = largest_jump(2000, path, weights);
        if (!(jump <= worst)) worst = jump;
    }
    return worst;
}

TEST(Tetrahedron, NoJumpOnRandomLines) {
    EXPECT_LE(largest_jump_on_lines(150, 2.5, weights_of), 1.);
    EXPECT_LE(largest_jump_on_lines(150, 13, weights_of), 1.);
}

// The walks must see what they are for: the two classic mistakes in a copy of the construction.
TEST(Tetrahedron, WalksSeePlantedDefects) {
    const auto published = [](defect planted) {
        return [planted](const footprint<float>& pixel) { return published_weights(coordinates_of(pixel), planted); };
    };
    EXPECT_LE(largest_jump_around(3, -0.4, published(defect::none)), 1.);
    EXPECT_LE(largest_jump_on_lines(20, 4, published(defect::none)), 1.);
    EXPECT_GE(largest_jump_around(3, -0.4, published(defect::unwrapped_seam)), 10.);
    EXPECT_GE(largest_jump_on_lines(20, 4, published(defect::exchanged_vertices)), 10.);
}

// A footprint turned by half a turn is the same footprint.
TEST(Tetrahedron, HalfATurnIsNoTurn) {
    const auto one = weights_of(mica::make_footprint<float>({-0.3F, 0.2F, 0.1F, 0.9F}));
    const auto turned = weights_of(mica::make_footprint<float>({0.3F, -0.2F, -0.1F, -0.9F}));
    EXPECT_EQ(largest_change(one, turned), 0.);
}

// --- the edges of the domain ------------------------------------------------------------------------------------

TEST(Tetrahedron, ScaleMovesTheLevelOnly) {
    const auto one = enclosing_tetrahedron(pixel_of(-4.3, 3.1, 0.2), 1.F);
    const auto eight = enclosing_tetrahedron(pixel_of(-4.3, 3.1, 0.2), 8.F);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(eight[i].level, one[i].level + 3);
        EXPECT_EQ(eight[i].log2_ratio, one[i].log2_ratio);
        EXPECT_EQ(eight[i].orientation, one[i].orientation);
        EXPECT_NEAR(eight[i].weight, one[i].weight, 16 * epsilon);
    }
}

void expect_only_level(const footprint<float>& pixel, int level) {
    for (const auto& grid : enclosing_tetrahedron(pixel, 1.F))
        EXPECT_TRUE(grid.level == level || grid.weight == 0) << grid.level;
}

TEST(Tetrahedron, LevelsStop) {
    expect_only_level(pixel_of(-120, 3, 0.2), mica::smallest_level);
    expect_only_level(pixel_of(120, 3, 0.2), mica::largest_level);
}

TEST(Tetrahedron, AnyScaleGivesWeights) {
    const float infinity = std::numeric_limits<float>::infinity();
    for (const float scale :
         {0.F, -0.F, -1.F, 1e-45F, 1e-38F, 3e38F, infinity, -infinity, std::numeric_limits<float>::quiet_NaN()}) {
        expect_valid(pixel_of(-4.3, 3.1, 0.2), scale);
        expect_valid({0, 0, 0, 1, 0}, scale);
    }
}

TEST(Tetrahedron, DegenerateFootprintsGiveWeights) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    for (const auto& m : std::vector<mica::uv_derivatives<float>>{{0, 0, 0, 0},
                                                                  {nan, 1, 1, 2},
                                                                  {infinity, 1, 1, 2},
                                                                  {3, 4, 0, 0},
                                                                  {0, 0, 3, 4},
                                                                  {1, 0, 0, 1e-30F},
                                                                  {1e-30F, 0, 0, 1e-30F},
                                                                  {1e-45F, 0, 0, 1e-45F},
                                                                  {1e30F, 0, 0, 2e30F},
                                                                  {3e38F, 3e38F, 3e38F, -3e38F}})
        expect_valid(mica::make_footprint(m), 1.5F);
}

} // namespace
