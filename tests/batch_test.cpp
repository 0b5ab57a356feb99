// tests/batch_test.cpp: sample() gives, element for element, what the scalar law gives: whatever the number of lanes,
// the length, and the pieces in which it is asked.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/batch.hpp>

#include "every_law.hpp"

namespace {

using mica::uniform_stream;

constexpr std::uint32_t seed = 7;

/// Mixed parameters, real trials and both sides of p = 1/2 among them.
template <class Real>
struct parameters {
    std::vector<Real> trials, probabilities;

    explicit parameters(std::size_t size) : trials(size), probabilities(size) {
        uniform_stream<Real> choose{1U};
        for (std::size_t i = 0; i < size; ++i) {
            trials[i] = mica::exp2(Real(24) * choose() - Real(4));
            probabilities[i] = i % 3 == 0 ? Real(1) - choose() * choose() : mica::exp2(Real(-16) * choose());
        }
    }
};

template <class Real>
using draw = mica::counts<Real> (*)(Real trials, Real probability, std::uint32_t index);

template <class Law, class Real>
[[gnu::noinline]] mica::counts<Real> drawn(Real trials, Real probability, std::uint32_t index) {
    return Law{}(trials, probability, uniform_stream<Real>{seed, index});
}

template <class Real>
std::vector<Real> one_by_one(draw<Real> law, const parameters<Real>& of) {
    std::vector<Real> result;
    for (std::size_t i = 0; i < of.trials.size(); ++i)
        result.push_back(law(of.trials[i], of.probabilities[i], static_cast<std::uint32_t>(i)).successes);
    return result;
}

template <class Law>
class Batch : public testing::Test {};
TYPED_TEST_SUITE(Batch, every_law, by_law_name);

template <class Law, class Real>
void expect_what_the_scalar_law_gives() {
    for (const std::size_t size : {0U, 1U, 3U, 4U, 7U, 8U, 16U, 203U}) {
        const parameters<Real> of(size);
        std::vector<Real> successes(size);
        mica::sample(Law{}, of.trials, of.probabilities, seed, successes);
        EXPECT_EQ(successes, one_by_one(drawn<Law, Real>, of)) << size << " elements";
    }
}

TYPED_TEST(Batch, GivesWhatTheScalarLawGives) {
    expect_what_the_scalar_law_gives<TypeParam, float>();
    expect_what_the_scalar_law_gives<TypeParam, double>();
}

using law = mica::quantile_binomial<4>;

template <int Lanes, class Real>
void expect_same_with_lanes(const parameters<Real>& of, const std::vector<Real>& expected) {
    std::vector<Real> successes(expected.size());
    mica::sample<Lanes>(law{}, of.trials, of.probabilities, seed, successes);
    EXPECT_EQ(successes, expected) << Lanes << " lanes";
}

template <class Real>
void expect_same_with_any_lanes() {
    const parameters<Real> of(203);
    const auto expected = one_by_one(drawn<law, Real>, of);
    expect_same_with_lanes<1>(of, expected);
    expect_same_with_lanes<2>(of, expected);
    expect_same_with_lanes<4>(of, expected);
    expect_same_with_lanes<8>(of, expected);
    expect_same_with_lanes<16>(of, expected);
}

TEST(BatchOfAnyLaw, DoesNotDependOnTheNumberOfLanes) {
    expect_same_with_any_lanes<float>();
    expect_same_with_any_lanes<double>();
}

TEST(BatchOfAnyLaw, DoesNotDependOnThePieces) {
    const parameters<float> of(203);
    const auto expected = one_by_one(drawn<law, float>, of);
    for (const std::size_t piece : {1U, 5U, 8U, 100U, 202U}) {
        std::vector<float> successes(expected.size());
        for (std::size_t first = 0; first < expected.size(); first += piece) {
            const std::size_t size = std::min(piece, expected.size() - first);
            mica::sample(law{}, std::span(of.trials).subspan(first, size),
                         std::span(of.probabilities).subspan(first, size), seed,
                         std::span(successes).subspan(first, size), static_cast<std::uint32_t>(first));
        }
        EXPECT_EQ(successes, expected) << "pieces of " << piece;
    }
}

/// From the last index on the streams start again.
TEST(BatchOfAnyLaw, CountsStreamsModulo2To32) {
    std::vector<float> successes(11);
    mica::sample(law{}, 100.F, 0.25F, seed, successes, 0xfffffffbU);
    for (std::uint32_t i = 0; i < 11; ++i) EXPECT_EQ(successes[i], (drawn<law>(100.F, 0.25F, i - 5).successes)) << i;
}

TEST(BatchOfAnyLaw, TakesOneParameterForAll) {
    std::vector<float> floats(37);
    mica::sample(law{}, 12.5F, 0.75F, seed, floats);
    for (std::uint32_t i = 0; i < 37; ++i) EXPECT_EQ(floats[i], (drawn<law>(12.5F, 0.75F, i).successes)) << i;
    std::vector<double> doubles(37);
    mica::sample(law{}, 12.5, 0.75, seed, doubles);
    for (std::uint32_t i = 0; i < 37; ++i) EXPECT_EQ(doubles[i], (drawn<law>(12.5, 0.75, i).successes)) << i;
}

TEST(BatchOfAnyLaw, MayReplaceItsInput) {
    parameters<float> of(203);
    const auto expected = one_by_one(drawn<law, float>, of);
    mica::sample(law{}, of.trials, of.probabilities, seed, of.trials);
    EXPECT_EQ(of.trials, expected);
}

/// Nothing is read or written beyond the shortest span.
TEST(BatchOfAnyLaw, EndsWithTheShortestSpan) {
    const parameters<float> of(40);
    const auto expected = one_by_one(drawn<law, float>, of);
    for (const auto& [trials, probabilities, size] : {std::array{9U, 40U, 40U}, {40U, 9U, 40U}, {40U, 40U, 9U}}) {
        std::vector<float> successes(40, -1.F);
        mica::sample(law{}, std::span(of.trials).first(trials), std::span(of.probabilities).first(probabilities), seed,
                     std::span(successes).first(size));
        for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(successes[i], i < 9 ? expected[i] : -1.F) << i;
    }
}

template <class Real, class Law>
void expect_multinomials() {
    constexpr std::size_t size = 203, categories = 5;
    const parameters<Real> of(size);
    std::array<std::vector<Real>, categories> probabilities, counts;
    std::array<std::span<const Real>, categories> from;
    std::array<std::span<Real>, categories> to;
    for (std::size_t k = 0; k < categories; ++k) {
        for (std::size_t i = 0; i < size; ++i)
            probabilities[k].push_back(of.probabilities[(i + k) % size] / Real(categories));
        counts[k].resize(size);
        from[k] = probabilities[k];
        to[k] = counts[k];
    }
    constexpr mica::multinomial<categories, Law> multinomial;
    mica::sample(multinomial, of.trials, from, seed, to);
    for (std::size_t i = 0; i < size; ++i) {
        std::array<Real, categories> p;
        for (std::size_t k = 0; k < categories; ++k) p[k] = probabilities[k][i];
        const auto expected = multinomial(of.trials[i], p, uniform_stream<Real>{seed, static_cast<std::uint32_t>(i)});
        for (std::size_t k = 0; k < categories; ++k) EXPECT_EQ(counts[k][i], expected[k]) << i << ' ' << k;
    }
}

TEST(BatchOfMultinomials, GivesWhatTheScalarGives) {
    expect_multinomials<float, law>();
    expect_multinomials<double, law>();
    expect_multinomials<float, mica::dual_gated_binomial>();
    expect_multinomials<float, mica::exact_binomial>();
}

} // namespace
