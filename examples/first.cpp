// The program of the README: how many of a million facets flash towards each of three lights, in four pixels?
#include <cstdio>
#include <mica/mica.hpp>

int main() {
    const std::array<float, 3> towards_light{1e-6F, 3e-6F, 2e-7F};
    for (unsigned pixel = 0; pixel < 4; ++pixel) {
        mica::uniform_stream<float> xi{2026, pixel};
        const auto flashes = mica::multinomial<3, mica::exact_binomial>{}(1e6F, towards_light, xi);
        std::printf("pixel %u: %g %g %g\n", pixel, flashes[0], flashes[1], flashes[2]);
    }
}
