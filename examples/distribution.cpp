// Distributions for code that is written for those of the standard library: the type is all that changes.
#include <cstdio>
#include <mica/law/binomial_distribution.hpp>
#include <mica/law/multinomial_distribution.hpp>
#include <random>

// Code that exists, for any distribution and any generator.
template <class Distribution, class Generator>
double mean_of(Distribution& distribution, Generator& generator, int draws) {
    double sum = 0;
    for (int i = 0; i < draws; ++i) sum += static_cast<double>(distribution(generator));
    return sum / draws;
}

int main() {
    std::mt19937_64 generator(2026);

    // was: std::binomial_distribution<long long>
    mica::binomial_distribution<long long> flashes(1'000'000'000'000, 3e-12);
    std::printf("mean %.2f\n", mean_of(flashes, generator, 100'000));

    using parameters = decltype(flashes)::param_type;
    std::printf("others: %lld\n", flashes(generator, parameters(100, 0.25)));

    // There is no std::multinomial_distribution.
    mica::multinomial_distribution<> dice(6000, {1. / 6, 1. / 6, 1. / 6, 1. / 6, 1. / 6, 1. / 6});
    for (const int count : dice(generator)) std::printf("%d ", count);
    std::printf("of 6000 throws\n");
}

// Prints:
//
//     mean 3.00
//     others: 21
//     993 998 1018 1015 972 1004 of 6000 throws
