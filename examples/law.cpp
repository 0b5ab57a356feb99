// One law: of a million facets, each flashing with probability 3e-6, how many do? Its mean and variance over many draws.
#include <cstdio>
#include <mica/law/quantile.hpp>
#include <mica/random/uniform_stream.hpp>

int main() {
    const mica::quantile_binomial<4> law;
    mica::uniform_stream<float> xi{2026};

    const auto once = law(1e6F, 3e-6F, xi);
    std::printf("once: %g flash, %g do not\n", static_cast<double>(once.successes), static_cast<double>(once.failures));

    const int draws = 1'000'000;
    double sum = 0, squares = 0;
    for (int i = 0; i < draws; ++i) {
        const auto flashes = static_cast<double>(law(1e6F, 3e-6F, xi).successes);
        sum += flashes;
        squares += flashes * flashes;
    }
    const double mean = sum / draws;
    std::printf("mean %.2f, variance %.2f\n", mean, squares / draws - mean * mean);
}

// Prints:
//
//     once: 4 flash, 999996 do not
//     mean 3.00, variance 2.99
