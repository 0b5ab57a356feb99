// A multinomial whose number of categories is known at run time: a thousand facets among as many lamps as there are.
#include <cstdio>
#include <mica/law/exact.hpp>
#include <mica/law/multinomial.hpp>
#include <mica/random/uniform_stream.hpp>
#include <numeric>
#include <vector>

int main() {
    const std::vector<float> towards_lamps{0.02F, 0.05F, 0.001F, 0, 0.3F}; // the rest, 0.629, is dark
    std::vector<float> flashes(towards_lamps.size());

    const mica::multinomial<std::dynamic_extent, mica::exact_binomial> law;
    for (unsigned pixel = 0; pixel < 3; ++pixel) {
        mica::uniform_stream<float> xi{2026, pixel};
        law(1000.F, towards_lamps, xi, flashes);
        for (const float lamp : flashes) std::printf("%4g", static_cast<double>(lamp));
        std::printf(", dark %g\n", 1000 - std::accumulate(flashes.begin(), flashes.end(), 0.));
    }
}

// Prints:
//
//       22  57   0   0 284, dark 637
//       27  36   0   0 280, dark 657
//       26  50   0   0 304, dark 620
