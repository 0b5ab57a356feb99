// mica/random/hash.hpp: integer hashes. 32-bit multiplies and fixed shifts only, so equal bits on every target and in
// every lane of a pack, and no data-dependent shift, which is slow without AVX2.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include "../config.hpp"

namespace mica {

/// What is hashed: 32-bit integers without a sign, or packs of them.
template <class Index>
concept hash_index = std::same_as<Index, std::uint32_t> || !std::is_arithmetic_v<Index>;

/// A bijection of the 32-bit integers in which every input bit changes every output bit with probability near 1/2:
/// the "lowbias32" of Wellons' hash prospector (released into the public domain), exact bias 0.174. 0 maps to 0.
template <hash_index Index>
MICA_HOST_DEVICE constexpr Index mix(Index x) {
    x = x ^ (x >> 16);
    x = x * Index(0x7feb352dU);
    x = x ^ (x >> 15);
    x = x * Index(0x846ca68bU);
    x = x ^ (x >> 16);
    return x;
}

/// Fraction of the golden ratio in 32 bits: the increment whose multiples stay farthest apart.
inline constexpr std::uint32_t golden_increment = 0x9e3779b9U;

/// One well-mixed integer of several, in their order. hash(a), hash(a, b), hash(a, b, c), ...
template <hash_index Index>
MICA_HOST_DEVICE constexpr Index hash(Index first) {
    return mix(first + Index(golden_increment));
}

/// The same of two and more.
template <hash_index Index, class... Indices>
MICA_HOST_DEVICE constexpr Index hash(Index first, Index second, Indices... more) {
    return hash(Index(hash(first) ^ second), more...);
}

} // namespace mica
