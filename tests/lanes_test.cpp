// tests/lanes_test.cpp: every law gives in every lane of a pack, of whatever width, what it gives for a scalar.
//
// To the last bit. Compiled also for wider registers, where the target has them, with floating contraction off: with
// fused multiply-adds a uniform within a rounding of a step may fall to the other side of it.
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <mica/numeric/pack.hpp>
#include <mica/random/uniform_stream.hpp>

#include "every_law.hpp"

namespace {

using mica::uniform_stream;

template <class Law>
class Lanes : public testing::Test {};
TYPED_TEST_SUITE(Lanes, every_law, by_law_name);

/// Trials and probabilities of every size, good and bad.
template <class Real>
std::vector<Real> any_parameter() {
    using limits = std::numeric_limits<Real>;
    std::vector<Real> numbers{limits::quiet_NaN(),  limits::infinity(), -limits::infinity(),
                              (limits::max)(),      limits::lowest(),   limits::min(),
                              limits::denorm_min(), Real(-0.),          Real(0)};
    for (const double x : {1e-30, 1e-9, 0.05, 0.3, 0.5,    0.7,    0.999999, 1.,       1.000001, 1.5,  1.999999,
                           2.,    2.5,  7.3,  16., 19.999, 20.001, 1000.,    123456.7, 1e9,      1e16, 1e30})
        numbers.push_back(static_cast<Real>(x));
    numbers.push_back(Real(1) - limits::epsilon() / 2);
    return numbers;
}

/// Not inlined, so that each law is compiled once for each number type.
template <class Law, class Real>
[[gnu::noinline]] mica::counts<Real> drawn(const Real& n, const Real& p, mica::index_of<Real> index) {
    return Law{}(n, p, uniform_stream<Real>(mica::index_of<Real>(18U), index));
}

template <class Law, class Pack>
void expect_lanes(const Pack& n, const Pack& p, std::uint32_t first_index) {
    using Real = typename Pack::value_type;
    using Bits = mica::bits_of<Real>;
    const auto packed = drawn<Law>(n, p, mica::index_of<Pack>::iota(first_index));
    for (int k = 0; k < mica::lanes_of<Pack>; ++k) {
        const auto scalar = drawn<Law>(n[k], p[k], first_index + static_cast<std::uint32_t>(k));
        EXPECT_EQ(std::bit_cast<Bits>(packed.successes[k]), std::bit_cast<Bits>(scalar.successes))
            << "N = " << n[k] << ", p = " << p[k];
        EXPECT_EQ(std::bit_cast<Bits>(packed.failures[k]), std::bit_cast<Bits>(scalar.failures))
            << "N = " << n[k] << ", p = " << p[k];
    }
}

/// Every pair of parameters in every lane, and good ones: N to 2^30, p to 2^-20.
template <class Law, class Pack>
void expect_lanes_equal_scalars() {
    using Index = mica::index_of<Pack>;
    constexpr int lanes = mica::lanes_of<Pack>;
    const auto numbers = any_parameter<typename Pack::value_type>();
    std::uint32_t index = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        for (std::size_t j = 0; j < numbers.size(); ++j, ++index) {
            Pack n(numbers[i]);
            Pack p(numbers[j]);
            for (int k = 1; k < lanes; k += 2) n.set(k, numbers[(i + static_cast<std::size_t>(k)) % numbers.size()]);
            for (int k = 0; k < lanes; k += 3) p.set(k, numbers[(j + static_cast<std::size_t>(k)) % numbers.size()]);
            expect_lanes<Law>(n, p, index);
        }
    }
    for (std::uint32_t i = 0; i < 20000; i += lanes) {
        uniform_stream<Pack> choose{Index(19U), Index::iota(i)};
        const Pack n = mica::exp2(Pack(30) * choose()), p = mica::exp2(Pack(-20) * choose());
        expect_lanes<Law>(n, p, i);
    }
}

TYPED_TEST(Lanes, EqualScalars) {
    expect_lanes_equal_scalars<TypeParam, mica::pack<float, 4>>();
    expect_lanes_equal_scalars<TypeParam, mica::pack<float, 8>>();
    expect_lanes_equal_scalars<TypeParam, mica::pack<float, 16>>();
    expect_lanes_equal_scalars<TypeParam, mica::pack<double, 4>>();
}

} // namespace
