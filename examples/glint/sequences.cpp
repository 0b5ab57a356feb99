// What happens between frames and between levels: strips of a zoom, a rotation and a pan, and the distribution of counts
// on the way from one level to the next.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include <mica/law/exact.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>

#include "compare.hpp"
#include "patch.hpp"
#include "render.hpp"

namespace glint {

namespace {

/// A camera that looks straight down on the patch: uv of a pixel is a turned, scaled and moved grid.
struct camera {
    double level, turn, shift; ///< log2 of the pixel's width in uv, half turns, pixels

    mica::uv_derivatives<float> derivatives() const { return patch_footprint{1, turn, level}.derivatives<float>(); }

    mica::uv_point<float> uv(double x, double y) const {
        const auto m = derivatives();
        const auto along = static_cast<float>(x + shift), down = static_cast<float>(y);
        return {0.4F + along * m.du_dx + down * m.du_dy, 0.3F + along * m.dv_dx + down * m.dv_dy};
    }
};

constexpr std::size_t frame_size = 64, frames = 8, enlarged = 2, gap = 6, title = 20;
constexpr double base_level = -9.7;

template <class Law, class Interpolation>
void draw_frame(srgb_picture& picture, std::size_t left, std::size_t top, const camera& seen, std::uint32_t seed) {
    const auto footprint = mica::make_footprint(seen.derivatives());
    // Few and bright, and always the same facets per uv^2.
    const float density = static_cast<float>(40 / std::exp2(2 * base_level)), probability = 0.003F;
    const float trials = density * footprint.area;
    draw_patch(picture, left, top, frame_size, enlarged, 0.8F, [&](double x, double y) {
        const auto uv = seen.uv(x - frame_size / 2., y - frame_size / 2.);
        const auto vertices = mica::make_grid_vertices(footprint, uv, trials, seed);
        return mica::distributed_binomial<Law, Interpolation>{}(vertices, probability);
    });
}

} // namespace

void strips(const strips_options& options) {
    const png_file output(options.output);
    constexpr std::size_t side = frame_size * enlarged;
    srgb_picture picture(frames * (side + gap) + gap, 6 * (side + gap + title) + gap, 0);
    struct sequence {
        const char* name;
        camera first, step;
    };
    const sequence sequences[] = {{"zoom out, a sixth of a level a frame", {base_level, 0, 0}, {1. / 6, 0, 0}},
                                  {"rotation, two degrees a frame", {base_level, 0, 0}, {0, 2. / 180, 0}},
                                  {"pan, half a pixel a frame", {base_level, 0, 0}, {0, 0, 0.5}}};
    std::size_t top = gap;
    for (const auto& [name, first, step] : sequences)
        for (const bool blended : {false, true}) {
            draw_text(picture,
                      std::string(name) + (blended ? ": blended variates, smooth law" : ": interpolated counts"), gap,
                      top + 4, 2, 220);
            for (std::size_t frame = 0; frame < frames; ++frame) {
                const auto t = static_cast<double>(frame);
                const camera seen{first.level + t * step.level, first.turn + t * step.turn,
                                  first.shift + t * step.shift};
                const std::size_t left = gap + frame * (side + gap);
                if (blended)
                    draw_frame<mica::smooth_quantile_binomial<4>, mica::blended_variates>(picture, left, top + title,
                                                                                          seen, options.seed);
                else
                    draw_frame<mica::quantile_binomial<4>, mica::interpolated_counts>(picture, left, top + title, seen,
                                                                                      options.seed);
            }
            top += side + gap + title;
        }
    output.save(picture);
}

void cells(const cells_options& options) {
    const png_file output(options.output);
    constexpr std::size_t side = 512;
    srgb_picture picture(side, side, 0);
    const std::uint32_t grid = mica::grid_seed(options.seed, mica::tetrahedron_vertex<float>{-7, 2, 3, 1, 1});
    for (std::uint32_t j = 0; j < side; ++j)
        for (std::uint32_t i = 0; i < side; ++i) {
            const float z = mica::normal_pair_from_bits<float>(mica::mix(mica::cell_seed(grid, i, j))).first;
            const auto grey = static_cast<std::uint8_t>(std::clamp(128 + 42 * z, 0.F, 255.F));
            for (std::size_t band = 0; band < 3; ++band) picture.bytes[3 * (side * j + i) + band] = grey;
        }
    output.save(picture);
}

void between(const between_options& options) {
    constexpr std::size_t samples = 1 << 18;
    constexpr float at_level = 100, p = 0.2F; // facets in the footprint on the lower level
    std::printf(options.json ? "{\"rows\": [" : "mode          level  count     share\n");
    const char* separator = "\n";
    for (const double fraction : {0., 0.25, 0.5, 0.75, 1.}) {
        const auto trials = static_cast<float>(static_cast<double>(at_level) * std::exp2(2 * fraction));
        const patch_footprint shape{1, 0,
                                    -10 + fraction - std::log2(static_cast<double>(mica::default_footprint_scale))};
        const distributed_patch<mica::exact_binomial, mica::interpolated_counts> counts{
            shape, mica::default_footprint_scale, {}};
        const distributed_patch<mica::exact_binomial, mica::blended_variates> variates{
            shape, mica::default_footprint_scale, {}};
        std::map<std::string, std::map<int, double>> shares;
        for (std::uint32_t i = 0; i < samples; ++i) {
            const std::uint32_t seed = mica::hash(options.seed, i);
            mica::uniform_stream<float> xi(seed);
            const float u = xi();
            const mica::uv_point<float> uv{u, xi()};
            const auto add = [&](const char* mode, double count) {
                shares[mode][static_cast<int>(std::lround(count))] += 1. / samples;
            };
            add("counts", static_cast<double>(counts(uv, trials, p, seed)));
            add("variates", static_cast<double>(variates(uv, trials, p, seed)));
            add("binomial",
                static_cast<double>(mica::exact_binomial{}(trials, p, mica::uniform_stream<float>(seed, 1)).successes));
            // As level-of-detail textures do it: whole cells counted on both levels, and the counts blended.
            const double lower = static_cast<double>(
                mica::exact_binomial{}(at_level, p, mica::uniform_stream<float>(seed, 2)).successes);
            const double upper = static_cast<double>(
                mica::exact_binomial{}(4 * at_level, p, mica::uniform_stream<float>(seed, 3)).successes);
            const double weight = (std::exp2(2 * fraction) - 1) / 3; // of the upper, so that the mean is right
            add("level_blend", (1 - weight) * lower + weight * upper);
        }
        for (const auto& [mode, histogram] : shares)
            for (const auto& [count, share] : histogram) {
                if (options.json)
                    std::printf("%s  {\"mode\": \"%s\", \"level_fraction\": %g, \"count\": %d, \"share\": %.6g}",
                                separator, mode.c_str(), fraction, count, share);
                else
                    std::printf("%-12s  %5g  %5d  %8.5f\n", mode.c_str(), fraction, count, share);
                separator = ",\n";
            }
    }
    if (options.json) std::printf("\n]}\n");
}

} // namespace glint
