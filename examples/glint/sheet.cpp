// The contact sheet: densities against roughnesses, for K = 4 and K = 8, labelled, in one picture.
#include <cstdio>

#include "render.hpp"

namespace glint {

void sheet(const sheet_options& options) {
    constexpr std::size_t tile = 224, gap = 8, margin_left = 104, margin_top = 44;
    constexpr float densities[] = {10, 12, 14, 17};
    constexpr float roughnesses[] = {0.04F, 0.1F, 0.3F};
    constexpr std::size_t columns = std::size(densities) + 1, rows = std::size(roughnesses);
    constexpr std::size_t block = margin_top + rows * (tile + gap);

    const png_file output(options.output);
    const auto map = procedural_environment();
    const mica::microfacet_table table;
    const scene seen(shape::sphere, tile, tile);
    srgb_picture picture(margin_left + columns * (tile + gap), 2 * block, 24);

    const auto draw_block = [&]<std::size_t K>(std::integral_constant<std::size_t, K>, std::size_t top) {
        const mica::prefiltered_environment<K> environment(map, mica::environment_levels<K>(map), roughnesses,
                                                           parallel_loop{"prefiltering"});
        const auto left_of = [](std::size_t column) { return margin_left + column * (tile + gap); };
        draw_text(picture, "K = " + std::to_string(K), 8, top + 14, 2, 255);
        char label[64];
        for (std::size_t column = 0; column < std::size(densities); ++column) {
            std::snprintf(label, sizeof label, "log density %g", static_cast<double>(densities[column]));
            draw_text(picture, label, left_of(column), top + 14, 2, 200);
        }
        draw_text(picture, "smooth limit", left_of(columns - 1), top + 14, 2, 200);
        for (std::size_t row = 0; row < rows; ++row) {
            const std::size_t tile_top = top + margin_top + row * (tile + gap);
            draw_text(picture, "roughness", 8, tile_top + tile / 2 - 12, 1, 200);
            std::snprintf(label, sizeof label, "%g", static_cast<double>(roughnesses[row]));
            draw_text(picture, label, 8, tile_top + tile / 2, 2, 200);
            for (std::size_t column = 0; column < std::size(densities); ++column) {
                mica::glint_material material;
                material.roughness = roughnesses[row];
                material.log_density = densities[column];
                const frame rendered = render_frame<mica::quantile_binomial<4>>(seen, tile, tile, material, environment,
                                                                                table, options.seed);
                tone_map(rendered.glint, exposure_of(rendered), picture, left_of(column), tile_top);
                if (column == 0)
                    tone_map(rendered.smooth, exposure_of(rendered), picture, left_of(columns - 1), tile_top);
            }
        }
    };
    draw_block(std::integral_constant<std::size_t, 4>{}, 0);
    draw_block(std::integral_constant<std::size_t, 8>{}, block);
    output.save(picture);
    std::printf("%s\n", options.output.c_str());
}

} // namespace glint
