// tests/random_test.cpp: the hashes, the uniforms and the counter-based streams: range, distinct counters,
// equidistribution, independence of neighbours, and known answers.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mica/numeric/pack.hpp"
#include "mica/random/uniform_stream.hpp"

#include "statistics.hpp"

namespace {

using mica::uniform_stream;

constexpr std::uint32_t all_ones = 0xffffffffU;
constexpr std::uint32_t seeds[] = {0U, 1U, 0x9e3779b9U, 20240607U};

// uniform_from_bits

TEST(UniformFromBits, FloatStaysInsideTheOpenInterval) {
    EXPECT_EQ(mica::uniform_from_bits<float>(0U), 0x1p-32F);
    EXPECT_EQ(mica::uniform_from_bits<float>(1U), 0x1p-32F);
    EXPECT_EQ(mica::uniform_from_bits<float>(2U), 0x3p-32F);
    EXPECT_EQ(mica::uniform_from_bits<float>(0x80000000U), 0.5F);
    EXPECT_EQ(mica::uniform_from_bits<float>(all_ones), 1 - 0x1p-24F);
}

TEST(UniformFromBits, DoubleStaysInsideTheOpenInterval) {
    EXPECT_EQ(mica::uniform_from_bits<double>(0U, 0U), 0x1p-53);
    EXPECT_EQ(mica::uniform_from_bits<double>(0U, 4095U), 0x1p-53);
    EXPECT_EQ(mica::uniform_from_bits<double>(0U, 4096U), 0x3p-53);
    EXPECT_EQ(mica::uniform_from_bits<double>(0x80000000U, 0U), 0.5 + 0x1p-53);
    EXPECT_EQ(mica::uniform_from_bits<double>(all_ones, all_ones), 1 - 0x1p-53);
}

TEST(UniformFromBits, FloatNeverDecreasesInTheBits) {
    float before = 0;
    for (std::uint64_t bits = 0; bits <= all_ones; bits += 1009) {
        const float u = mica::uniform_from_bits<float>(static_cast<std::uint32_t>(bits));
        EXPECT_TRUE(u >= before && u > 0 && u < 1) << bits;
        before = u;
    }
}

// distinct counters

/// The draws of consecutive indices use the sums index + (k+1) G. They are all different exactly while no two of d
/// multiples of G are nearer to each other, on the circle of 2^32, than the n indices are many. The nearest two of
/// d multiples are d-1 places apart at most, so it is enough to follow the smallest distance of j G from 0.
///
/// n d <= 2^32 / 2.24 holds up to 4096 draws. Beyond, the golden ratio cut to 32 bits is no longer golden: 28 657
/// draws keep 2^32 / 2.85, 75 025 draws 2^32 / 4.9, and the worst, 732 539 draws, 2^32 / 26.
TEST(UniformStream, CountersAreDistinctAsFarAsStated) {
    constexpr std::uint32_t most_draws = 1U << 28;
    std::uint32_t nearest = all_ones;
    std::uint32_t multiple = 0;
    for (std::uint32_t j = 1; j < most_draws; ++j) {
        multiple += mica::golden_increment;
        const std::uint32_t distance = (std::min)(multiple, 0U - multiple);
        if (distance >= nearest) continue;
        nearest = distance;
        // j + 1 draws are the fewest that hold this pair; n <= nearest indices stay distinct.
        const double stated = j < 4096 ? 0x1p32 / 2.24 : 0x1p32 / 26;
        EXPECT_TRUE(static_cast<double>(nearest) * (j + 1.) >= stated) << j + 1 << " draws, distance " << nearest;
    }
}

/// The two rounds of mixing and the seed between them are bijections, so distinct counters mean distinct bits.
TEST(UniformStream, NoTwoDrawsOfNeighbouringStreamsAreEqual) {
    constexpr std::uint32_t indices = 1U << 16;
    constexpr int draws = 64;
    std::vector<std::uint32_t> bits;
    bits.reserve(static_cast<std::size_t>(indices) * draws);
    for (std::uint32_t index = 0; index < indices; ++index) {
        uniform_stream<float> xi{7U, index};
        for (int k = 0; k < draws; ++k) bits.push_back(xi.next_bits());
    }
    std::sort(bits.begin(), bits.end());
    EXPECT_EQ(std::adjacent_find(bits.begin(), bits.end()), bits.end());
}

// equidistribution

constexpr std::size_t uniform_cells = 512;
constexpr int equidistribution_draws = 1 << 20;

/// p-value of the hypothesis that draw(0), draw(1), ... are uniform.
template <class Draw>
double uniformity(Draw draw) {
    const std::vector<double> probabilities(uniform_cells, 1. / uniform_cells);
    std::vector<double> observed(uniform_cells, 0.);
    for (int i = 0; i < equidistribution_draws; ++i) {
        const double u = static_cast<double>(draw(static_cast<std::uint32_t>(i)));
        observed[static_cast<std::size_t>(u * uniform_cells)] += 1;
    }
    return statistics::goodness_of_fit(probabilities, observed).p_value;
}

/// The chance of missing a density that goes from 1 - tilt at 0 to 1 + tilt at 1.
double chance_of_missing_a_tilt(double tilt) {
    const std::vector<double> stated(uniform_cells, 1. / uniform_cells);
    std::vector<double> tilted(uniform_cells);
    for (std::size_t i = 0; i < uniform_cells; ++i) {
        const double u = (static_cast<double>(i) + 0.5) / uniform_cells;
        tilted[i] = (1 + tilt * (2 * u - 1)) / uniform_cells;
    }
    return statistics::chance_of_missing(stated, tilted, equidistribution_draws);
}

TEST(Equidistribution, DesignSeesATiltOfFourPercent) { EXPECT_TRUE(chance_of_missing_a_tilt(0.04) <= 1e-3); }

template <class Real>
void expect_equidistributed() {
    for (const std::uint32_t seed : seeds) {
        EXPECT_TRUE(statistics::passes(uniformity([&](std::uint32_t i) {
            return uniform_stream<Real>{seed, i}();
        }))) << "over indices, seed "
             << seed;
        EXPECT_TRUE(statistics::passes(uniformity([&](std::uint32_t i) {
            return uniform_stream<Real>{i, seed}();
        }))) << "over seeds, index "
             << seed;
        uniform_stream<Real> xi{seed};
        EXPECT_TRUE(statistics::passes(uniformity([&](std::uint32_t) { return xi(); }))) << "over draws, seed " << seed;
        EXPECT_TRUE(statistics::passes(uniformity([&](std::uint32_t i) { return xi.substream(i)(); })))
            << "over substreams, seed " << seed;
        EXPECT_TRUE(statistics::passes(uniformity([&](std::uint32_t) { return xi.fork()(); })))
            << "over forks, seed " << seed;
    }
}

TEST(Equidistribution, Float) { expect_equidistributed<float>(); }
TEST(Equidistribution, Double) { expect_equidistributed<double>(); }

/// The low bits of a draw, which the cells above do not see.
TEST(Equidistribution, LowBits) {
    for (const std::uint32_t seed : seeds) {
        EXPECT_TRUE(statistics::passes(uniformity([&](std::uint32_t i) {
            return static_cast<double>(uniform_stream<float>{seed, i}.next_bits() % uniform_cells) / uniform_cells;
        }))) << seed;
    }
}

// independence

constexpr int correlation_draws = 1 << 18;

/// p-value of the correlation of two(i).first and .second, both uniform in (0,1) with variance 1/12. Seen for sure: a
/// correlation of 0.02, since its standard error is 2^-9.
template <class Two>
double independence(Two two) {
    double product = 0;
    for (int i = 0; i < correlation_draws; ++i) {
        const auto [a, b] = two(static_cast<std::uint32_t>(i));
        product += (static_cast<double>(a) - 0.5) * (static_cast<double>(b) - 0.5);
    }
    return statistics::normal_p_value(12 * product / std::sqrt(static_cast<double>(correlation_draws)));
}

TEST(Independence, DesignSeesACorrelationOfTwoPercent) {
    const double effect = 0.02 * std::sqrt(static_cast<double>(correlation_draws));
    const double critical = -statistics::normal_quantile(statistics::significance() / 2);
    EXPECT_TRUE(statistics::normal_cdf(critical - effect) <= 1e-3);
}

template <class Real>
struct pair_of {
    Real first;
    Real second;
};

template <class Real>
void expect_independent_neighbours() {
    using stream = uniform_stream<Real>;
    for (const std::uint32_t seed : seeds) {
        for (const std::uint32_t lag : {1U, 2U, 3U, 4U, 256U, 1024U, 65536U}) {
            EXPECT_TRUE(statistics::passes(independence([&](std::uint32_t i) {
                return pair_of<Real>{stream{seed, i}(), stream{seed, i + lag}()};
            }))) << "indices "
                 << lag << " apart, seed " << seed;
            EXPECT_TRUE(statistics::passes(independence([&](std::uint32_t i) {
                return pair_of<Real>{stream{i, seed}(), stream{i + lag, seed}()};
            }))) << "seeds "
                 << lag << " apart, index " << seed;
        }
        EXPECT_TRUE(statistics::passes(independence([&](std::uint32_t i) {
            stream xi{seed, i};
            const Real first = xi();
            return pair_of<Real>{first, xi()};
        }))) << "the first two draws, seed "
             << seed;
        stream xi{seed};
        Real before = xi();
        EXPECT_TRUE(statistics::passes(independence([&](std::uint32_t) {
            const pair_of<Real> result{before, xi()};
            before = result.second;
            return result;
        }))) << "consecutive draws, seed "
             << seed;
        EXPECT_TRUE(statistics::passes(independence([&](std::uint32_t i) {
            stream parent{seed, i};
            stream child = parent.fork();
            return pair_of<Real>{parent(), child()};
        }))) << "a fork and its parent, seed "
             << seed;
        EXPECT_TRUE(statistics::passes(independence([&](std::uint32_t i) {
            const stream parent{seed, i};
            return pair_of<Real>{parent.substream(1U)(), parent.substream(2U)()};
        }))) << "two substreams, seed "
             << seed;
    }
}

TEST(Independence, FloatNeighbours) { expect_independent_neighbours<float>(); }
TEST(Independence, DoubleNeighbours) { expect_independent_neighbours<double>(); }

/// Streams whose index is their seed, or next to it: what a loop over i draws with {i, i}.
TEST(Equidistribution, OfStreamsWhoseIndexIsTheirSeed) {
    constexpr std::size_t bins = 256;
    const std::vector<double> probabilities(bins, 1. / bins);
    for (const std::uint32_t apart : {0U, 1U, ~0U, mica::golden_increment, 0U - mica::golden_increment})
        for (const std::uint32_t draw : {0U, 1U}) {
            std::vector<double> observed(bins, 0.);
            for (std::uint32_t seed = 0; seed < correlation_draws; ++seed) {
                uniform_stream<float> xi{seed, seed + apart};
                for (std::uint32_t k = 0; k < draw; ++k) xi();
                observed[static_cast<std::size_t>(xi() * bins)] += 1;
            }
            EXPECT_TRUE(statistics::passes(statistics::goodness_of_fit(probabilities, observed).p_value)) << apart;
        }
}

/// Pairs on a 16 x 16 grid of the unit square: dependence that leaves the correlation at 0.
TEST(Independence, PairsOfIndicesFillTheSquare) {
    constexpr std::size_t side = 16;
    const std::vector<double> probabilities(side * side, 1. / (side * side));
    for (const std::uint32_t seed : seeds) {
        std::vector<double> observed(side * side, 0.);
        for (std::uint32_t i = 0; i < correlation_draws; ++i) {
            const auto x = static_cast<std::size_t>(uniform_stream<float>{seed, 2 * i}() * side);
            const auto y = static_cast<std::size_t>(uniform_stream<float>{seed, 2 * i + 1}() * side);
            observed[x * side + y] += 1;
        }
        EXPECT_TRUE(statistics::passes(statistics::goodness_of_fit(probabilities, observed).p_value)) << seed;
    }
}

/// Every input bit changes every output bit with probability near 1/2. Over 2^16 inputs the standard error of a
/// probability is 0.002; "near" are 0.05 of it, the size of bias that a weaker mix shows.
TEST(Mix, EveryInputBitChangesEveryOutputBit) {
    constexpr std::uint32_t inputs = 1U << 16;
    for (int in = 0; in < 32; ++in) {
        std::array<int, 32> changes{};
        for (std::uint32_t i = 0; i < inputs; ++i) {
            const std::uint32_t x = i * mica::golden_increment;
            const std::uint32_t difference = mica::mix(x) ^ mica::mix(x ^ (1U << in));
            for (int out = 0; out < 32; ++out) changes[static_cast<std::size_t>(out)] += (difference >> out) & 1U;
        }
        for (int out = 0; out < 32; ++out) {
            const double share = changes[static_cast<std::size_t>(out)] / static_cast<double>(inputs);
            EXPECT_TRUE(std::abs(share - 0.5) <= 0.05) << "bit " << in << " on bit " << out << ": " << share;
        }
    }
}

TEST(Hash, DependsOnTheOrderOfItsArguments) {
    EXPECT_NE(mica::hash(1U, 2U), mica::hash(2U, 1U));
    EXPECT_NE(mica::hash(1U, 2U, 3U), mica::hash(1U, 3U, 2U));
    EXPECT_NE(mica::hash(1U), mica::hash(1U, 0U));
    EXPECT_NE(mica::hash(0U), 0U);
}

// fork, substream, lanes

template <class Real>
std::array<Real, 16> next_draws(uniform_stream<Real> xi) {
    std::array<Real, 16> draws{};
    for (Real& draw : draws) draw = xi();
    return draws;
}

/// Draws that two streams have in common.
template <class Real>
int common_draws(uniform_stream<Real> a, uniform_stream<Real> b) {
    const auto of_a = next_draws(a);
    const auto of_b = next_draws(b);
    return static_cast<int>(std::count_if(
        of_a.begin(), of_a.end(), [&](Real draw) { return std::find(of_b.begin(), of_b.end(), draw) != of_b.end(); }));
}

/// A fork costs 32 random bits of its parent: one draw of a float stream, half a draw of a double stream.
template <class Real>
void expect_fork_costs_32_bits() {
    uniform_stream<Real> parent{3U, 5U};
    uniform_stream<Real> moved{3U, 5U};
    const uniform_stream<Real> child = parent.fork();
    moved.next_bits();
    EXPECT_EQ(next_draws(parent), next_draws(moved));
    EXPECT_EQ(common_draws(parent, child), 0);
    EXPECT_EQ(common_draws(parent.fork(), child), 0);
}

TEST(UniformStream, ForkIsIndependentAndCosts32Bits) {
    expect_fork_costs_32_bits<float>();
    expect_fork_costs_32_bits<double>();
}

TEST(UniformStream, ForkOfAFloatStreamCostsOneDraw) {
    uniform_stream<float> parent{3U, 5U};
    uniform_stream<float> moved{3U, 5U};
    parent.fork();
    moved();
    EXPECT_EQ(next_draws(parent), next_draws(moved));
}

template <class Real>
void expect_substream_costs_nothing() {
    const uniform_stream<Real> parent{3U, 5U};
    EXPECT_EQ(common_draws(parent, parent.substream(0U)), 0);
    EXPECT_EQ(common_draws(parent, parent.substream(1U)), 0);
    EXPECT_EQ(common_draws(parent.substream(0U), parent.substream(1U)), 0);
    EXPECT_EQ(next_draws(parent), next_draws(uniform_stream<Real>{3U, 5U}));
    EXPECT_EQ(next_draws(parent.substream(1U)), next_draws(parent.substream(1U)));
}

TEST(UniformStream, SubstreamIsIndependentAndCostsNothing) {
    expect_substream_costs_nothing<float>();
    expect_substream_costs_nothing<double>();
}

TEST(UniformStream, StartsAtIndexZero) {
    EXPECT_EQ(next_draws(uniform_stream<float>{9U}), next_draws(uniform_stream<float>{9U, 0U}));
    EXPECT_EQ(common_draws(uniform_stream<float>{9U, 0U}, uniform_stream<float>{9U, 1U}), 0);
    EXPECT_EQ(common_draws(uniform_stream<float>{9U, 1U}, uniform_stream<float>{10U, 1U}), 0);
}

template <class Pack>
void expect_lanes_equal_scalar_streams() {
    using Real = typename Pack::value_type;
    using Index = mica::index_of<Pack>;
    constexpr std::uint32_t first = 0xfffffffdU; // the indices wrap round
    uniform_stream<Pack> packed{Index(11U), Index::iota(first)};
    for (int k = 0; k < 4; ++k) {
        const auto family = packed.substream(static_cast<std::uint32_t>(k));
        auto fork = packed.fork();
        const Pack of_fork = fork();
        const Pack drawn = packed();
        for (int i = 0; i < mica::lanes_of<Pack>; ++i) {
            uniform_stream<Real> scalar{11U, first + static_cast<std::uint32_t>(i)};
            for (int before = 0; before < k; ++before) {
                scalar.fork();
                scalar();
            }
            EXPECT_EQ(next_draws(family.lane(i)), next_draws(scalar.substream(static_cast<std::uint32_t>(k))));
            auto scalar_fork = scalar.fork();
            EXPECT_EQ(of_fork[i], scalar_fork());
            EXPECT_EQ(drawn[i], scalar());
            EXPECT_EQ(next_draws(packed.lane(i)), next_draws(scalar));
        }
    }
}

TEST(UniformStream, LanesEqualScalarStreams) {
    expect_lanes_equal_scalar_streams<mica::pack<float, 4>>();
    expect_lanes_equal_scalar_streams<mica::pack<float, 8>>();
    expect_lanes_equal_scalar_streams<mica::pack<double, 4>>();
}

// known answers

/// The answer of one line of tests/data/known_answers.txt by this library; `words` are its inputs.
std::uint64_t answer(const std::string& name, const std::vector<std::uint32_t>& words) {
    const auto at = [&](std::size_t i) { return words.at(i); };
    if (name == "mix") return mica::mix(at(0));
    if (name == "hash") {
        if (words.size() == 1) return mica::hash(at(0));
        if (words.size() == 2) return mica::hash(at(0), at(1));
        if (words.size() == 3) return mica::hash(at(0), at(1), at(2));
        return mica::hash(at(0), at(1), at(2), at(3));
    }
    if (name == "uniform_float") return std::bit_cast<std::uint32_t>(mica::uniform_from_bits<float>(at(0)));
    if (name == "uniform_double") return std::bit_cast<std::uint64_t>(mica::uniform_from_bits<double>(at(0), at(1)));
    uniform_stream<float> stream{at(0), at(1)};
    if (name == "fork") return stream.fork().next_bits();
    if (name == "substream") return stream.substream(at(2)).next_bits();
    EXPECT_EQ(name, "stream");
    for (std::uint32_t draw = 0; draw < at(2); ++draw) stream.next_bits();
    return stream.next_bits();
}

/// Computed by tests/data/make_known_answers without this code. A change here changes every picture: say so in the
/// changelog.
TEST(KnownAnswers, AreThoseOfTheFile) {
    std::ifstream file(MICA_TEST_DATA "/known_answers.txt");
    ASSERT_TRUE(file.is_open());
    int answers = 0;
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line.front() == '#') continue;
        std::istringstream fields(line);
        std::string name;
        fields >> name >> std::hex;
        std::vector<std::uint64_t> numbers;
        for (std::uint64_t number; fields >> number;) numbers.push_back(number);
        ASSERT_TRUE(numbers.size() >= 2) << line;
        const std::vector<std::uint32_t> inputs(numbers.begin(), numbers.end() - 1);
        EXPECT_EQ(answer(name, inputs), numbers.back()) << line;
        ++answers;
    }
    EXPECT_EQ(answers, 110);
}

} // namespace
