// tests/hygiene/first.cpp: all of mica, used.
#include <memory>

#include "drawn.hpp"
#include "surface.hpp"

namespace drawn {

namespace {

mica::environment_map white_sky() { return {8, 4, std::vector<mica::rgb<float>>(32, {1, 1, 1})}; }

template <class Law>
counts binomials_of(float trials, float probability, std::uint32_t seed, std::uint32_t size) {
    counts result{std::vector<float>(size), {}};
    mica::sample(Law{}, trials, probability, seed, result.in_batch);
    for (std::uint32_t i = 0; i < size; i += 997)
        result.alone.push_back(Law{}(trials, probability, mica::uniform_stream<float>{seed, i}).successes);
    return result;
}

template <class Law>
outcome one_of(float trials, float probability, std::uint32_t seed) {
    const auto [successes, failures] = Law{}(trials, probability, mica::uniform_stream<float>{seed});
    return {successes, failures};
}

} // namespace

counts binomials(law which, float trials, float probability, std::uint32_t seed, std::uint32_t size) {
    return which == law::exact ? binomials_of<mica::exact_binomial>(trials, probability, seed, size)
                               : binomials_of<mica::quantile_binomial<4>>(trials, probability, seed, size);
}

outcome one(law which, float trials, float probability, std::uint32_t seed) {
    return which == law::exact ? one_of<mica::exact_binomial>(trials, probability, seed)
                               : one_of<mica::quantile_binomial<4>>(trials, probability, seed);
}

float facets() { return surface::facets(); }
float flashes(float probability, std::uint32_t seed) { return surface::flashes(probability, seed); }
brightness under_the_sun(std::uint32_t seed) { return surface::under_the_sun(seed); }

float probability_under_the_sky() {
    const auto sky = white_sky();
    const std::array roughnesses{surface::material().roughness};
    const mica::prefiltered_classes<4> filtered(sky, mica::environment_classes<4>::by_brightness(sky), roughnesses);
    const auto table = std::make_unique<mica::microfacet_table>(); // large
    float sum = 0;
    for (const auto& one : mica::light_classes(surface::point(), surface::material(), filtered, *table))
        sum += one.probability;
    return sum;
}

void give_a_bad_argument() { mica::environment_levels<4>(white_sky(), -1).radiance(); }

} // namespace drawn
