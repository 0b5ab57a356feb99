// tests/hygiene/drawn.hpp: what is drawn with the flags on trial (first.cpp, second.cpp), for main.cpp to judge.
#pragma once

#include <cstdint>
#include <vector>

namespace drawn {

enum class law { exact, quantile_4 };

/// Counts of one pair of parameters: element i in a batch and, for some, alone.
struct counts {
    std::vector<float> in_batch;
    std::vector<float> alone; ///< elements 0, 997, 1994, ...
};
counts binomials(law which, float trials, float probability, std::uint32_t seed, std::uint32_t size);

struct outcome {
    float successes, failures;
};
outcome one(law which, float trials, float probability, std::uint32_t seed);

/// How many facets a pixel has, and how many of them flash.
float facets();
float flashes(float probability, std::uint32_t seed);

/// The pixel under a sun: what its facets reflect, as either translation unit has it, and what infinitely many would.
struct brightness {
    float glint, smooth;
};
brightness under_the_sun(std::uint32_t seed);
brightness under_the_sun_in_second_unit(std::uint32_t seed);

/// The sum of the probabilities of all classes of a white sky, which is 1.
float probability_under_the_sky();

/// Gives a constructor a floor of -1.
void give_a_bad_argument();

} // namespace drawn
