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
    srgb_picture picture(margin_left + columns * (tile + gap), 2 * block, 24);
    scene_description description;
    description.seed = options.seed;
    auto& material = description.surfaces.front().material;

    const auto draw_block = [&](int levels, std::size_t top) {
        description.lights.front().levels = levels;
        const auto left_of = [](std::size_t column) { return margin_left + column * (tile + gap); };
        draw_text(picture, "K = " + std::to_string(levels), 8, top + 14, 2, 255);
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
            material.roughness = roughnesses[row];
            const shader shade(description);
            for (std::size_t column = 0; column < std::size(densities); ++column) {
                material.log_density = densities[column];
                const scene seen(description.camera, description.surfaces, tile, tile);
                const frame rendered = render_frame(seen, shade, options.seed);
                tone_map(rendered.glint, exposure_of(rendered), picture, left_of(column), tile_top);
                if (column == 0)
                    tone_map(rendered.smooth, exposure_of(rendered), picture, left_of(columns - 1), tile_top);
            }
        }
    };
    draw_block(4, 0);
    draw_block(8, block);
    output.save(picture);
    std::printf("%s\n", options.output.c_str());
}

} // namespace glint
