// tests/law_sweep_test.cpp: no law hangs, returns NaN or infinity, or leaves [0, ceil N], whatever bits it is given.
//
// Random bit patterns of N and p, half of them brought to sizes that occur, and uniforms with both extremes among them;
// all special values in all positions. Each law gets SWEEP_INPUTS random inputs, which the build sets, or as many as
// MICA_SWEEP_INPUTS says in the environment. Also compiled with -ffast-math, so everything is judged by its bits: there
// the compiler may assume that nothing is infinite or NaN.
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/multinomial.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/random/uniform_stream.hpp>

#include "every_law.hpp"

namespace {

using std::bit_cast;
using Pack = mica::pack<float, 8>;
using Index = mica::index_of<Pack>;

constexpr std::uint32_t infinity_bits = 0x7f800000U;
constexpr std::uint32_t largest_bits = infinity_bits - 1;
constexpr std::uint32_t sign_bit = 0x80000000U;

std::uint32_t random_inputs() {
    const char* const asked = std::getenv("MICA_SWEEP_INPUTS");
    return asked ? static_cast<std::uint32_t>(std::strtoul(asked, nullptr, 10)) : SWEEP_INPUTS;
}

bool is_nan_bits(std::uint32_t bits) { return (bits & ~sign_bit) > infinity_bits; }
bool is_negative(std::uint32_t bits) { return bits > sign_bit; } // not -0

/// The bits of ceil(N) for the bits of N: 0 below 0 and for NaN, the largest finite number for +infinity. Positive
/// floats have the order of their bits.
std::uint32_t most_counts(std::uint32_t trials) {
    if (is_nan_bits(trials) || (trials & sign_bit)) return 0;
    if (trials > largest_bits) return largest_bits;
    return bit_cast<std::uint32_t>(-mica::floor(-bit_cast<float>(trials)));
}

/// What is wrong with an outcome, or nullptr. -0 is a count of 0.
const char* complaint(std::uint32_t trials, std::uint32_t probability, std::uint32_t successes,
                      std::uint32_t failures) {
    const std::uint32_t most = is_nan_bits(probability) ? 0 : most_counts(trials);
    if (is_nan_bits(successes) || is_nan_bits(failures)) return "NaN";
    if (is_negative(successes) || is_negative(failures)) return "below 0";
    if ((successes & ~sign_bit) > most || (failures & ~sign_bit) > most) return "beyond ceil(N)";
    return nullptr;
}

/// Integers that sum to floor(N) or ceil(N), as far as floats count.
const char* complaint_of_integers(std::uint32_t trials, std::uint32_t probability, float successes, float failures) {
    constexpr std::uint32_t all_counted = bit_cast<std::uint32_t>(0x1p24F);
    if (is_nan_bits(probability) || most_counts(trials) == 0 || most_counts(trials) > all_counted) return nullptr;
    if (successes != mica::floor(successes) || failures != mica::floor(failures)) return "no integer";
    const float sum = successes + failures, n = bit_cast<float>(trials);
    return sum == mica::floor(n) || sum == bit_cast<float>(most_counts(trials)) ? nullptr : "not all trials";
}

/// The law's own statement holds for the published floored one only where N is an integer.
template <class Law>
constexpr bool counts_all_trials = Law::integer_counts;
template <class Gate>
constexpr bool counts_all_trials<mica::basic_floored_gated_binomial<Gate>> = false;

void expect_support(std::uint32_t trials, std::uint32_t probability, float successes, float failures, bool all_trials) {
    const char* wrong =
        complaint(trials, probability, bit_cast<std::uint32_t>(successes), bit_cast<std::uint32_t>(failures));
    if (!wrong && all_trials) wrong = complaint_of_integers(trials, probability, successes, failures);
    EXPECT_TRUE(wrong == nullptr) << wrong << ": N = 0x" << std::hex << trials << ", p = 0x" << probability
                                  << " gives 0x" << bit_cast<std::uint32_t>(successes) << ", 0x"
                                  << bit_cast<std::uint32_t>(failures);
}

/// Eight bit patterns, every second one of a size that occurs: 2^-30 to 2^66 trials, 2^-64 to 1 of probability.
Index patterns(Index random, std::uint32_t exponents, std::uint32_t lowest) {
    Index result = random;
    for (int i = 1; i < 8; i += 2)
        result.set(i, ((lowest + (random[i] >> 16) % exponents) << 23) | ((random[i] * 0x9e3779b1U) >> 9));
    return result;
}

/// Now and then one of the extremes of a stream.
template <class Stream>
struct with_extremes {
    Stream stream;

    Pack operator()() {
        const Index bits = stream.next_bits();
        Pack u = mica::uniform_from_bits<Pack>(bits);
        if (bits[0] % 64 == 0) u.set(1, bits[0] & 64U ? 0x1p-32F : 1 - 0x1p-24F);
        if (bits[0] % 64 == 1) u.set(2, bits[0] & 64U ? 0x1p-32F : 1 - 0x1p-24F);
        return u;
    }
};

template <class Law>
class LawSweep : public testing::Test {};
TYPED_TEST_SUITE(LawSweep, every_law, by_law_name);

TYPED_TEST(LawSweep, StaysInItsSupportOnAnyBits) {
    const std::uint32_t inputs = random_inputs();
    for (std::uint32_t i = 0; i < inputs && !testing::Test::HasFailure(); i += 8) {
        mica::uniform_stream<Pack> choose{Index(31U), Index::iota(i)};
        const Index trials = patterns(choose.next_bits(), 96, 97), probability = patterns(choose.next_bits(), 64, 63);
        const auto drawn = TypeParam{}(mica::reinterpret<Pack>(trials), mica::reinterpret<Pack>(probability),
                                       with_extremes<mica::uniform_stream<Pack>>{choose});
        for (int k = 0; k < 8; ++k)
            expect_support(trials[k], probability[k], drawn.successes[k], drawn.failures[k],
                           counts_all_trials<TypeParam>);
    }
}

/// Zeros, units, ends of the formats, both signs, infinities, quiet and signalling NaNs, the laws' own thresholds, and
/// the neighbours of each.
std::vector<std::uint32_t> special_values() {
    std::vector<std::uint32_t> result;
    for (const float x :
         {0.F, 0x1p-149F, 0x1p-126F, 1e-38F, 1e-16F,  0x1p-32F, 0x1p-24F, 0.25F,   0.5F,    1.F,   2.F,  3.F,
          4.F, 8.F,       10.F,      16.F,   0x1p23F, 0x1p24F,  0x1p31F,  0x1p32F, 0x1p63F, 1e16F, 1e30F})
        for (const std::uint32_t sign : {0U, sign_bit})
            for (const int step : {-1, 0, 1}) {
                const std::uint32_t bits = bit_cast<std::uint32_t>(x) | sign;
                if (step < 0 && (bits & ~sign_bit) == 0) continue;
                result.push_back(bits + static_cast<std::uint32_t>(step));
            }
    for (const std::uint32_t bits : {largest_bits, infinity_bits, infinity_bits + 1, 0x7fc00000U, 0x7fffffffU}) {
        result.push_back(bits);
        result.push_back(bits | sign_bit);
    }
    return result;
}

TYPED_TEST(LawSweep, StaysInItsSupportAtSpecialValues) {
    constexpr float uniforms[] = {0x1p-32F, 0x1p-31F, 0x1p-24F, 0.25F, 0.5F, 0.75F, 1 - 0x1p-23F, 1 - 0x1p-24F};
    const auto values = special_values();
    for (const std::uint32_t trials : values)
        for (const std::uint32_t probability : values)
            for (const float first : uniforms)
                for (const float second : uniforms) {
                    bool odd = false;
                    const auto xi = [&] { return (odd = !odd) ? first : second; };
                    const auto drawn = TypeParam{}(bit_cast<float>(trials), bit_cast<float>(probability), xi);
                    expect_support(trials, probability, drawn.successes, drawn.failures, counts_all_trials<TypeParam>);
                    if (testing::Test::HasFailure()) return;
                }
}

void expect_category_support(std::uint32_t trials, const std::array<float, 4>& counts, bool all_trials) {
    float sum = 0;
    for (const float count : counts) {
        const char* const wrong = complaint(trials, 0, bit_cast<std::uint32_t>(count), 0);
        EXPECT_TRUE(wrong == nullptr) << wrong << ": 0x" << std::hex << bit_cast<std::uint32_t>(count) << " of 0x"
                                      << trials;
        sum += count;
    }
    if (!all_trials || most_counts(trials) > bit_cast<std::uint32_t>(0x1p24F)) return;
    EXPECT_TRUE(sum <= bit_cast<float>(most_counts(trials))) << sum << " of 0x" << std::hex << trials;
}

/// Four categories, whatever their probabilities: none negative or infinite, and no more than all trials for integer
/// laws whose trials floats count.
TYPED_TEST(LawSweep, MultinomialsStayInTheirSupport) {
    const std::uint32_t inputs = random_inputs() / 8;
    for (std::uint32_t i = 0; i < inputs && !testing::Test::HasFailure(); i += 8) {
        mica::uniform_stream<Pack> choose{Index(32U), Index::iota(i)};
        const Index trials = patterns(choose.next_bits(), 96, 97);
        std::array<Pack, 4> probabilities;
        for (Pack& probability : probabilities)
            probability = mica::reinterpret<Pack>(patterns(choose.next_bits(), 64, 63));
        const auto counts = mica::multinomial<4, TypeParam>{}(mica::reinterpret<Pack>(trials), probabilities, choose);
        for (int k = 0; k < 8; ++k) {
            expect_category_support(trials[k], {counts[0][k], counts[1][k], counts[2][k], counts[3][k]},
                                    counts_all_trials<TypeParam>);
        }
    }
}

} // namespace
