// Blended variates: every pixel has exactly the law, at one evaluation, and nothing jumps on the way from pixel to pixel.
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <mica/grid/distributed.hpp>
#include <mica/law/batch.hpp>
#include <mica/law/exact.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>

#include "binomial_fit.hpp"

namespace {

using mica::blended_uniforms;
using mica::blended_variates;
using mica::distributed_binomial;
using mica::distributed_multinomial;
using mica::exact_binomial;
using mica::half_vector_point;
using mica::interpolated_counts;
using mica::pack;
using mica::softened_variates;
using mica::uniform_stream;
using mica::uv_derivatives;
using mica::uv_point;

/// Derivatives of a pixel whose footprint has the minor semi-axis 2^level / scale, so that it lies `level` levels up.
struct shape {
    float ratio;
    float turn;  ///< of the major axis, in half turns
    float level; ///< 0: on a level, 0.5: between two
};

template <class Real>
uv_derivatives<Real> derivatives_of(Real ratio, Real turn, Real level, Real screen_turn = Real(0)) {
    const Real width = mica::exp2(level - Real(10)) * Real(1 / mica::default_footprint_scale);
    const auto [s, c] = mica::half_turns(turn);
    const auto [a, b] = mica::half_turns(screen_turn);
    const Real u1 = ratio * width * c, v1 = ratio * width * s, u2 = -width * s, v2 = width * c;
    return {b * u1 + a * u2, b * v1 + a * v2, b * u2 - a * u1, b * v2 - a * v1};
}

const std::vector<shape> shapes{{1, 0, 0},      {1.3F, 0.1F, 0.5F}, {4, 0, 0.25F},    {5.7F, 0.37F, 0.5F},
                                {16, 0.71F, 0}, {23, 0.2F, 0.6F},   {64, 0.5F, 0.1F}, {90, 0.83F, 0.5F}};

/// Pixels of one shape at random places, each on a surface of its own.
template <class Real>
auto pixel_of(const shape& s, Real trials, mica::index_of<Real> index) {
    uniform_stream<Real> place(mica::index_of<Real>(5U), index);
    const Real u = place(), v = place();
    const auto footprint = mica::make_footprint(derivatives_of(Real(s.ratio), Real(s.turn), Real(s.level)));
    auto vertices = mica::make_grid_vertices(footprint, uv_point<Real>{u, v}, trials, 1U);
    // A surface of its own for every lane: seeds apart by what the index says.
    for (auto& grid : vertices.grids)
        for (auto& vertex : grid.vertices) vertex.seed = vertex.seed ^ mica::mix(index);
    return vertices;
}

template <class Real>
auto pixel_with_half_vector(const shape& s, Real trials, mica::index_of<Real> index) {
    uniform_stream<Real> place(mica::index_of<Real>(6U), index);
    const Real u = place(), v = place(), x = Real(20) * place() - Real(10), y = Real(20) * place() - Real(10);
    const auto footprint = mica::make_footprint(derivatives_of(Real(s.ratio), Real(s.turn), Real(s.level)));
    auto vertices =
        mica::make_grid_vertices(footprint, uv_point<Real>{u, v}, half_vector_point<Real>{x, y}, trials, 1U);
    for (auto& grid : vertices.grids)
        for (auto& vertex : grid.vertices)
            for (auto& cell : vertex.cells) cell.seed = cell.seed ^ mica::mix(index);
    return vertices;
}

constexpr int lanes = 8;
using number = pack<float, lanes>;
using index_pack = mica::index_of<number>;

/// draw(first index of eight) for so many pixels, value by value.
template <class Draw, class Use>
void each_pixel(int pixels, const Draw& draw, const Use& use) {
    for (int i = 0; i < pixels; i += lanes) {
        const number drawn = draw(index_pack::iota(static_cast<std::uint32_t>(i)));
        for (int k = 0; k < lanes; ++k) use(static_cast<double>(drawn[k]));
    }
}

// --- normal variates ----------------------------------------------------------------------------------------------

TEST(NormalPair, IsStandardNormal) {
    constexpr int draws = 1 << 22, cells = 200;
    for (const bool second : {false, true}) {
        statistics::histogram observed(0, 1, cells, cells - 1);
        statistics::running_moments moments;
        each_pixel(
            draws,
            [&](index_pack i) {
                const auto pair = mica::normal_pair_from_bits<number>(mica::hash(i));
                return second ? pair.second : pair.first;
            },
            [&](double z) {
                observed.add(std::floor(cells * statistics::normal_cdf(z)));
                moments.add(z);
            });
        const std::vector<double> probabilities(cells, 1. / cells);
        EXPECT_TRUE(statistics::passes(statistics::goodness_of_fit(probabilities, observed.observed()).p_value));
        EXPECT_TRUE(statistics::passes(statistics::mean_p_value(moments, 0, 1)));
        EXPECT_TRUE(statistics::passes(statistics::variance_p_value(moments, 1)));
    }
}

// All of the 2^22 smallest radii: the far tail, whose angles are a golden-section sequence.
TEST(NormalPair, HasTheWholeTail) {
    constexpr double bits = 0x1p22, part = bits / 0x1p32;
    double beyond[2] = {};
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(bits); ++i) {
        const auto pair = mica::normal_pair_from_bits<float>(i);
        beyond[0] += std::abs(pair.first) > 4.5F;
        beyond[1] += std::abs(pair.second) > 4.5F;
    }
    // A radius this large has probability 2^-10, so all that goes beyond 4.5 is here.
    const double expected = bits / part * std::erfc(4.5 / std::sqrt(2.));
    for (const double count : beyond) EXPECT_LE(std::abs(count / expected - 1), 0.01) << count << ' ' << expected;
}

TEST(NormalPair, OfDoubleIsThatOfFloat) {
    for (std::uint32_t i = 0; i < 100000; ++i) {
        const auto bits = mica::hash(i);
        const auto one = mica::normal_pair_from_bits<float>(bits);
        const auto two = mica::normal_pair_from_bits<double>(bits);
        ASSERT_NEAR(static_cast<double>(one.first), two.first, 2e-5 * (1 + std::abs(two.first)));
        ASSERT_NEAR(static_cast<double>(one.second), two.second, 2e-5 * (1 + std::abs(two.second)));
    }
}

// --- the law --------------------------------------------------------------------------------------------------------

class EveryShape : public ::testing::TestWithParam<shape> {};

TEST_P(EveryShape, UniformsAreUniform) {
    constexpr int draws = 1 << 19, cells = 256;
    const std::vector<double> probabilities(cells, 1. / cells);
    for (const int skipped : {0, 1, 2}) {
        statistics::histogram observed(0, 1, cells, cells - 1);
        each_pixel(
            draws,
            [&](index_pack i) {
                const auto vertices = pixel_of<number>(GetParam(), number(1), i);
                blended_uniforms xi(vertices);
                for (int k = 0; k < skipped; ++k) xi();
                return xi();
            },
            [&](double u) { observed.add(std::floor(cells * u)); });
        EXPECT_TRUE(statistics::passes(statistics::goodness_of_fit(probabilities, observed.observed()).p_value));
    }
}

TEST_P(EveryShape, ExactBinomialStaysExact) {
    for (const auto& c : {statistics::binomial_case{50, 0.02}, {1.5, 0.5}, {0.5, 0.2}, {400.25, 0.2}}) {
        statistics::binomial_sample sample(c);
        each_pixel(
            1 << 19,
            [&](index_pack i) {
                const auto pixel = pixel_of<number>(GetParam(), number(static_cast<float>(c.trials)), i);
                return distributed_binomial<exact_binomial>{}(pixel, static_cast<float>(c.probability));
            },
            [&](double count) { sample.add(count); });
        EXPECT_TRUE(statistics::passes(sample.judge().p_value)) << c;
    }
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, ::testing::ValuesIn(shapes));

TEST(Blended, ExactBinomialStaysExactWithHalfVectors) {
    for (const auto& s : {shapes[1], shapes[5]}) {
        const statistics::binomial_case c{30.5, 0.1};
        statistics::binomial_sample sample(c);
        each_pixel(
            1 << 18,
            [&](index_pack i) {
                return distributed_binomial<exact_binomial>{}(pixel_with_half_vector<number>(s, number(30.5F), i),
                                                              number(0.1F));
            },
            [&](double count) { sample.add(count); });
        EXPECT_TRUE(statistics::passes(sample.judge().p_value));
    }
}

// The joint law of four categories: means, variances and covariances of a multinomial.
/// All covariances of four categories, one missing to sum 1, over pixels of a shape, against those of the multinomial: within
/// their own standard errors and half a percent.
template <class Law>
void expect_multinomial_covariances(const shape& s, const char* what) {
    constexpr std::size_t K = 4;
    const std::array<double, K> p{0.3, 0.05, 0.2, 0.1};
    std::array<number, K> probabilities;
    for (std::size_t k = 0; k < K; ++k) probabilities[k] = number(static_cast<float>(p[k]));
    constexpr double trials = 40;
    constexpr int pixels = 1 << 17;
    std::array<std::array<statistics::running_moments, K>, K> products;
    for (int i = 0; i < pixels; i += lanes) {
        const auto pixel = pixel_of<number>(s, number(40.F), index_pack::iota(static_cast<std::uint32_t>(i)));
        const auto counts = distributed_multinomial<K, Law>{}(pixel, probabilities);
        for (int lane = 0; lane < lanes; ++lane)
            for (std::size_t a = 0; a < K; ++a)
                for (std::size_t b = a; b < K; ++b)
                    products[a][b].add((static_cast<double>(counts[a][lane]) - trials * p[a]) *
                                       (static_cast<double>(counts[b][lane]) - trials * p[b]));
    }
    for (std::size_t a = 0; a < K; ++a)
        for (std::size_t b = a; b < K; ++b) {
            const double truth = trials * (a == b ? p[a] * (1 - p[a]) : -p[a] * p[b]);
            const auto& measured = products[a][b];
            EXPECT_LE(std::abs(measured.mean() - truth), 4.5 * measured.standard_error() + 0.005 * std::abs(truth))
                << what << ", categories " << a << ' ' << b;
            EXPECT_LE(measured.standard_error(), 0.02 * trials * std::sqrt(p[a] * (1 - p[a]) * p[b] * (1 - p[b])));
        }
}

TEST(Blended, MultinomialsCovary) {
    for (const auto& s : shapes) {
        expect_multinomial_covariances<exact_binomial>(s, "exact");
        expect_multinomial_covariances<mica::quantile_binomial<4>>(s, "quantile 4");
        expect_multinomial_covariances<mica::quantile_binomial<8>>(s, "quantile 8");
    }
}

TEST(Blended, LightsAreIndependent) {
    statistics::running_covariance covariance;
    for (std::uint32_t i = 0; i < 100000; ++i) {
        const auto pixel = pixel_of<float>(shapes[3], 1, i);
        covariance.add(static_cast<double>(blended_uniforms(pixel, 0).normal()),
                       static_cast<double>(blended_uniforms(pixel, 1).normal()));
    }
    EXPECT_LE(std::abs(covariance.covariance()) * std::sqrt(100000.), 4.5);
}

// The published counts: half of the variance, with half vectors two ninths.
TEST(Blended, InterpolatedCountsLoseTheVariance) {
    const double variance = 100 * 0.2 * 0.8;
    statistics::running_moments plain, angular;
    const distributed_binomial<exact_binomial, interpolated_counts> count;
    for (std::uint32_t i = 0; i < 20000; ++i) {
        plain.add(static_cast<double>(count(pixel_of<float>(shapes[3], 100, i), 0.2F)));
        angular.add(static_cast<double>(count(pixel_with_half_vector<float>(shapes[3], 100, i), 0.2F)));
    }
    EXPECT_LE(std::abs(plain.variance() / variance - 0.5), 0.03);
    EXPECT_LE(std::abs(angular.variance() / variance - 2. / 9), 0.02);
    EXPECT_LE(std::abs(angular.mean() - 20), 4.5 * angular.standard_error());
}

// One grid instead of four, by its share: the mean is the same.
TEST(Blended, OneGridHasTheMean) {
    statistics::running_moments sample;
    const distributed_binomial<exact_binomial, interpolated_counts> count;
    for (std::uint32_t i = 0; i < 100000; ++i) {
        uniform_stream<float> place(9, i);
        const float u = place(), v = place();
        const auto footprint = mica::make_footprint(derivatives_of<float>(5.7F, 0.37F, 0.5F));
        const auto one = mica::make_one_grid_vertices(footprint, uv_point<float>{u, v}, 20, i, place());
        sample.add(static_cast<double>(count(one, 0.1F)));
    }
    EXPECT_LE(std::abs(sample.mean() - 2), 4.5 * sample.standard_error());
}

TEST(Blended, VariedDensityKeepsTheMean) {
    statistics::running_moments trials, counts;
    for (std::uint32_t i = 0; i < 200000; ++i) {
        const auto pixel = mica::with_varied_density(pixel_of<float>(shapes[3], 100, i), 0.5F);
        trials.add(static_cast<double>(pixel.trials));
        counts.add(static_cast<double>(distributed_binomial<exact_binomial, interpolated_counts>{}(pixel, 0.1F)));
    }
    EXPECT_LE(std::abs(trials.mean() - 100), 4.5 * trials.standard_error() + 0.2);
    EXPECT_LE(std::abs(counts.mean() - 10), 4.5 * counts.standard_error() + 0.02);
    // A lognormal variance: 100^2 (exp(s^2) - 1).
    EXPECT_LE(std::abs(trials.variance() / (1e4 * std::expm1(0.25)) - 1), 0.05);
}

// --- packs are scalars side by side ---------------------------------------------------------------------------------

/// Softened counts, of a varied density, of one grid, of categories.
template <class Real, class Surface, class Angular, class OneGrid>
std::array<Real, 11> counts_of_all_kinds(const Surface& surface, const Angular& angular, const OneGrid& one_grid,
                                         Real p) {
    using law = mica::quantile_binomial<4>;
    const softened_variates soft{0.2F};
    const std::array<Real, 2> classes{Real(0.25F) * p, Real(0.5F) * p};
    const auto varied = mica::with_varied_density(surface, Real(0.5F));
    const auto varied_angular = mica::with_varied_density(angular, Real(0.5F));
    const auto categories = distributed_multinomial<2, law>{}(surface, classes);
    const auto soft_categories = distributed_multinomial<2, law, softened_variates>{soft}(surface, classes);
    const auto interpolated = distributed_multinomial<2, law, interpolated_counts>{}(angular, classes);
    return {distributed_binomial<law, softened_variates>{soft}(surface, p),
            distributed_binomial<law, softened_variates>{soft}(angular, p),
            distributed_binomial<law>{}(varied, p),
            distributed_binomial<law, interpolated_counts>{}(varied_angular, p),
            distributed_binomial<law, interpolated_counts>{}(one_grid, p),
            categories[0],
            categories[1],
            soft_categories[0],
            soft_categories[1],
            interpolated[0],
            interpolated[1]};
}

TEST(Blended, PacksEqualScalarsToTheLastBit) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1, 1);
    for (int round = 0; round < 2000; ++round) {
        uv_derivatives<number> m;
        uv_point<number> uv;
        half_vector_point<number> half_vector;
        number trials, p;
        const float scale = std::exp2(8 * unit(random));
        for (int i = 0; i < lanes; ++i) {
            m.du_dx.set(i, scale * unit(random));
            m.dv_dx.set(i, scale * unit(random));
            m.du_dy.set(i, scale * unit(random) * 0.01F);
            m.dv_dy.set(i, scale * unit(random) * 0.01F);
            uv.u.set(i, unit(random));
            uv.v.set(i, unit(random));
            half_vector.x.set(i, 10 * unit(random));
            half_vector.y.set(i, 10 * unit(random));
            trials.set(i, std::exp2(10 * unit(random)));
            p.set(i, std::exp2(-5 + 5 * unit(random)));
        }
        const auto footprint = mica::make_footprint(m);
        const auto vertices = mica::make_grid_vertices(footprint, uv, trials, 7U);
        const auto with_half = mica::make_grid_vertices(footprint, uv, half_vector, trials, 7U);
        const number blended = distributed_binomial<mica::smooth_quantile_binomial<4>>{}(vertices, p);
        const number exact = distributed_binomial<exact_binomial>{}(vertices, p);
        const number counted = distributed_binomial<mica::quantile_binomial<4>, interpolated_counts>{}(vertices, p);
        const number angular = distributed_binomial<mica::quantile_binomial<4>>{}(with_half, p);
        const number choice = number(0.5F) + number(0.499F) * uv.u;
        const auto chosen = mica::make_one_grid_vertices(footprint, uv, trials, 7U, choice);
        const auto all = counts_of_all_kinds(vertices, with_half, chosen, p);
        for (int i = 0; i < lanes; ++i) {
            const auto one = mica::make_footprint<float>({m.du_dx[i], m.dv_dx[i], m.du_dy[i], m.dv_dy[i]});
            ASSERT_EQ(one.sigma_min, footprint.sigma_min[i]);
            ASSERT_EQ(one.orientation, footprint.orientation[i]);
            const uv_point<float> at{uv.u[i], uv.v[i]};
            const half_vector_point<float> h{half_vector.x[i], half_vector.y[i]};
            const auto alone = mica::make_grid_vertices(one, at, trials[i], 7U);
            const auto alone_with_half = mica::make_grid_vertices(one, at, h, trials[i], 7U);
            ASSERT_EQ(alone.grids[2].vertices[1].seed, vertices.grids[2].vertices[1].seed[i]);
            ASSERT_EQ(distributed_binomial<mica::smooth_quantile_binomial<4>>{}(alone, p[i]), blended[i]);
            ASSERT_EQ(distributed_binomial<exact_binomial>{}(alone, p[i]), exact[i]);
            ASSERT_EQ((distributed_binomial<mica::quantile_binomial<4>, interpolated_counts>{}(alone, p[i])),
                      counted[i]);
            ASSERT_EQ(distributed_binomial<mica::quantile_binomial<4>>{}(alone_with_half, p[i]), angular[i]);
            const auto alone_chosen = mica::make_one_grid_vertices(one, at, trials[i], 7U, choice[i]);
            const auto all_alone = counts_of_all_kinds(alone, alone_with_half, alone_chosen, p[i]);
            for (std::size_t kind = 0; kind < all.size(); ++kind) ASSERT_EQ(all_alone[kind], all[kind][i]) << kind;
        }
    }
}

template <class Vertices>
void expect_equal_vertices(const Vertices& one, const Vertices& other) {
    EXPECT_EQ(one.trials, other.trials);
    for (std::size_t g = 0; g < one.grids.size(); ++g) {
        EXPECT_EQ(one.grids[g].variate_weight, other.grids[g].variate_weight);
        for (std::size_t v = 0; v < 3; ++v) {
            const auto &a = one.grids[g].vertices[v], &b = other.grids[g].vertices[v];
            EXPECT_TRUE(a.seed == b.seed && a.trials == b.trials && a.weight == b.weight &&
                        a.variate_weight == b.variate_weight);
            for (std::size_t c = 0; c < a.cells.size(); ++c)
                EXPECT_TRUE(a.cells[c].seed == b.cells[c].seed && a.cells[c].weight == b.cells[c].weight);
        }
    }
}

// Lights from several directions may share the vertices of the surface; its density may vary before or after.
TEST(Blended, HalfVectorsAreAddedToASurface) {
    for (std::uint32_t i = 0; i < 1000; ++i) {
        uniform_stream<float> xi(25, i);
        const auto& s = shapes[i % shapes.size()];
        const auto footprint = mica::make_footprint(derivatives_of(s.ratio, s.turn, s.level));
        const uv_point<float> uv{xi(), xi()};
        const auto surface = mica::make_grid_vertices(footprint, uv, 30, 1U);
        const auto varied = mica::with_varied_density(surface, 0.5F);
        for (int light = 0; light < 3; ++light) {
            const half_vector_point<float> h{20 * xi() - 10, 20 * xi() - 10};
            const auto direct = mica::make_grid_vertices(footprint, uv, h, 30, 1U);
            expect_equal_vertices(mica::with_half_vector(surface, h), direct);
            expect_equal_vertices(mica::with_half_vector(varied, h), mica::with_varied_density(direct, 0.5F));
        }
    }
}

// --- nothing jumps ------------------------------------------------------------------------------------------------

/// What a walk goes along, t from 0 to 1, and how many cells it passes at most.
struct walk {
    const char* name;
    std::function<mica::grid_vertices<double, 4>(double)> at;
};

mica::grid_vertices<double, 4> double_pixel(double ratio, double turn, double level, uv_point<double> uv,
                                            half_vector_point<double> half_vector) {
    const auto footprint = mica::make_footprint(derivatives_of<double>(ratio, turn, level));
    return mica::make_grid_vertices(footprint, uv, half_vector, 100., 3U);
}

/// Largest change of f between neighbours of n steps.
template <class F>
double largest_change(int steps, const F& f) {
    double largest = 0, before = f(0.);
    for (int i = 1; i <= steps; ++i) {
        const double after = f(static_cast<double>(i) / steps);
        largest = std::max(largest, std::abs(after - before));
        before = after;
    }
    return largest;
}

// A continuous function's largest change falls with the length of the steps (as their square root where the weights of a
// barycentric blend start from 0, as the first power elsewhere); a jump's does not. In double, where nothing is rounded.
TEST(Blended, VariatesHaveNoJump) {
    const std::vector<walk> walks{{"uv",
                                   [](double t) {
                                       return double_pixel(5.7, 0.37, 0.5, {0.3 + t * 0.01, 0.4 - t * 0.02}, {1, 2});
                                   }},
                                  {"scale",
                                   [](double t) {
                                       return double_pixel(5.7, 0.37, 0.2 + 3 * t, {0.3, 0.4}, {1, 2});
                                   }},
                                  {"ratio",
                                   [](double t) {
                                       return double_pixel(1 + 39 * t, 0.37, 0.5, {0.03, 0.04}, {1, 2});
                                   }},
                                  {"rotation",
                                   [](double t) {
                                       return double_pixel(5.7, 0.999 * t, 0.5, {0.03, 0.04}, {1, 2});
                                   }},
                                  {"half vector", [](double t) {
                                       return double_pixel(5.7, 0.37, 0.5, {0.3, 0.4}, {-2 + 4 * t, 1 - 3 * t});
                                   }}};
    for (const auto& w : walks) {
        const auto z = [&](double t) {
            const auto pixel = w.at(t);
            return blended_uniforms(pixel).normal();
        };
        const auto smooth = [&](double t) {
            return distributed_binomial<mica::smooth_quantile_binomial<4>>{}(w.at(t), 0.02);
        };
        const auto soft = [&](double t) {
            return distributed_binomial<mica::quantile_binomial<4>, softened_variates>{{0.3F}}(w.at(t), 0.02);
        };
        const double coarse = largest_change(2000, z), fine = largest_change(32000, z);
        std::printf("%s: largest change of z %.3g in 2000 steps, %.3g in 32000\n", w.name, coarse, fine);
        EXPECT_LE(fine, 0.6 * coarse) << w.name;
        EXPECT_LE(fine, 0.05) << w.name;
        EXPECT_LE(largest_change(32000, soft), 0.6 * largest_change(2000, soft)) << w.name;
        EXPECT_LE(largest_change(32000, smooth), 0.6 * largest_change(2000, smooth)) << w.name;
        // A law of integers jumps however small the steps: the same bound must fail for it.
        const auto jumping = [&](double t) {
            return distributed_binomial<mica::quantile_binomial<4>>{}(w.at(t), 0.02);
        };
        EXPECT_GT(largest_change(32000, jumping), 0.6 * largest_change(2000, jumping)) << w.name;
    }
}

// Mirrored half vectors are other half vectors.
TEST(Blended, HalfVectorsAreNotMirrored) {
    statistics::running_covariance covariance;
    for (std::uint32_t i = 0; i < 20000; ++i) {
        uniform_stream<float> place(11, i);
        const uv_point<float> uv{place(), place()};
        const float x = 1 + 9 * place(), y = 1 + 9 * place();
        const auto footprint = mica::make_footprint(derivatives_of<float>(2, 0.3F, 0.4F));
        const auto one = mica::make_grid_vertices(footprint, uv, half_vector_point<float>{x, y}, 1, 1U);
        const auto other = mica::make_grid_vertices(footprint, uv, half_vector_point<float>{-x, y}, 1, 1U);
        covariance.add(static_cast<double>(blended_uniforms(one).normal()),
                       static_cast<double>(blended_uniforms(other).normal()));
    }
    EXPECT_LE(std::abs(covariance.covariance()) * std::sqrt(20000.), 4.5);
}

/// Covariance of the variates of two pixels: of the weights of the vertices that they share.
double shared(const mica::grid_vertices<float>& a, const mica::grid_vertices<float>& b) {
    double sum = 0;
    for (const auto& grid_a : a.grids)
        for (const auto& vertex_a : grid_a.vertices)
            for (const auto& grid_b : b.grids)
                for (const auto& vertex_b : grid_b.vertices)
                    if (vertex_a.seed == vertex_b.seed)
                        sum += static_cast<double>(grid_a.variate_weight * vertex_a.variate_weight) *
                               static_cast<double>(grid_b.variate_weight * vertex_b.variate_weight);
    return sum;
}

/// Pixels at which the mean autocorrelation falls to one half, along the pixel's x or y.
double half_width(const uv_derivatives<float>& m, bool along_x) {
    const auto footprint = mica::make_footprint(m);
    constexpr int places = 300, steps_per_pixel = 8;
    double before = 1;
    for (int lag = 1; lag <= 4 * steps_per_pixel; ++lag) {
        const float t = static_cast<float>(lag) / steps_per_pixel;
        double sum = 0;
        for (std::uint32_t k = 0; k < places; ++k) {
            uniform_stream<float> place(13, k);
            const uv_point<float> here{place(), place()};
            const uv_point<float> there{here.u + t * (along_x ? m.du_dx : m.du_dy),
                                        here.v + t * (along_x ? m.dv_dx : m.dv_dy)};
            sum += shared(mica::make_grid_vertices(footprint, here, 1.F, 1U),
                          mica::make_grid_vertices(footprint, there, 1.F, 1U));
        }
        const double correlation = sum / places;
        if (correlation <= 0.5) return (lag - 1 + (before - 0.5) / (before - correlation)) / steps_per_pixel;
        before = correlation;
    }
    return 4;
}

// A glint is as large as a pixel: the autocorrelation is neither wider, nor so narrow that glints would alias.
TEST(Blended, GlintsAreAPixelLarge) {
    double narrowest = 4, widest = 0;
    for (const double ratio : {1., 4., 16., 64.})
        for (const double fraction : {0., 0.25, 0.5, 0.75})
            for (const double turn : {0., 0.13, 0.37}) {
                const double width = std::exp2(-10 + fraction) / static_cast<double>(mica::default_footprint_scale);
                const double c = std::cos(std::numbers::pi * turn), s = std::sin(std::numbers::pi * turn);
                const auto narrow = [](double x) { return static_cast<float>(x); };
                const uv_derivatives<float> m{narrow(ratio * width * c), narrow(ratio * width * s), narrow(-width * s),
                                              narrow(width * c)};
                for (const bool along_x : {true, false}) {
                    const double measured = half_width(m, along_x);
                    narrowest = std::min(narrowest, measured);
                    widest = std::max(widest, measured);
                    EXPECT_LE(measured, 1.01) << ratio << ' ' << fraction << ' ' << turn << ' ' << along_x;
                    EXPECT_GE(measured, 0.6) << ratio << ' ' << fraction << ' ' << turn << ' ' << along_x;
                }
            }
    std::printf("half widths of the autocorrelation: %.2f to %.2f pixels\n", narrowest, widest);
}

// --- independence ----------------------------------------------------------------------------------------------------

// Two cells apart no vertex is shared.
TEST(Blended, TwoCellsApartPixelsAreIndependent) {
    // The largest cells of a footprint are four glints wide along its pixels, so 10 and 20 pixels are two cells and more.
    const distributed_binomial<mica::quantile_binomial<8>> count;
    const double deviation = std::sqrt(50 * 0.1 * 0.9);
    for (const float ratio : {1.F, 4.F, 16.F})
        for (const float distance : {10.F, 20.F})
            for (const float angle : {0.F, 1.F, 2.F}) {
                const auto m = derivatives_of<float>(ratio, 0.3F, 0.5F);
                const auto footprint = mica::make_footprint(m);
                const float x = distance * std::cos(angle), y = distance * std::sin(angle);
                statistics::running_covariance covariance;
                constexpr int pixels = 20000;
                for (std::uint32_t i = 0; i < pixels; ++i) {
                    uniform_stream<float> place(13, i);
                    const uv_point<float> uv{place(), place()};
                    const uv_point<float> apart{uv.u + x * m.du_dx + y * m.du_dy, uv.v + x * m.dv_dx + y * m.dv_dy};
                    covariance.add(
                        (static_cast<double>(count(mica::make_grid_vertices(footprint, uv, 50, i), 0.1F)) - 5) /
                            deviation,
                        (static_cast<double>(count(mica::make_grid_vertices(footprint, apart, 50, i), 0.1F)) - 5) /
                            deviation);
                }
                EXPECT_LE(std::abs(covariance.covariance()) * std::sqrt(1. * pixels), 3)
                    << ratio << ' ' << distance << ' ' << angle;
            }
}

/// In place, length a power of two.
void fourier_transform(std::vector<std::complex<double>>& x) {
    const std::size_t n = x.size();
    for (std::size_t i = 1, j = 0; i < n; ++i) {
        std::size_t bit = n >> 1;
        for (; j & bit; bit >>= 1) j ^= bit;
        j ^= bit;
        if (i < j) std::swap(x[i], x[j]);
    }
    for (std::size_t length = 2; length <= n; length *= 2)
        for (std::size_t i = 0; i < n; i += length)
            for (std::size_t k = 0; k < length / 2; ++k) {
                const auto w =
                    std::polar(1., -2 * 3.14159265358979323846 * static_cast<double>(k) / static_cast<double>(length));
                const auto a = x[i + k], b = x[i + k + length / 2] * w;
                x[i + k] = a + b;
                x[i + k + length / 2] = a - b;
            }
}

/// The variates of 512 x 512 seeds are white noise: every coefficient of their spectrum is as large as any other, their
/// squares exponentially distributed.
template <class Seed>
void expect_flat_spectrum(const Seed& seed) {
    constexpr std::size_t n = 512;
    std::vector<std::complex<double>> rows(n * n);
    for (std::size_t j = 0; j < n; ++j) {
        std::vector<std::complex<double>> row(n);
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint32_t bits = mica::mix(mica::hash(7U) ^ seed(static_cast<int>(i), static_cast<int>(j)));
            row[i] = static_cast<double>(mica::normal_pair_from_bits<float>(bits).first);
        }
        fourier_transform(row);
        for (std::size_t i = 0; i < n; ++i) rows[i * n + j] = row[i];
    }
    // |c|^2 / n^2 is exponential with mean 1, so 1 - exp(-x) is uniform. One half: the other has the conjugates.
    constexpr int cells = 64;
    statistics::histogram observed(0, 1, cells, cells - 1);
    double largest = 0;
    for (std::size_t i = 1; i < n / 2; ++i) {
        std::vector<std::complex<double>> column(rows.begin() + static_cast<std::ptrdiff_t>(i * n),
                                                 rows.begin() + static_cast<std::ptrdiff_t>((i + 1) * n));
        fourier_transform(column);
        for (const auto& c : column) {
            const double power = std::norm(c) / static_cast<double>(n * n);
            observed.add(std::floor(cells * -std::expm1(-power)));
            largest = std::max(largest, power);
        }
    }
    const std::vector<double> probabilities(cells, 1. / cells);
    EXPECT_TRUE(statistics::passes(statistics::goodness_of_fit(probabilities, observed.observed()).p_value));
    EXPECT_LE(largest, std::log(n * n / 2.) + 14); // one in a million spectra goes beyond
}

TEST(Blended, SpectrumOfSeedsIsFlat) {
    using Grid = mica::tetrahedron_vertex<float>;
    const std::uint32_t grid = mica::grid_seed(1U, Grid{-7, 2, 3, 1, 1});
    // Neighbouring cells; orientations by cells; levels and ratios by cells; cells of half vectors.
    expect_flat_spectrum([=](int i, int j) {
        return mica::cell_seed(grid, static_cast<std::uint32_t>(i - 256), static_cast<std::uint32_t>(j - 256));
    });
    expect_flat_spectrum([](int i, int j) {
        return mica::cell_seed(mica::grid_seed(1U, Grid{-7, 7, i, 1, 1}), static_cast<std::uint32_t>(j), 0U);
    });
    expect_flat_spectrum([](int i, int j) {
        return mica::cell_seed(mica::grid_seed(1U, Grid{i % 64 - 32, 1 + i / 64, 0, 1, 1}), 5U,
                               static_cast<std::uint32_t>(j));
    });
    expect_flat_spectrum([=](int i, int j) {
        std::array<mica::angular_vertex<float>, 4> cells;
        const half_vector_point<float> at{static_cast<float>(i) - 256.5F, static_cast<float>(j) - 256.5F};
        mica::find_enclosing_square(at, grid, cells);
        return cells[0].seed;
    });
}

// --- the screen ------------------------------------------------------------------------------------------------------

// A turned screen sees the same ellipse.
TEST(Blended, RotationOfTheScreenChangesNothing) {
    for (const auto& s : shapes) {
        const auto still = mica::make_footprint(derivatives_of<float>(s.ratio, s.turn, s.level));
        for (int i = 0; i <= 100; ++i) {
            const float turn = static_cast<float>(i) / 100;
            const auto turned = mica::make_footprint(derivatives_of<float>(s.ratio, s.turn, s.level, turn));
            // The derivatives are rounded: 1e-7 of the long axis, and of the short one `ratio` times as much.
            const float rounding = 5e-7F * (1 + s.ratio);
            EXPECT_NEAR(turned.sigma_max / still.sigma_max, 1, 1e-6F);
            EXPECT_NEAR(turned.sigma_min / still.sigma_min, 1, rounding);
            EXPECT_NEAR(turned.area / still.area, 1, rounding);
            const float apart = std::abs(turned.orientation - still.orientation);
            if (s.ratio > 1) {
                EXPECT_LE(std::min(apart, 1 - apart), 3e-6F);
            }
        }
    }
}

// --- the edges of the domain -----------------------------------------------------------------------------------------

template <class Derivatives>
bool resolved(const Derivatives& m, uv_point<float> uv) {
    return mica::make_grid_vertices(mica::make_footprint<float>(m), uv, 10, 1U).resolved;
}

TEST(Domain, EndsWhereItSays) {
    const float scale = mica::default_footprint_scale;
    // Ratio 2^16.
    EXPECT_TRUE(resolved(uv_derivatives<float>{6.5e-1F, 0, 0, 1e-5F}, {0, 0}));
    EXPECT_FALSE(resolved(uv_derivatives<float>{6.6e-1F, 0, 0, 1e-5F}, {0, 0}));
    // 2^18 cells from the origin.
    EXPECT_TRUE(resolved(uv_derivatives<float>{1e-3F, 0, 0, 1e-3F}, {0x1p18F * 1e-3F * scale * 0.999F, 0}));
    EXPECT_FALSE(resolved(uv_derivatives<float>{1e-3F, 0, 0, 1e-3F}, {0, -0x1p18F * 1e-3F * scale * 1.001F}));
    // Levels -40 and 40.
    const float smallest = 0x1p-40F / scale, largest = 0x1p40F / scale;
    EXPECT_TRUE(resolved(uv_derivatives<float>{smallest * 1.01F, 0, 0, smallest * 1.01F}, {0, 0}));
    EXPECT_FALSE(resolved(uv_derivatives<float>{smallest * 0.99F, 0, 0, smallest * 0.99F}, {0, 0}));
    EXPECT_TRUE(resolved(uv_derivatives<float>{largest * 0.99F, 0, 0, largest * 0.99F}, {0, 0}));
    EXPECT_FALSE(resolved(uv_derivatives<float>{largest * 1.01F, 0, 0, largest * 1.01F}, {0, 0}));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(resolved(uv_derivatives<float>{1, 0, 0, 1}, {nan, 0}));
    EXPECT_FALSE(resolved(uv_derivatives<float>{1, 0, 0, 1}, {0, nan}));
}

// At the edge the law still holds: the uniforms are uniform, for as long as places differ.
TEST(Domain, LawHoldsAtTheEdge) {
    const statistics::binomial_case c{20, 0.1};
    for (const bool at_ratio : {true, false}) {
        statistics::binomial_sample sample(c);
        for (std::uint32_t i = 0; i < 200000; ++i) {
            uniform_stream<float> place(17, i);
            const float turn = place(), u = place(), v = place();
            const auto footprint = mica::make_footprint(derivatives_of<float>(at_ratio ? 6e4F : 2, turn, place()));
            const float far = at_ratio ? 1.F : 0x1p17F * footprint.sigma_min * mica::default_footprint_scale;
            auto pixel = mica::make_grid_vertices(footprint, uv_point<float>{far * (1 + u), far * (1 - v)}, 20, i);
            ASSERT_TRUE(pixel.resolved);
            sample.add(static_cast<double>(distributed_binomial<exact_binomial>{}(pixel, 0.1F)));
        }
        EXPECT_TRUE(statistics::passes(sample.judge().p_value));
    }
}

// Against the same grids in double: to 1/6 of a cell at the edge, in proportion to the distance within.
TEST(Domain, PlacesAreRoundedAsStated) {
    for (const float distance : {0x1p12F, 0x1p15F, 0x1p18F}) {
        double worst = 0;
        for (std::uint32_t i = 0; i < 40000; ++i) {
            uniform_stream<float> xi(19, i);
            const auto footprint = mica::make_footprint(derivatives_of(std::exp2(16 * xi()), xi(), 8 * xi()));
            const float farthest = distance * footprint.sigma_min * mica::default_footprint_scale;
            const uv_point<float> uv{farthest * (2 * xi() - 1), i % 2 ? farthest : -farthest * xi()};
            for (const auto& grid : mica::enclosing_tetrahedron(footprint, mica::default_footprint_scale)) {
                const auto at = mica::grid_coordinates(uv, grid);
                const auto truth = mica::grid_coordinates(
                    uv_point<double>{static_cast<double>(uv.u), static_cast<double>(uv.v)},
                    mica::tetrahedron_vertex<double>{grid.level, grid.log2_ratio, grid.orientation, 1, 1});
                worst = std::max(worst,
                                 std::hypot(static_cast<double>(at.u) - truth.u, static_cast<double>(at.v) - truth.v));
            }
        }
        std::printf("2^%g cells away: placed to %.3g of a cell\n", std::log2(static_cast<double>(distance)), worst);
        EXPECT_LE(worst, static_cast<double>(distance) / 0x1p18 / 6);
    }
}

/// Resolved, or not for the sake of one of three reasons: ratio, place, half vector.
template <class Use>
void each_unresolved(float trials, const Use& use) {
    const auto footprint = mica::make_footprint<float>({1, 0, 0, 0.5F});
    const auto narrow = mica::make_footprint<float>({1, 0, 0, 1e-6F});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const uv_point<float> uv{0.3F, 0.4F};
    use(mica::make_grid_vertices(narrow, uv, trials, 1U));
    use(mica::make_grid_vertices(footprint, uv_point<float>{nan, 0}, trials, 1U));
    for (const auto& half_vector : {half_vector_point<float>{nan, 0}, {0, nan}, {3e5F, 0}, {0, -3e5F}, {-1e30F, 1e30F}})
        use(mica::make_grid_vertices(footprint, uv, half_vector, trials, 1U));
}

TEST(Domain, HalfVectorsEndWhereItSays) {
    const auto surface =
        mica::make_grid_vertices(mica::make_footprint<float>({1, 0, 0, 1}), uv_point<float>{0, 0}, 1, 1U);
    for (const float sign : {-1.F, 1.F}) {
        EXPECT_TRUE(mica::with_half_vector(surface, half_vector_point<float>{sign * 0x1p18F, 0}).resolved);
        EXPECT_TRUE(mica::with_half_vector(surface, half_vector_point<float>{0, sign * 0x1p18F}).resolved);
        EXPECT_FALSE(mica::with_half_vector(surface, half_vector_point<float>{sign * 0x1.00001p18F, 0}).resolved);
        EXPECT_FALSE(mica::with_half_vector(surface, half_vector_point<float>{0, sign * 0x1.00001p18F}).resolved);
    }
}

TEST(Domain, BeyondItTheCountIsTheMean) {
    each_unresolved(20, [](const auto& pixel) {
        EXPECT_FALSE(pixel.resolved);
        for (const auto& one : {pixel, mica::with_varied_density(pixel, 0.8F)}) {
            EXPECT_EQ(distributed_binomial<exact_binomial>{}(one, 0.25F), 5.F);
            EXPECT_EQ((distributed_binomial<exact_binomial, interpolated_counts>{}(one, 0.25F)), 5.F);
            EXPECT_EQ((distributed_binomial<mica::quantile_binomial<4>, softened_variates>{}(one, 0.25F)), 5.F);
            EXPECT_EQ((distributed_multinomial<2, exact_binomial>{}(one, std::array{0.25F, 0.5F})[1]), 10.F);
        }
    });
}

// What is no number of trials and no probability counts as the nearest that is one, resolved or not; NaN gives nothing.
TEST(Domain, TrialsAndProbabilitiesAreLimitedEverywhere) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    struct limited {
        float trials, probability, count;
    };
    for (const auto& c : {limited{-3, 0.5F, 0}, {20, 2, 20}, {20, -1, 0}, {nan, 0.5F, 0}, {20, nan, 0}}) {
        const auto expect = [&](const auto& pixel) {
            EXPECT_EQ(distributed_binomial<mica::quantile_binomial<4>>{}(pixel, c.probability), c.count);
            EXPECT_EQ((distributed_multinomial<1, exact_binomial>{}(pixel, std::array{c.probability})[0]), c.count);
        };
        expect(pixel_of<float>(shapes[3], c.trials, 1U));
        each_unresolved(c.trials, expect);
    }
}

TEST(Domain, DeviationsOfTheDensityAreLimited) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const auto pixel = pixel_of<float>(shapes[3], 100, i);
        EXPECT_EQ(mica::with_varied_density(pixel, -2).trials, 100.F);
        EXPECT_EQ(mica::with_varied_density(pixel, nan).trials, 100.F);
        EXPECT_EQ(mica::with_varied_density(pixel, 3).trials, mica::with_varied_density(pixel, 1).trials);
    }
}

// --- softness ---------------------------------------------------------------------------------------------------------

/// Mean and variance of the softened count, over the variate by the trapezoidal rule.
std::pair<double, double> softened_moments(float trials, float probability, float softness) {
    double weights = 0, first = 0, second = 0;
    for (int i = -8 * 64; i < 8 * 64; i += lanes) {
        number z;
        for (int k = 0; k < lanes; ++k) z.set(k, static_cast<float>(i + k) / 64);
        const auto counts =
            mica::quantile_binomial<4>::softened(number(trials), number(probability), z, number(softness));
        for (int k = 0; k < lanes; ++k) {
            const double x = static_cast<double>(z[k]), n = static_cast<double>(counts.successes[k]);
            const double weight = std::exp(-x * x / 2);
            weights += weight;
            first += weight * n;
            second += weight * n * n;
        }
    }
    const double mean = first / weights;
    return {mean, second / weights - mean * mean};
}

// Mean and the variance that is left, as softened_quantile.hpp states them.
TEST(Softened, MeanAndVariance) {
    struct stated {
        float softness;
        double mean;
        std::array<double, 3> whole; ///< least variance for whole N, r >= 0.75, 0.1, 0.01
        std::array<double, 2> real;  ///< for real N, r >= 0.75, 0.1
    };
    constexpr double from[] = {0.75, 0.1, 0.01};
    for (const auto& s : {stated{0.05F, 0.001, {0.96, 0.94, 0.92}, {0.69, 0.24}},
                          {0.1F, 0.001, {0.92, 0.88, 0.84}, {0.67, 0.22}},
                          {0.25F, 0.001, {0.81, 0.72, 0.62}, {0.62, 0.20}},
                          {0.5F, 0.001, {0.61, 0.45, 0.30}, {0.48, 0.12}},
                          {0.9F, 0.015, {0, 0, 0}, {0, 0}}}) {
        double worst = 0, most = 0;
        std::array<double, 3> whole{1, 1, 1}, real{1, 1, 1};
        for (const float trials : {0.1F, 0.5F, 0.9F, 1.F,  1.25F, 1.5F, 1.58F, 1.75F, 2.F,    2.5F, 3.F,
                                   4.F,  4.5F, 5.F,  5.5F, 6.F,   8.F,  20.5F, 50.F,  300.5F, 1e4F, 1e6F})
            for (const float probability :
                 {1e-8F, 1e-6F, 1e-4F, 0.002F, 0.01F, 0.02F, 0.05F,  0.1F,  0.2F,  0.3F,  0.4F,
                  0.5F,  0.55F, 0.6F,  0.7F,   0.8F,  0.9F,  0.935F, 0.95F, 0.99F, 0.999F}) {
                const double n = static_cast<double>(trials), p = static_cast<double>(probability);
                if (n * p < 1e-7) continue; // beyond the normal quantile in float
                const auto [mean, variance] = softened_moments(trials, probability, s.softness);
                const double f = n - std::floor(n), truth = n * p * (1 - p) + f * (1 - f) * p * p;
                worst = std::max(worst, std::abs(mean / (n * p) - 1));
                most = std::max(most, variance / truth);
                for (std::size_t k = 0; k < 3; ++k)
                    if (n * std::min(p, 1 - p) >= from[k] * (1 - 1e-6))
                        (f > 0 ? real : whole)[k] = std::min((f > 0 ? real : whole)[k], variance / truth);
            }
        std::printf(
            "softness %g: mean within %.2g; variance at least, r from 0.75, 0.1, 0.01: whole N %.3f %.3f %.3f, real "
            "N %.3f %.3f %.3f\n",
            static_cast<double>(s.softness), worst, whole[0], whole[1], whole[2], real[0], real[1], real[2]);
        EXPECT_LE(worst, s.mean) << s.softness;
        EXPECT_LE(most, 1.002);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_GE(whole[k], s.whole[k]) << s.softness << ' ' << k;
        for (std::size_t k = 0; k < 2; ++k) EXPECT_GE(real[k], s.real[k]) << s.softness << ' ' << k;
    }
}

TEST(Softened, NothingOrAllWhereThatIsCertain) {
    for (const float softness : {0.F, 0.05F, 0.1F, 0.5F, 0.9F, 1.F})
        for (const float trials : {0.F, 1.F, 1.5F, 4.F, 20.F, 1e6F})
            for (int i = -60; i <= 60; ++i) {
                const float z = 0.1F * static_cast<float>(i);
                const auto none = mica::quantile_binomial<4>::softened(trials, 0.F, z, softness);
                const auto all = mica::quantile_binomial<4>::softened(trials, 1.F, z, softness);
                ASSERT_TRUE(none.successes == 0 && none.failures == trials) << trials << ' ' << z << ' ' << softness;
                ASSERT_TRUE(all.failures == 0 && all.successes == trials) << trials << ' ' << z << ' ' << softness;
            }
}

// At p = 1/2 successes and failures change places.
TEST(Softened, HasNoSeam) {
    const float half = 0.5F, beside = std::nextafter(half, 1.F);
    for (const float softness : {0.05F, 0.3F, 0.9F})
        for (float trials = 1; trials < 2000; trials *= 1.13F)
            for (int i = -50; i <= 50; ++i) {
                const float z = 0.1F * static_cast<float>(i);
                const float one = mica::quantile_binomial<4>::softened(trials, half, z, softness).successes;
                const float other = mica::quantile_binomial<4>::softened(trials, beside, z, softness).successes;
                ASSERT_LE(std::abs(one - other), 1e-5F * trials) << trials << ' ' << z << ' ' << softness;
            }
}

// A class that no facet flashes towards stays dark, wherever it stands, and the others keep their means.
TEST(Softened, ClassesOfProbabilityZeroStayDark) {
    const distributed_multinomial<4, mica::quantile_binomial<4>, softened_variates> count{{0.1F}};
    for (std::size_t dark = 0; dark < 4; ++dark) {
        std::array<float, 4> p{0.4F, 0.3F, 0.2F, 0.1F};
        p[dark] = 0;
        std::array<number, 4> probabilities;
        for (std::size_t k = 0; k < 4; ++k) probabilities[k] = number(p[k]);
        std::array<statistics::running_moments, 4> sample;
        for (std::uint32_t i = 0; i < 20000; i += lanes) {
            const auto counts = count(pixel_of<number>(shapes[3], number(20), index_pack::iota(i)), probabilities);
            for (std::size_t k = 0; k < 4; ++k)
                for (int lane = 0; lane < lanes; ++lane) sample[k].add(static_cast<double>(counts[k][lane]));
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const double mean = 20 * static_cast<double>(p[k]);
            EXPECT_LE(std::abs(sample[k].mean() - mean), 4.5 * sample[k].standard_error() + 0.002 * mean) << dark << k;
        }
        EXPECT_EQ(sample[dark].variance(), 0.);
    }
}

// Softness 0 is the law itself: integers, of real N, too.
TEST(Softened, WithoutSoftnessIsTheLaw) {
    using law = mica::quantile_binomial<4>;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const auto pixel = pixel_of<float>(shapes[i % shapes.size()], 0.01F * static_cast<float>(i), i);
        EXPECT_EQ((distributed_binomial<law, softened_variates>{{0}}(pixel, 0.3F)),
                  distributed_binomial<law>{}(pixel, 0.3F));
    }
}

TEST(Softened, LittleSoftnessStaysNearTheLaw) {
    for (const float trials : {1.F, 8.F, 50.F, 1000.F})
        for (const float probability : {0.02F, 0.3F, 0.7F})
            for (int i = 1; i < 400; ++i) {
                const float u = static_cast<float>(i) / 400.5F;
                const float soft =
                    mica::quantile_binomial<8>::softened(trials, probability, -mica::normal_quantile(u), 1e-3F)
                        .successes;
                const float hard = mica::quantile_binomial<8>{}(trials, probability, [&] { return u; }).successes;
                // Between the gates a step of the law; beyond, real counts.
                EXPECT_LE(std::abs(soft - hard), 1.01F) << trials << ' ' << probability << ' ' << u;
            }
}

} // namespace
