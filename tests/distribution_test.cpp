// tests/distribution_test.cpp: the std-style distributions and the uniforms that they draw from a generator.
#include <array>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <limits>
#include <numeric>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <mica/law/binomial_distribution.hpp>
#include <mica/law/multinomial_distribution.hpp>
#include <mica/law/quantile.hpp>

#include "binomial_fit.hpp"

namespace {

using mica::binomial_distribution;
using mica::multinomial_distribution;
using multinomial = multinomial_distribution<>;

// the uniforms

/// A generator whose numbers are known.
template <class Integer, Integer Min, Integer Max>
struct scripted_generator {
    using result_type = Integer;
    static constexpr Integer(min)() { return Min; }
    static constexpr Integer(max)() { return Max; }
    Integer next;
    int calls = 0;
    Integer operator()() { return ++calls, next; }
};

TEST(GeneratorUniforms, TakeTheBitsOfFullGeneratorsAsTheyAre) {
    scripted_generator<std::uint32_t, 0, 0xffffffffU> narrow{0x80000000U};
    EXPECT_EQ((mica::generator_uniforms<float, decltype(narrow)>(narrow)()), 0.5F);
    EXPECT_EQ(narrow.calls, 1);
    EXPECT_EQ((mica::generator_uniforms<double, decltype(narrow)>(narrow)()), 0.5 + 0x1p-33 + 0x1p-53);
    EXPECT_EQ(narrow.calls, 3);
    scripted_generator<std::uint64_t, 0, 0xffffffffffffffffU> wide{0x8000000000000000U};
    EXPECT_EQ((mica::generator_uniforms<float, decltype(wide)>(wide)()), 0.5F);
    EXPECT_EQ((mica::generator_uniforms<double, decltype(wide)>(wide)()), 0.5 + 0x1p-53);
    EXPECT_EQ(wide.calls, 2);
}

TEST(GeneratorUniforms, StayOpenAtTheEndsOfTheGenerator) {
    for (const std::uint64_t bits : {std::uint64_t{0}, ~std::uint64_t{0}}) {
        scripted_generator<std::uint64_t, 0, 0xffffffffffffffffU> generator{bits};
        const float u = mica::generator_uniforms<float, decltype(generator)>(generator)();
        const double v = mica::generator_uniforms<double, decltype(generator)>(generator)();
        EXPECT_TRUE(u > 0 && u < 1 && v > 0 && v < 1) << bits;
    }
}

// the law, with generators of all kinds

constexpr int draws = 1 << 18;
constexpr double smallest_error = 0.04; // what so many draws are sure to see, root mean square of the probabilities

template <class Distribution, class Generator>
void expect_binomial(const statistics::binomial_case& c, Distribution distribution, Generator generator) {
    statistics::binomial_sample sample(c);
    EXPECT_TRUE(sample.chance_of_missing_an_error(smallest_error, draws) <= 1e-3) << c;
    for (int i = 0; i < draws; ++i) sample.add(static_cast<double>(distribution(generator)));
    EXPECT_TRUE(statistics::passes(sample.judge().p_value)) << c << ": " << sample.judge().p_value;
}

TEST(BinomialDistribution, FollowsTheBinomialFromAnyGenerator) {
    const binomial_distribution<> few(12, 0.3), many(1000, 0.7);
    expect_binomial({12, 0.3}, few, std::mt19937(1));
    expect_binomial({12, 0.3}, few, std::mt19937_64(2));
    expect_binomial({12, 0.3}, few, std::minstd_rand(3));
    expect_binomial({12, 0.3}, few, std::ranlux24(4));
    expect_binomial({1000, 0.7}, many, std::mt19937_64(5));
    expect_binomial({1000, 0.7}, many, std::knuth_b(6));
}

TEST(BinomialDistribution, TakesEveryIntegerType) {
    expect_binomial({200, 0.4}, binomial_distribution<short>(200, 0.4), std::mt19937_64(7));
    expect_binomial({200, 0.4}, binomial_distribution<std::uint8_t>(200, 0.4), std::mt19937_64(8));
    expect_binomial({1e12, 1e-11}, binomial_distribution<long long>(1'000'000'000'000, 1e-11), std::mt19937_64(9));
    std::mt19937_64 generator(10);
    const std::int64_t most = std::int64_t{1} << 53;
    EXPECT_EQ(binomial_distribution<std::int64_t>(most, 1)(generator), most);
    EXPECT_EQ(binomial_distribution<std::int64_t>(most, 0)(generator), 0);
    EXPECT_EQ(binomial_distribution<int>(0, 0.5)(generator), 0);
}

TEST(BinomialDistribution, TakesAnyLawOfIntegers) {
    using law = mica::quantile_binomial<16>; // exact up to 16 trials
    expect_binomial({16, 0.3}, binomial_distribution<int, law>(16, 0.3), std::mt19937_64(11));
}

TEST(MultinomialDistribution, EveryCategoryIsBinomialAndAllSumToTheTrials) {
    constexpr int t = 60;
    constexpr std::array<double, 4> p{0.1, 0.4, 0.2, 0.3};
    multinomial distribution(t, {p[0], p[1], p[2], p[3]});
    std::mt19937_64 generator(12);
    std::vector<statistics::binomial_sample> samples;
    for (const double probability : p) samples.emplace_back(statistics::binomial_case{t, probability});
    for (int i = 0; i < draws; ++i) {
        const auto counts = distribution(generator);
        ASSERT_EQ(std::accumulate(counts.begin(), counts.end(), 0), t);
        for (std::size_t k = 0; k < p.size(); ++k) samples[k].add(counts[k]);
    }
    for (const auto& sample : samples) {
        EXPECT_TRUE(sample.chance_of_missing_an_error(smallest_error, draws) <= 1e-3);
        EXPECT_TRUE(statistics::passes(sample.judge().p_value)) << sample.judge().p_value;
    }
}

TEST(MultinomialDistribution, LeavesTheRestToNoCategory) {
    multinomial distribution(60, {0.25, 0.125});
    std::mt19937_64 generator(13);
    statistics::binomial_sample some({60, 0.375});
    for (int i = 0; i < draws; ++i) {
        const auto counts = distribution(generator);
        some.add(counts[0] + counts[1]);
    }
    EXPECT_TRUE(statistics::passes(some.judge().p_value)) << some.judge().p_value;
}

TEST(MultinomialDistribution, GivesNothingToACategoryOfProbabilityZero) {
    multinomial distribution(1000, {0., 0.5, 0., 0.5, 0.});
    std::mt19937_64 generator(14);
    for (int i = 0; i < 1000; ++i) {
        const auto counts = distribution(generator);
        EXPECT_EQ(counts[0] + counts[2] + counts[4], 0);
        EXPECT_EQ(counts[1] + counts[3], 1000);
    }
}

/// Probabilities computed in float sum to a little more than 1 (numpy #8317), a quotient may (WireCell #26).
TEST(MultinomialDistribution, BearsASumSlightlyAboveOne) {
    std::mt19937_64 generator(15);
    for (const auto& p :
         {std::vector<double>{0.5, 0.25, 0.25 + 5e-9}, {static_cast<double>(0.1F), static_cast<double>(0.9F)}}) {
        multinomial distribution(1000, std::span<const double>(p));
        const auto counts = distribution(generator);
        EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0), 1000);
    }
}

// the requirements of the standard

/// Code written for any distribution of the standard library: [rand.req.dist].
template <class Distribution>
void use_as_the_standard_says(const Distribution& given) {
    using parameters = typename Distribution::param_type;
    using result = typename Distribution::result_type;
    static_assert(std::is_same_v<typename parameters::distribution_type, Distribution>);
    static_assert(std::regular<Distribution> && std::regular<parameters>);

    std::mt19937_64 generator(16), same_generator(16);
    Distribution distribution(given.param());
    EXPECT_TRUE(distribution == given && !(distribution != given));
    distribution.reset();
    const result drawn = distribution(generator);
    EXPECT_EQ(drawn, Distribution()(same_generator, given.param()));
    EXPECT_TRUE(distribution.min() <= drawn && drawn <= distribution.max());

    Distribution other;
    other.param(given.param());
    EXPECT_TRUE(other == distribution);

    std::stringstream text;
    text << std::hex << std::setprecision(3) << std::scientific << given;
    Distribution read;
    text >> read;
    EXPECT_TRUE(!text.fail()) << text.str();
    EXPECT_TRUE(read == given) << text.str();
    EXPECT_EQ(text.precision(), 3);
    EXPECT_TRUE((text.flags() & std::ios_base::basefield) == std::ios_base::hex);

    std::wstringstream wide;
    wide << given;
    Distribution read_from_wide;
    wide >> read_from_wide;
    EXPECT_TRUE(read_from_wide == given);
}

TEST(Distributions, MeetTheRequirementsOfTheStandard) {
    use_as_the_standard_says(std::binomial_distribution<>(12, 0.3)); // the test itself
    use_as_the_standard_says(binomial_distribution<>(12, 1. / 3));
    use_as_the_standard_says(binomial_distribution<>());
    use_as_the_standard_says(binomial_distribution<std::uint8_t>(65, 0.1)); // 'A', were it written as a character
    use_as_the_standard_says(binomial_distribution<long long>(1LL << 53, 0x1p-1074));
    use_as_the_standard_says(multinomial(7, {0.1, 1. / 3, 0.2}));
    use_as_the_standard_says(multinomial());
}

TEST(Distributions, HaveTheDefaultsOfTheStandard) {
    EXPECT_EQ(binomial_distribution<>().t(), std::binomial_distribution<>().t());
    EXPECT_EQ(binomial_distribution<>().p(), std::binomial_distribution<>().p());
    EXPECT_EQ(binomial_distribution<>(9).p(), std::binomial_distribution<>(9).p());
    EXPECT_EQ(multinomial().probabilities(), std::vector<double>{1});
}

TEST(Distributions, DrawTheSameFromTheSameGenerator) {
    std::mt19937 one(17), two(17);
    binomial_distribution<> first(100, 0.4), second(100, 0.4);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(first(one), second(two));
    EXPECT_TRUE(one == two);
}

template <class Distribution>
void expect_refused(const std::string& text) {
    Distribution distribution;
    std::istringstream in(text);
    in >> distribution;
    EXPECT_TRUE(in.fail()) << text;
    EXPECT_TRUE(distribution == Distribution()) << text;
}

TEST(Distributions, RefuseWhatIsNoParameters) {
    for (const char* const text : {"", "7", "x 0.5", "-1 0.5", "7 1.5", "7 -0.1", "99999999999 0.5", "7 nan"})
        expect_refused<binomial_distribution<>>(text);
    expect_refused<binomial_distribution<std::uint8_t>>("300 0.5");
    for (const char* const text :
         {"", "7 2 0.5", "7 2 0.5 x", "7 0", "-7 1 0.5", "7 2 0.9 0.9", "7 1 1.5", "7 99999999999999 0.1 0.1"})
        expect_refused<multinomial>(text);
}

/// The lines of the README.
TEST(Distributions, AreUsedAsTheReadmeSays) {
    std::mt19937_64 generator(2026);
    mica::binomial_distribution<long long> flashes(1'000'000'000'000, 3e-12);
    const long long n = flashes(generator);
    EXPECT_TRUE(n >= 0 && n <= 40) << n; // of a mean of 3
}

// bad parameters

template <class Make>
std::string complaint(Make make) {
    try {
        make();
    } catch (const std::invalid_argument& failure) {
        return failure.what();
    }
    return "none";
}

TEST(Distributions, NameTheBadParameterAndItsValue) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(complaint([] { binomial_distribution<>(-3, 0.5); }), "mica: t = -3 is not in [0, 2^53]");
    EXPECT_EQ(complaint([] { binomial_distribution<long long>(1LL << 54, 0.5); }),
              "mica: t = 1.80143985e+16 is not in [0, 2^53]");
    EXPECT_EQ(complaint([] { binomial_distribution<>(3, 1.5); }), "mica: p = 1.5 is not in [0,1]");
    EXPECT_EQ(complaint([] { binomial_distribution<>(3, -0.25); }), "mica: p = -0.25 is not in [0,1]");
    EXPECT_EQ(complaint([nan] { binomial_distribution<>(3, nan); }), "mica: p = nan is not in [0,1]");
    EXPECT_EQ(complaint([] { multinomial(-3, {0.5}); }), "mica: t = -3 is not in [0, 2^53]");
    EXPECT_EQ(complaint([] { multinomial(3, std::span<const double>()); }),
              "mica: the number of categories = 0 is not positive");
    EXPECT_EQ(complaint([] { multinomial(3, {0.5, 1.5}); }), "mica: a probability = 1.5 is not in [0,1]");
    EXPECT_EQ(complaint([] {
                  multinomial(3, {0.5, 0.75});
              }),
              "mica: the sum of the probabilities = 1.25 is not at most 1");
    EXPECT_EQ(complaint([] { binomial_distribution<>(3, 1); }), "none");
}

} // namespace
