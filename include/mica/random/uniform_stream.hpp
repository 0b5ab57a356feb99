// mica/random/uniform_stream.hpp: a counter-based stream of uniforms.
//
// Draw k of stream (seed, index) is a pure function of the three: mix(mix(index + (k + 1) G) ^ key), G the golden
// increment, key = hash(hash(seed)). No state to carry, nothing to warm up, any pixel at any time; a sequential generator
// would also tie the lanes of a pack together.
//
// Distinct counters: among n consecutive indices and d <= 4096 draws the inner sums are all different while
// n d <= 2^32 / 2.25, because multiples of G keep that distance (three-gap theorem; with more draws the golden ratio,
// cut to 32 bits, keeps less: tests/random_test.cpp). The seed enters hashed, between two rounds, so two seeds share a
// number only by chance, as two random sequences would. (Raw, 2^18 consecutive seeds were not equidistributed; hashed once,
// stream `seed` of every seed began with mix(0) = 0, an extreme draw.)
#pragma once

#include <cstdint>

#include "hash.hpp"
#include "uniform.hpp"

namespace mica {

namespace detail {
/// lane(), where a member of that name hides it.
template <class Number>
MICA_HOST_DEVICE constexpr auto lane_of_number(const Number& number, int i) {
    return lane(number, i);
}
} // namespace detail

/// uniform_stream<Real> xi{seed, index}; xi() is the next Real in the open (0,1).
///
/// seed and index are 32-bit (index_of<Real>: for a pack, one per lane). double takes two hashes a draw.
template <real_number Real>
class uniform_stream {
  public:
    /// What seeds and indices are: 32 bits, for each lane.
    using index_type = index_of<Real>;

    /// Stream `index` of the seed, at its first draw.
    MICA_HOST_DEVICE explicit constexpr uniform_stream(index_type seed, index_type index = index_type(0U))
        : key_(hash(hash(seed))), index_(index) {}

    /// The next uniform.
    MICA_HOST_DEVICE constexpr Real operator()() {
        const index_type first = next_bits();
        if constexpr (sizeof(scalar_of<Real>) == 4)
            return uniform_from_bits<Real>(first);
        else
            return uniform_from_bits<Real>(first, next_bits());
    }

    /// The next 32 random bits.
    MICA_HOST_DEVICE constexpr index_type next_bits() {
        counter_ += golden_increment;
        return mix(mix(index_ + index_type(counter_)) ^ key_);
    }

    /// A new independent stream, at the price of 32 bits of this one (for float: one draw). For work that takes an
    /// unknown number of draws (exact sampling): whatever it takes from the fork, this stream has moved by as much.
    MICA_HOST_DEVICE constexpr uniform_stream fork() { return uniform_stream(next_bits(), index_, 0); }

    /// Stream number `node` of a family with this stream's place in it; this one does not move.
    MICA_HOST_DEVICE constexpr uniform_stream substream(std::uint32_t node) const {
        return uniform_stream(hash(key_ ^ index_type(node)), index_, 0);
    }

    /// The stream of lane i, standing where this one stands.
    MICA_HOST_DEVICE constexpr uniform_stream<scalar_of<Real>> lane(int i) const {
        return uniform_stream<scalar_of<Real>>(detail::lane_of_number(key_, i), detail::lane_of_number(index_, i),
                                               counter_);
    }

  private:
    template <real_number>
    friend class uniform_stream;

    MICA_HOST_DEVICE constexpr uniform_stream(index_type key, index_type index, std::uint32_t counter)
        : key_(key), index_(index), counter_(counter) {}

    index_type key_; ///< the seed, hashed twice
    index_type index_;
    std::uint32_t counter_ = 0;
};

} // namespace mica
