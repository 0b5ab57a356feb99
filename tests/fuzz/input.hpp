// tests/fuzz/input.hpp: what the fuzzers share. Bytes of libFuzzer's become numbers; what is found aborts.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

/// The bytes of one run, taken from the front. Where they have run out all is 0.
class input {
  public:
    input(const std::uint8_t* bytes, std::size_t size) : bytes_(bytes, size) {}

    /// Any bits: NaNs, infinities and denormal numbers among them.
    template <class Number>
        requires(std::is_arithmetic_v<Number>)
    Number take() {
        Number value{};
        const std::size_t size = bytes_.size() < sizeof value ? bytes_.size() : sizeof value;
        if (size > 0) std::memcpy(&value, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
        return value;
    }

    /// An integer below `limit`.
    std::uint32_t below(std::uint32_t limit) { return take<std::uint8_t>() % limit; }

    /// A number of [low, high]. The bits that have one in there are taken as they are.
    float within(float low, float high) {
        const auto bits = take<std::uint32_t>();
        const auto value = std::bit_cast<float>(bits);
        return value >= low && value <= high ? value : low + (high - low) * (static_cast<float>(bits >> 8) * 0x1p-24F);
    }

    std::string rest() const { return {bytes_.begin(), bytes_.end()}; }

  private:
    std::span<const std::uint8_t> bytes_;
};

/// Whether two numbers are the same to the last bit.
template <class Number>
bool same_bits(Number a, Number b) {
    using bytes = std::array<unsigned char, sizeof a>;
    return std::bit_cast<bytes>(a) == std::bit_cast<bytes>(b);
}

/// Aborts, so that libFuzzer keeps the input, where what must hold does not.
inline void require(bool holds, const char* what, double a = 0, double b = 0) {
    if (holds) return;
    std::fprintf(stderr, "not so: %s (%a, %a)\n", what, a, b);
    std::abort();
}
