// A batch: a count for every element of a vector, as many side by side as the registers hold.
#include <cstdio>
#include <mica/law/batch.hpp>
#include <mica/law/quantile.hpp>
#include <numeric>
#include <vector>

int main() {
    const std::size_t size = 100'000;
    std::vector<float> trials(size, 1000), probabilities(size), successes(size);
    for (std::size_t i = 0; i < size; ++i) probabilities[i] = static_cast<float>(i % 8) / 1000;

    const mica::quantile_binomial<4> law;
    const std::uint32_t seed = 2026;
    mica::sample(law, trials, probabilities, seed, successes);
    for (std::size_t i = 0; i < 8; ++i) std::printf("%g ", static_cast<double>(successes[i]));
    std::printf("... mean %.2f\n", std::accumulate(successes.begin(), successes.end(), 0.) / size);

    // Element 5 alone: the stream of the same seed and its own index gives the same count.
    mica::uniform_stream<float> xi{seed, 5};
    std::printf("element 5: %g\n", static_cast<double>(law(trials[5], probabilities[5], xi).successes));

    // The same parameters for all need no vector.
    mica::sample(law, 1e9F, 1e-9F, seed, successes);
    std::printf("mean %.2f\n", std::accumulate(successes.begin(), successes.end(), 0.) / size);
}

// Prints:
//
//     0 0 2 4 1 8 6 5 ... mean 3.51
//     element 5: 8
//     mean 1.00
