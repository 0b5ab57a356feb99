// Glints on a floor that reaches to the horizon: counts on the grids, from footprints of every size, in grid.ppm.
#include <cstdio>
#include <mica/grid/distributed.hpp>
#include <mica/law/quantile.hpp>
#include <vector>

int main() {
    const int width = 512, height = 256;
    std::vector<unsigned char> picture;
    double sum = 0, expected = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            // The eye is one unit above the floor; h is how far a ray falls per unit of its way.
            const float h = (static_cast<float>(y) + 4) / width;
            const float across = (static_cast<float>(x) - width / 2.F) / width;
            const mica::uv_point<float> uv{across / h, 1 / h};
            const float du_dx = 1 / (h * width), du_dy = -across / (h * h * width), dv_dy = -1 / (h * h * width);

            const auto footprint = mica::make_footprint<float>({du_dx, 0, du_dy, dv_dy});
            const float facets = 2e5F * footprint.area, probability = 0.01F;
            const auto vertices = mica::make_grid_vertices(footprint, uv, facets, 2026);
            const float flashes = mica::distributed_binomial<mica::quantile_binomial<4>>{}(vertices, probability);

            // Radiance over that of a smooth floor, as the eye would see it.
            const float radiance = flashes / (facets * probability), brightness = 255 * radiance / (1 + radiance);
            picture.insert(picture.end(), 3, static_cast<unsigned char>(brightness));
            sum += static_cast<double>(flashes);
            expected += static_cast<double>(facets * probability);
        }

    std::printf("flashes: %.3f of those expected\n", sum / expected);
    std::FILE* file = std::fopen("grid.ppm", "wb");
    if (!file) return 1;
    std::fprintf(file, "P6 %d %d 255\n", width, height);
    std::fwrite(picture.data(), 1, picture.size(), file);
    return std::fclose(file) == 0 ? 0 : 1;
}

// Prints:
//
//     flashes: 0.999 of those expected
