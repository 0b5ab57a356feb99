// The first glint: a flat piece of glitter as a picture in text, 64 pixels wide.
#include <cstdio>
#include <mica/mica.hpp>

int main() {
    const float pixel = 1.F / 64;              // uv per pixel: the picture is one unit of uv wide
    const float facets_per_uv2 = 24 * 64 * 64; // 24 facets in a pixel
    const float probability = 0.02F;           // of each, to flash towards the light
    const std::uint32_t seed = 2026;           // which facets there are
    const auto footprint = mica::make_footprint<float>({pixel, 0, 0, pixel});

    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 64; ++x) {
            const mica::uv_point<float> uv{static_cast<float>(x) * pixel, static_cast<float>(y) * pixel};
            const auto vertices = mica::make_grid_vertices(footprint, uv, facets_per_uv2 * footprint.area, seed);
            const float flashes = mica::distributed_binomial<mica::quantile_binomial<4>>{}(vertices, probability);
            std::putchar(" .:*#@"[flashes < 5 ? static_cast<int>(flashes) : 5]);
        }
        std::putchar('\n');
    }
}
