// tests/xsimd_test.cpp: the laws take any vector type that has the operations: one of xsimd's gives what floats give.
#include <array>
#include <cstdint>

#include <gtest/gtest.h>

#include <mica/random/uniform_stream.hpp>

#include "every_law.hpp"
#include "xsimd_number.hpp"

namespace {

using Batch = xsimd::batch<float>;
using Index = mica::index_of<Batch>;
constexpr std::size_t lanes = Batch::size;

template <class Law>
class XsimdBatch : public testing::Test {};
TYPED_TEST_SUITE(XsimdBatch, every_law, by_law_name);

TYPED_TEST(XsimdBatch, GivesWhatFloatsGive) {
    static_assert(mica::binomial_law<TypeParam, Batch>);
    mica::uniform_stream<float> choose{3U};
    for (std::uint32_t i = 0; i < 20'000; ++i) {
        std::array<float, lanes> trials, probabilities, successes, failures;
        std::array<std::uint32_t, lanes> indices;
        for (std::size_t k = 0; k < lanes; ++k) {
            trials[k] = mica::exp2(30 * choose() - 4);
            probabilities[k] = k % 2 ? choose() : mica::exp2(-20 * choose());
            indices[k] = i + static_cast<std::uint32_t>(k);
        }
        mica::uniform_stream<Batch> xi{Index(5U), Index::load_unaligned(indices.data())};
        const auto drawn =
            TypeParam{}(Batch::load_unaligned(trials.data()), Batch::load_unaligned(probabilities.data()), xi);
        drawn.successes.store_unaligned(successes.data());
        drawn.failures.store_unaligned(failures.data());
        for (std::size_t k = 0; k < lanes; ++k) {
            const auto expected = TypeParam{}(trials[k], probabilities[k], mica::uniform_stream<float>{5U, indices[k]});
            ASSERT_EQ(successes[k], expected.successes) << "N = " << trials[k] << ", p = " << probabilities[k];
            ASSERT_EQ(failures[k], expected.failures) << "N = " << trials[k] << ", p = " << probabilities[k];
        }
    }
}

} // namespace
