// mica/random/generator_uniforms.hpp: uniforms for the laws from a generator of the standard library's kind.
#pragma once

#include <cstdint>
#include <random>

#include "uniform.hpp"

namespace mica {

/// generator_uniforms<Real, Generator> xi{generator}; xi() is the next Real in the open (0,1), as uniform_from_bits says.
///
/// float takes 32 random bits, double 64. A generator of all 32- or all 64-bit numbers (std::mt19937, std::mt19937_64)
/// gives them as they are, so the uniforms are the same on every platform; any other goes through
/// std::uniform_int_distribution. Refers to the generator, which must outlive it.
template <scalar_number Real, std::uniform_random_bit_generator Generator>
class generator_uniforms {
  public:
    /// Draws from this generator.
    explicit generator_uniforms(Generator& generator) : generator_(generator) {}

    /// The next uniform.
    Real operator()() {
        if constexpr (sizeof(Real) == 4) {
            return uniform_from_bits<Real>(next_32());
        } else if constexpr (gives_all<std::uint64_t>) {
            const std::uint64_t bits = generator_();
            return uniform_from_bits<Real>(static_cast<std::uint32_t>(bits >> 32), static_cast<std::uint32_t>(bits));
        } else {
            const std::uint32_t high = next_32(); // a statement of its own: the order of arguments is the compiler's
            return uniform_from_bits<Real>(high, next_32());
        }
    }

  private:
    template <class Integer>
    static constexpr bool gives_all = (Generator::min)() == 0 &&
                                      (Generator::max)() == (std::numeric_limits<Integer>::max)();

    std::uint32_t next_32() {
        if constexpr (gives_all<std::uint32_t>)
            return static_cast<std::uint32_t>(generator_());
        else if constexpr (gives_all<std::uint64_t>)
            return static_cast<std::uint32_t>(generator_() >> 32);
        else
            return std::uniform_int_distribution<std::uint32_t>()(generator_);
    }

    Generator& generator_;
};

} // namespace mica
