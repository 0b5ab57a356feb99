// tests/checked_test.cpp: with MICA_CHECKED every bad argument of a law fails, naming the parameter and the value.
// Compiled with -DMICA_CHECKED=1.
#include <array>
#include <functional>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "mica/law/dual_gated.hpp"
#include "mica/law/exact.hpp"
#include "mica/law/multinomial.hpp"
#include "mica/numeric/pack.hpp"
#include "mica/random/uniform_stream.hpp"

#include "every_law.hpp"

static_assert(MICA_CHECKED == 1, "compile with -DMICA_CHECKED=1");

namespace {

/// The message of the std::invalid_argument that `act` throws; empty where it throws none.
std::string complaint(const std::function<void()>& act) {
    try {
        act();
    } catch (const std::invalid_argument& failure) {
        return failure.what();
    }
    return {};
}

bool names(const std::string& message, const std::string& parameter, const std::string& value) {
    return message.find(parameter) != std::string::npos && message.find(value) != std::string::npos;
}

template <class Law, class Real>
void expect_complaints() {
    using limits = std::numeric_limits<Real>;
    const Real nan = limits::quiet_NaN();
    const Real infinity = limits::infinity();
    const auto law = [](Real n, Real p) { return complaint([&] { Law{}(n, p, mica::uniform_stream<Real>{1U}); }); };
    EXPECT_TRUE(names(law(Real(-3.5), Real(0.5)), "trials", "-3.5")) << law(Real(-3.5), Real(0.5));
    EXPECT_TRUE(names(law(nan, Real(0.5)), "trials", "nan"));
    EXPECT_TRUE(names(law(infinity, Real(0.5)), "trials", "inf"));
    EXPECT_TRUE(names(law(-infinity, Real(0.5)), "trials", "-inf"));
    EXPECT_TRUE(names(law(Real(10), Real(-0.25)), "probability", "-0.25"));
    EXPECT_TRUE(names(law(Real(10), Real(1.5)), "probability", "1.5"));
    EXPECT_TRUE(names(law(Real(10), nan), "probability", "nan"));
    EXPECT_TRUE(names(law(Real(10), infinity), "probability", "inf"));

    EXPECT_EQ(law(Real(10), Real(0.5)), "");
    EXPECT_EQ(law(Real(0), Real(0)), "");
    EXPECT_EQ(law(limits::max(), Real(1)), "");
}

template <class Law>
class CheckedLaw : public testing::Test {};
TYPED_TEST_SUITE(CheckedLaw, every_law, by_law_name);

TYPED_TEST(CheckedLaw, NamesTheBadParameterAndItsValue) {
    expect_complaints<TypeParam, float>();
    expect_complaints<TypeParam, double>();
}

/// One bad lane is enough, whichever it is.
TEST(Checked, EveryLaneIsLookedAt) {
    using Pack = mica::pack<float, 4>;
    for (int lane = 0; lane < 4; ++lane) {
        Pack trials(10);
        trials.set(lane, -2);
        Pack probability(0.5F);
        probability.set(lane, 1.25F);
        const mica::uniform_stream<Pack> xi{mica::index_of<Pack>(1U), mica::index_of<Pack>::iota(0U)};
        const auto law = [&](Pack n, Pack p) {
            return complaint([&] { mica::dual_gated_binomial{}(n, p, mica::uniform_stream<Pack>(xi)); });
        };
        EXPECT_TRUE(names(law(trials, Pack(0.5F)), "trials", "-2")) << lane;
        EXPECT_TRUE(names(law(Pack(10), probability), "probability", "1.25")) << lane;
        EXPECT_EQ(law(Pack(10), Pack(0.5F)), "") << lane;
    }
}

template <class Law>
std::string complaint_of_multinomial(double trials, std::array<double, 3> probabilities) {
    return complaint([&] { mica::multinomial<3, Law>{}(trials, probabilities, mica::uniform_stream<double>{1U}); });
}

template <class Law>
std::string complaint_of_dynamic_multinomial(double trials, std::array<double, 3> probabilities) {
    return complaint([&] {
        std::array<double, 3> counts{};
        mica::multinomial<std::dynamic_extent, Law>{}(trials, std::span<const double>(probabilities),
                                                      mica::uniform_stream<double>{1U}, std::span<double>(counts));
    });
}

TEST(Checked, MultinomialsNameTheBadParameterAndItsValue) {
    using law = mica::exact_binomial;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto of : {complaint_of_multinomial<law>, complaint_of_dynamic_multinomial<law>}) {
        EXPECT_TRUE(names(of(-3.5, {0.25, 0.25, 0.5}), "trials", "-3.5"));
        EXPECT_TRUE(names(of(nan, {0.25, 0.25, 0.5}), "trials", "nan"));
        EXPECT_TRUE(names(of(10, {0.25, -0.25, 0.5}), "probability", "-0.25"));
        EXPECT_TRUE(names(of(10, {0.25, 0.25, nan}), "probability", "nan"));
        EXPECT_EQ(of(10, {0.25, 0.25, 0.5}), "");
    }
}

/// A sum a few ulp above 1 is a matter of rounding, not a mistake.
TEST(Checked, ProbabilitiesMaySumToALittleMoreThanOne) {
    using law = mica::exact_binomial;
    EXPECT_EQ(complaint_of_multinomial<law>(10, {0.5, 0.25, 0.25 + 0x1p-52}), "");
    EXPECT_EQ(complaint_of_dynamic_multinomial<law>(10, {0.5, 0.25, 0.25 + 0x1p-52}), "");
    EXPECT_EQ(complaint_of_multinomial<mica::dual_gated_binomial>(10, {0.5, 0.25, 0.25 + 0x1p-52}), "");
}

/// Nor is it beside a lane whose probabilities sum to less than 1, for which "none" has to be drawn.
TEST(Checked, LanesMayDifferInWhetherTheySumToOne) {
    using Pack = mica::pack<float, 4>;
    std::array<Pack, 2> probabilities{Pack(0.5F), Pack(0.5F)};
    probabilities[1].set(1, 0.25F);
    probabilities[1].set(2, 0.5F + 0x1p-22F);
    EXPECT_EQ(complaint([&] {
                  mica::multinomial<2, mica::dual_gated_binomial>{}(
                      Pack(10), probabilities, mica::uniform_stream<Pack>{mica::index_of<Pack>(1U)});
              }),
              "");
}

TEST(Checked, SpansOfDifferentLengthFail) {
    const std::array<double, 2> probabilities{0.5, 0.5};
    std::array<double, 3> counts{};
    EXPECT_NE(complaint([&] {
                  mica::multinomial<std::dynamic_extent, mica::exact_binomial>{}(
                      10., std::span<const double>(probabilities), mica::uniform_stream<double>{1U},
                      std::span<double>(counts));
              }),
              "");
}

} // namespace
