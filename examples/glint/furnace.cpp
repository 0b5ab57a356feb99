// The white furnace: under a constant environment the mean over realisations of glint / smooth is 1.
//
// Under another light, where it shines. A sphere is rendered with many seeds. The sum over all pixels is taken per seed; the
// seeds are independent, so their spread gives the standard error, which neighbouring pixels, sharing glints, would not.
// Seeds are added until the standard error is small enough, also over the grazing pixels (n.wo < 0.25), which are counted
// by themselves. Every setting has seeds of its own. The facets of a setting are those that flash: a pixel has more of
// them, where the light covers but a part of what the surface reflects.
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include <tbb/parallel_for.h>

#include "render.hpp"

namespace glint {

namespace {

struct running_mean {
    double sum = 0, sum_of_squares = 0;
    std::size_t count = 0;

    void add(double x) {
        sum += x;
        sum_of_squares += x * x;
        ++count;
    }
    double mean() const { return sum / static_cast<double>(count); }
    double standard_error() const {
        const auto n = static_cast<double>(count);
        return std::sqrt(std::max(0., sum_of_squares / n - mean() * mean()) / (n - 1));
    }
};

/// What a row asks: a light, and of an environment its levels.
struct furnace_light {
    std::string type;
    int levels;
};

struct furnace_row {
    furnace_light light;
    double facets_per_pixel, log_density, roughness;
    const char* pixels;
    double ratio, standard_error, wanted_error;
    std::size_t realisations;

    /// The demand: within max(0.005, 4 standard errors) of 1, and known that well.
    bool passes() const {
        return standard_error <= wanted_error && std::abs(ratio - 1) <= std::max(0.005, 4 * standard_error);
    }
};

constexpr std::size_t size = 48;
constexpr float grazing_below = 0.25F;

/// A pixel of the sphere, and its brightness without glints.
struct lit_pixel {
    mica::shading_point<float> point;
    shader::illumination light;
    double smooth;
};

/// The pixels that the light reaches, and how many facets a pixel has at log density 0, per facet that flashes: the mean
/// over them of N p, weighted by their radiance.
struct lit_pixels {
    std::vector<lit_pixel> pixels;
    double facets_at_zero = 0, flashes_at_zero = 0;
    double smooth = 0, grazing_smooth = 0;
};

bool grazing(const lit_pixel& pixel) { return dot(pixel.point.normal, pixel.point.wo) < grazing_below; }

lit_pixels lit_by(const shader& shade, const scene& seen) {
    lit_pixels lit;
    double area = 0;
    for (std::size_t i = 0; i < size * size; ++i) {
        const auto hit = seen.surface(i % size, i / size);
        if (!hit) continue;
        const auto light = shade.illuminate(hit->point, seen.surfaces()[0]);
        const auto smooth = static_cast<double>(luminance(light.smooth()));
        if (!(smooth > 0)) continue;
        const lit_pixel pixel{hit->point, light, smooth};
        const auto footprint = static_cast<double>(mica::make_footprint(hit->point.derivatives).area);
        area += footprint;
        lit.flashes_at_zero += smooth * footprint * static_cast<double>(light.flash_probability());
        (grazing(pixel) ? lit.grazing_smooth : lit.smooth) += smooth;
        lit.pixels.push_back(pixel);
    }
    if (lit.pixels.empty()) return lit;
    lit.smooth += lit.grazing_smooth;
    lit.flashes_at_zero /= lit.smooth;
    lit.facets_at_zero = area / static_cast<double>(lit.pixels.size());
    return lit;
}

std::vector<furnace_row> furnace_rows(const furnace_light& light, double facets, double roughness,
                                      const furnace_options& options, std::uint32_t first_seed) {
    scene_description description;
    auto& material = description.surfaces.front().material;
    material.roughness = static_cast<float>(roughness);
    description.lights.front().type = light.type;
    description.lights.front().levels = light.levels;
    description.lights.front().file = "white";
    description.counting = options.counting;
    const shader shade(description);
    const scene seen(description.camera, description.surfaces, size, size);
    const lit_pixels lit = lit_by(shade, seen);
    const double log_density = std::log(facets / lit.flashes_at_zero);
    surface_description surface = description.surfaces.front();
    surface.material.log_density = static_cast<float>(log_density);

    running_mean all, at_grazing;
    constexpr std::size_t batch = 64, most = 65536;
    // Below one facet per pixel the variance has no bound; the demand there grows with the standard error.
    const double wanted = facets >= 1 ? options.precision : 3 * options.precision;
    const bool has_grazing = lit.grazing_smooth > 0.03 * lit.smooth;
    const auto precise = [&] {
        return all.standard_error() <= wanted && (!has_grazing || at_grazing.standard_error() <= wanted);
    };
    while (all.count < most && (all.count < batch || !precise())) {
        std::array<std::array<double, 2>, batch> sums{};
        tbb::parallel_for(std::size_t{0}, batch, [&](std::size_t i) {
            const std::uint32_t seed = mica::hash(first_seed, static_cast<std::uint32_t>(all.count + i));
            for (const auto& pixel : lit.pixels) {
                const auto glint = static_cast<double>(luminance(shade(pixel.point, surface, pixel.light, seed).glint));
                sums[i][0] += glint;
                if (grazing(pixel)) sums[i][1] += glint;
            }
        });
        for (const auto& [sum, grazing_sum] : sums) {
            all.add(sum / lit.smooth);
            if (has_grazing) at_grazing.add(grazing_sum / lit.grazing_smooth);
        }
    }
    const auto row = [&](const char* pixels, const running_mean& measured) {
        return furnace_row{light,
                           facets * lit.facets_at_zero / lit.flashes_at_zero,
                           log_density,
                           roughness,
                           pixels,
                           measured.mean(),
                           measured.standard_error(),
                           wanted,
                           measured.count};
    };
    std::vector<furnace_row> rows{row("all", all)};
    if (has_grazing) rows.push_back(row("grazing", at_grazing));
    return rows;
}

} // namespace

void furnace(const furnace_options& options) {
    for (const double roughness : options.roughness)
        if (!(roughness >= 0 && roughness <= 1)) throw std::invalid_argument("--roughness is not in [0, 1]");
    for (const double facets : options.facets)
        if (!(facets > 0 && facets <= 1e12)) throw std::invalid_argument("--facets is not in (0, 1e12]");
    if (!(options.precision > 0)) throw std::invalid_argument("--precision is not positive");

    std::vector<furnace_light> lights;
    for (const auto& type : options.lights) {
        if (type == "environment")
            for (const int levels : options.levels) lights.push_back({type, levels});
        else
            lights.push_back({type, 2});
    }
    progress reporter("white furnace", lights.size() * options.roughness.size() * options.facets.size());
    std::vector<furnace_row> rows;
    for (const auto& light : lights)
        for (const double facets : options.facets)
            for (const double roughness : options.roughness) {
                for (const auto& row :
                     furnace_rows(light, facets, roughness, options, static_cast<std::uint32_t>(rows.size())))
                    rows.push_back(row);
                reporter.advance();
            }
    const std::string effects = names_of(options.counting.effects);

    if (options.json) {
        std::printf("{\"rows\": [");
        const char* separator = "\n";
        for (const auto& row : rows) {
            std::printf("%s  {\"light\": \"%s\", \"law\": \"%s\", \"effects\": \"%s\", \"levels\": %d, "
                        "\"log_density\": %.4f, \"facets_per_pixel\": %g, \"roughness\": %g, \"pixels\": \"%s\", "
                        "\"ratio\": %.6f, \"standard_error\": %.6f, \"realisations\": %zu, \"passes\": %s}",
                        separator, row.light.type.c_str(), options.counting.law.c_str(), effects.c_str(),
                        row.light.levels, row.log_density, row.facets_per_pixel, row.roughness, row.pixels, row.ratio,
                        row.standard_error, row.realisations, row.passes() ? "true" : "false");
            separator = ",\n";
        }
        std::printf("\n]}\n");
        return;
    }
    std::printf("white furnace, law %s, effects %s: mean of glint / smooth\n\n"
                "light        levels  facets/pixel  log density  roughness  pixels    ratio   std. error\n",
                options.counting.law.c_str(), effects.c_str());
    for (const auto& row : rows)
        std::printf("%-12s %6d  %12g  %11.2f  %9g  %-7s  %7.4f  %9.4f  %s\n", row.light.type.c_str(), row.light.levels,
                    row.facets_per_pixel, row.log_density, row.roughness, row.pixels, row.ratio, row.standard_error,
                    row.passes() ? "" : "beyond max(0.005, 4 std. errors), or not known well enough");
}

} // namespace glint
