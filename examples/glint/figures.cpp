// KK25's figures 6, 7, 10, 11, 13 and 14: what each showed, by this code, with the published method beside ours where they
// differ.
#include "figures.hpp"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <tbb/parallel_for.h>

#include "explicit_light.hpp"
#include "render.hpp"

namespace glint {

namespace {

/// A sheet of labelled tiles.
class tiled_picture {
  public:
    tiled_picture(std::size_t columns, std::size_t rows, std::size_t tile)
        : tile_(tile), picture_(label_width + columns * (tile + gap), label_height + rows * (tile + gap), 24) {}

    std::size_t tile() const { return tile_; }
    void label_column(std::size_t column, const std::string& text) {
        draw_text(picture_, text, left(column), 8, 1, 220);
    }
    void label_row(std::size_t row, const std::string& text) {
        draw_text(picture_, text, 6, top(row) + tile_ / 2, 1, 220);
    }
    void draw(std::size_t column, std::size_t row, const radiance_picture& content, float exposure) {
        tone_map(content, exposure, picture_, left(column), top(row));
    }
    const srgb_picture& picture() const { return picture_; }

  private:
    static constexpr std::size_t gap = 6, label_width = 132, label_height = 24;
    std::size_t left(std::size_t column) const { return label_width + column * (tile_ + gap); }
    std::size_t top(std::size_t row) const { return label_height + row * (tile_ + gap); }

    std::size_t tile_;
    srgb_picture picture_;
};

scene tile_scene(const scene_description& description, std::size_t tile) {
    return scene(description.camera, description.surfaces, tile, tile);
}

frame rendered(const scene_description& description, std::size_t tile) {
    return render_frame(tile_scene(description, tile), shader(description), description.seed);
}

radiance_picture explicit_facets(const scene_description& description, std::size_t tile) {
    const auto light = make_explicit_light(description.lights.front(), description.occluder,
                                           description.surfaces.front().material.roughness);
    return picture_of_facets(tile_scene(description, tile), *light, description.surfaces.front(), description.seed);
}

/// The mean over many realisations.
radiance_picture mean_of(const scene_description& description, std::size_t tile, int realisations) {
    const scene seen = tile_scene(description, tile);
    const shader shade(description);
    radiance_picture mean{tile, tile, std::vector<colour>(tile * tile, background)};
    parallel_loop{"realisations"}(tile, [&](std::size_t y) {
        for (std::size_t x = 0; x < tile; ++x) {
            const auto hit = seen.surface(x, y);
            if (!hit) continue;
            const auto& surface = seen.surfaces()[hit->surface];
            const auto light = shade.illuminate(hit->point, surface);
            vector sum{0, 0, 0};
            for (int i = 0; i < realisations; ++i) {
                const auto radiance =
                    shade(hit->point, surface, light, mica::hash(description.seed, static_cast<std::uint32_t>(i)));
                sum = sum + vector{radiance.glint.r, radiance.glint.g, radiance.glint.b};
            }
            const float share = 1 / static_cast<float>(realisations);
            mean.pixels[y * tile + x] = {share * sum.x, share * sum.y, share * sum.z};
        }
    });
    return mean;
}

/// Left half of one, right half of the other.
radiance_picture split(radiance_picture left, const radiance_picture& right) {
    for (std::size_t y = 0; y < left.height; ++y)
        for (std::size_t x = left.width / 2; x < left.width; ++x)
            left.pixels[y * left.width + x] = right.pixels[y * left.width + x];
    return left;
}

radiance_picture difference(radiance_picture a, const radiance_picture& b) {
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        auto& p = a.pixels[i];
        const auto& q = b.pixels[i];
        p = {std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)};
    }
    return a;
}

std::string text_of(const char* format, double value) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

/// Four ways to see an environment, in rows: published levels, ours, and the facets themselves.
struct way {
    const char* name;
    const char* classes;
    int levels;
};
constexpr way published_4{"published, K = 4", "published", 4}, published_8{"published, K = 8", "published", 8},
    local_4{"ours, K = 4", "brightness", 4}, local_8{"ours, K = 8", "brightness", 8},
    by_colour_4{"by colour, K = 4", "colour", 4};

scene_description with(scene_description description, const way& chosen) {
    description.lights.front().classes = chosen.classes;
    description.lights.front().levels = chosen.levels;
    return description;
}

/// Spheres of three roughnesses and three densities under an environment.
tiled_picture roughness_and_density(scene_description description) {
    tiled_picture sheet(9, 5, 112);
    auto& material = description.surfaces.front().material;
    const way ways[] = {published_4, published_8, local_4, local_8};
    for (std::size_t row = 0; row < std::size(ways); ++row) sheet.label_row(row, ways[row].name);
    sheet.label_row(std::size(ways), "explicit facets");
    const float roots[] = {0.2F, 0.5F, 0.7F}, densities[] = {9, 11, 13};
    for (std::size_t column = 0; column < 9; ++column) {
        const float root = roots[column % 3];
        material.log_density = densities[column / 3];
        material.roughness = root * root;
        sheet.label_column(column, text_of("d %g", static_cast<double>(material.log_density)) +
                                       text_of(" sqrt a %g", static_cast<double>(root)));
        float exposure = 1;
        for (std::size_t row = 0; row < std::size(ways); ++row) {
            const frame seen = rendered(with(description, ways[row]), sheet.tile());
            exposure = exposure_of(seen);
            sheet.draw(column, row, seen.glint, exposure);
        }
        sheet.draw(column, std::size(ways), explicit_facets(description, sheet.tile()), exposure);
    }
    return sheet;
}

/// A white furnace: a realisation left, the mean of many right.
tiled_picture white_furnace(scene_description description, int realisations) {
    description.lights.front().file = "white";
    auto& material = description.surfaces.front().material;
    material.roughness = 0.16F;
    tiled_picture sheet(4, 1, 224);
    sheet.label_row(0, "one | mean");
    const float densities[] = {8, 10, 12};
    for (std::size_t column = 0; column < 3; ++column) {
        material.log_density = densities[column];
        sheet.label_column(column, text_of("ln density %g", static_cast<double>(densities[column])));
        const frame seen = rendered(description, sheet.tile());
        sheet.draw(column, 0, split(seen.glint, mean_of(description, sheet.tile(), realisations)), 0.5F);
        if (column == 0) sheet.draw(3, 0, seen.smooth, 0.5F);
    }
    sheet.label_column(3, "smooth");
    return sheet;
}

/// A flat plane of low roughness, by all ways.
tiled_picture plane_in_environment(scene_description description) {
    description.surfaces.front().shape = "plane";
    description.camera = camera_for("plane");
    auto& material = description.surfaces.front().material;
    material.roughness = 0.03F;
    material.log_density = 10.5F;
    const way ways[] = {published_4, published_8, local_4, local_8};
    tiled_picture sheet(std::size(ways) + 1, 1, 224);
    float exposure = 1;
    for (std::size_t column = 0; column < std::size(ways); ++column) {
        const frame seen = rendered(with(description, ways[column]), sheet.tile());
        exposure = exposure_of(seen);
        sheet.label_column(column, ways[column].name);
        sheet.draw(column, 0, seen.glint, exposure);
    }
    sheet.label_column(std::size(ways), "explicit facets");
    sheet.draw(std::size(ways), 0, explicit_facets(description, sheet.tile()), exposure);
    return sheet;
}

/// Three coloured lamps, 6 and 50 degrees apart.
tiled_picture coloured_lamps(scene_description description) {
    auto& material = description.surfaces.front().material;
    material.roughness = 0.16F;
    material.log_density = 13;
    const way ways[] = {published_8, local_8, by_colour_4};
    tiled_picture sheet(std::size(ways) + 2, 2, 200);
    const char* const lamps[] = {"lamps:6", "lamps:50"};
    for (std::size_t row = 0; row < 2; ++row) {
        description.lights.front().file = lamps[row];
        sheet.label_row(row, lamps[row] + 6 + std::string(" degrees apart"));
        float exposure = 1;
        for (std::size_t i = 0; i < std::size(ways); ++i) {
            const frame seen = rendered(with(description, ways[i]), sheet.tile());
            exposure = 0.02F * exposure_of(seen); // the glints are to show their colours
            if (i == 0) sheet.draw(0, row, seen.smooth, 15 * exposure);
            sheet.label_column(i + 1, ways[i].name);
            sheet.draw(i + 1, row, seen.glint, exposure);
        }
        sheet.draw(std::size(ways) + 1, row, explicit_facets(description, sheet.tile()), exposure);
    }
    sheet.label_column(0, "smooth");
    sheet.label_column(std::size(ways) + 1, "explicit facets");
    return sheet;
}

/// A plane under a light at three densities: the published law on interpolated counts, and ours. Right halves: how far the
/// mean of many realisations is from smooth, so many times as bright.
tiled_picture plane_under_light(scene_description description, const char* published_law, const float (&densities)[3],
                                int realisations) {
    description.surfaces.front().shape = "plane";
    description.camera = camera_for("plane");
    tiled_picture sheet(3, 2, 224);
    for (std::size_t row = 0; row < 2; ++row) {
        description.counting = row == 0 ? counting_description{published_law, "counts", 0, {}} : counting_description{};
        sheet.label_row(row, row == 0 ? "published" : "ours");
        for (std::size_t column = 0; column < 3; ++column) {
            description.surfaces.front().material.log_density = densities[column];
            sheet.label_column(column, text_of("ln density %g", static_cast<double>(densities[column])));
            const frame seen = rendered(description, sheet.tile());
            const auto wrong = difference(mean_of(description, sheet.tile(), realisations), seen.smooth);
            const float exposure = exposure_of(seen);
            sheet.draw(column, row, split(seen.glint, wrong), exposure);
        }
    }
    return sheet;
}

tiled_picture drawn(const figure_options& options) {
    scene_description description;
    description.seed = options.seed;
    description.lights.front().file = options.environment;
    if (options.number == 6) return roughness_and_density(description);
    if (options.number == 7) return white_furnace(description, options.realisations);
    if (options.number == 10) return plane_in_environment(description);
    if (options.number == 11) return coloured_lamps(description);
    auto& light = description.lights.front();
    auto& material = description.surfaces.front().material;
    material.roughness = 0.04F;
    if (options.number == 13) {
        light.type = "rectangle";
        light.centre = {0, 2.2F, -4.5F};
        light.half_u = {2.2F, 0, 0};
        light.half_v = {0, 1.5F, 0};
        return plane_under_light(description, "floored_gated", {7, 9, 13}, options.realisations);
    }
    if (options.number == 14) {
        light.type = "sun";
        light.direction = {0.2F, 0.42F, -1};
        return plane_under_light(description, "published_gated", {22, 27, 32}, options.realisations);
    }
    throw std::invalid_argument("figure " + std::to_string(options.number) +
                                " of KK25 is not drawn (6, 7, 10, 11, 13 and 14 are)");
}

} // namespace

void figure(const figure_options& options) {
    if (options.realisations < 1) throw std::invalid_argument("--realisations is not positive");
    const png_file output(options.output);
    output.save(drawn(options).picture());
    std::printf("%s\n", options.output.c_str());
}

} // namespace glint
