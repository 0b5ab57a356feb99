// mica in an engine with vectors, materials and a G-buffer of its own: what is converted where they meet, and a loop over tiles
// that shades packs of pixels. docs/engine.md explains it step by step.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <mica/mica.hpp>
#include <numeric>
#include <vector>

// What every engine has, in one form or another.
namespace engine {

struct float2 {
    float x, y;
};
struct float3 {
    float x, y, z;
};

struct material {
    float3 specular{0.95F, 0.93F, 0.88F};
    float perceptual_roughness = 0.5F;
    float flakes_per_uv2 = 1e5F;
};

/// What the G-buffer knows of a pixel. Directions are unit vectors of the world.
struct surface {
    float3 normal, tangent, to_eye;
    float2 uv, duv_dx, duv_dy; // derivatives per pixel
};

/// A floor under an eye one unit above it; uv is the place on the floor.
struct frame {
    int width = 60, height = 16;

    surface at(int x, int y) const {
        const float pixel = 1.F / static_cast<float>(width);
        const float across = (static_cast<float>(x) + 0.5F) * pixel - 0.5F;
        const float down = (static_cast<float>(y) + 6.5F) * pixel;
        const float inverse_length = 1 / std::sqrt(across * across + down * down + 1);
        return {{0, 1, 0},
                {1, 0, 0},
                {-across * inverse_length, down * inverse_length, inverse_length},
                {across / down, 1 / down},
                {pixel / down, 0},
                {-across * pixel / (down * down), -pixel / (down * down)}};
    }
};

struct tile {
    int left, top, right, bottom;
};

} // namespace engine

mica::glint_material glints_of(const engine::material& from) {
    mica::glint_material material;
    material.roughness = from.perceptual_roughness * from.perceptual_roughness; // GGX's alpha
    material.log_density = std::log(from.flakes_per_uv2);                       // the natural logarithm
    material.f0 = {from.specular.x, from.specular.y, from.specular.z};
    return material;
}

using pixels = mica::pack<float, mica::native_lanes<float>>;
constexpr int lane_count = mica::lanes_of<pixels>;

void set_lane(mica::vector3<pixels>& to, int i, engine::float3 from) {
    to.x.set(i, from.x);
    to.y.set(i, from.y);
    to.z.set(i, from.z);
}

mica::shading_point<pixels> points_of(const std::array<engine::surface, lane_count>& surfaces) {
    mica::shading_point<pixels> point{};
    for (int i = 0; i < lane_count; ++i) {
        const engine::surface& from = surfaces[static_cast<std::size_t>(i)];
        set_lane(point.normal, i, from.normal);
        set_lane(point.tangent, i, from.tangent);
        set_lane(point.wo, i, from.to_eye);
        point.uv.u.set(i, from.uv.x);
        point.uv.v.set(i, from.uv.y);
        point.derivatives.du_dx.set(i, from.duv_dx.x);
        point.derivatives.dv_dx.set(i, from.duv_dx.y);
        point.derivatives.du_dy.set(i, from.duv_dy.x);
        point.derivatives.dv_dy.set(i, from.duv_dy.y);
    }
    return point;
}

constexpr std::size_t K = 4;

struct lighting {
    mica::microfacet_table table;     // once per program
    mica::prefiltered_classes<K> sky; // once per environment, or in every frame
    mica::sun_light sun;
};

mica::prefiltered_classes<K> filtered(const mica::environment_map& map, std::span<const float> roughnesses,
                                      bool changes_every_frame) {
    const auto quality = changes_every_frame ? mica::every_frame : mica::prefilter_quality{};
    return {map, mica::environment_classes<K>::by_brightness(map), roughnesses, {}, {}, quality};
}

using plain = mica::glint_kernel<mica::quantile_binomial<4>>;

// Glints that fade, and none where they would vary the radiance by less than 5 %.
using fading =
    mica::glint_kernel<mica::quantile_binomial<4>, mica::softened_variates, mica::effects<mica::smooth_where_dense>>;

template <class Kernel>
mica::glint_radiance<pixels> shade(const Kernel& kernel, const mica::shading_point<pixels>& point,
                                   const mica::glint_material& material, const lighting& lights, std::uint32_t seed) {
    const auto sky = mica::light_classes(point, material, lights.sky, lights.table);
    const mica::ggx<pixels> facets{material.roughness, material.roughness};
    const auto sun = mica::respond(lights.sun, point, facets, material.f0);

    std::array<mica::light_class<pixels>, K + 1> classes;
    std::copy(sky.begin(), sky.end(), classes.begin());
    classes[K] = {sun.smooth, sun.probability};
    // Class 0 of a sky takes in all facets that no other class has: not those that flash towards the sun.
    classes[0].probability = mica::maximum(classes[0].probability - sun.probability, pixels(0));
    return kernel(point, material, classes, {}, seed);
}

template <class Kernel>
void shade_tile(const Kernel& kernel, const engine::frame& frame, const engine::tile& tile,
                const mica::glint_material& material, const lighting& lights, std::vector<float>& glint,
                std::vector<float>& smooth) {
    const std::uint32_t seed = 7; // of the surface: the same in every tile and every frame
    for (int y = tile.top; y < tile.bottom; ++y)
        for (int x = tile.left; x < tile.right; x += lane_count) {
            const int here = std::min(lane_count, tile.right - x); // what is left over repeats the last pixel
            std::array<engine::surface, lane_count> surfaces;
            for (int i = 0; i < lane_count; ++i)
                surfaces[static_cast<std::size_t>(i)] = frame.at(x + std::min(i, here - 1), y);

            const auto radiance = shade(kernel, points_of(surfaces), material, lights, seed);
            const pixels counted = mica::luminance(radiance.glint), expected = mica::luminance(radiance.smooth);
            for (int i = 0; i < here; ++i) {
                const auto pixel = static_cast<std::size_t>(y * frame.width + x + i);
                glint[pixel] = counted[i];
                smooth[pixel] = expected[i];
            }
        }
}

int main() {
    const engine::frame frame;
    const mica::glint_material material = glints_of(engine::material{});

    std::vector<mica::rgb<float>> texels; // an engine has its own, linear: row 0 is the zenith, -z the middle column
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) texels.push_back(y < 16 ? mica::rgb<float>{0.3F, 0.5F, 0.9F} : mica::rgb<float>{});
    for (int x = 20; x < 44; ++x) texels[static_cast<std::size_t>(10 * 64 + x)] = {8, 7, 5}; // a bank of lamps
    const mica::environment_map map(64, 32, std::move(texels));
    const std::array roughnesses{material.roughness};
    const lighting lights{{},
                          filtered(map, roughnesses, false),
                          {mica::normalized(mica::vector3<float>{0.1F, 0.3F, -1}), {2e4F, 2e4F, 2e4F}}};

    const auto size = static_cast<std::size_t>(frame.width * frame.height);
    std::vector<float> glint(size), smooth(size);
    const auto draw = [&](const auto& kernel) {
        for (int top = 0; top < frame.height; top += 8)
            for (int left = 0; left < frame.width; left += 20) // in any order, on any thread
                shade_tile(kernel, frame, {left, top, left + 20, top + 8}, material, lights, glint, smooth);
    };
    const auto mean = [](const std::vector<float>& values) {
        return std::accumulate(values.begin(), values.end(), 0.) / static_cast<double>(values.size());
    };

    draw(fading{{0.2F}, {{0.05F}}});
    std::printf("mean radiance %.2f with fading glints\n", mean(glint));
    draw(plain{});
    std::printf("mean radiance %.2f, of the smooth floor %.2f\n", mean(glint), mean(smooth));
    for (std::size_t pixel = 0; pixel < size; ++pixel) {
        std::putchar(" .:*#@"[std::clamp(static_cast<int>(1 + std::log2(std::max(glint[pixel], 0.1F))), 0, 5)]);
        if ((pixel + 1) % static_cast<std::size_t>(frame.width) == 0) std::putchar('\n');
    }
}

// Prints:
//
//     mean radiance 1.83 with fading glints
//     mean radiance 1.87, of the smooth floor 1.78
//                  .       .     .::::******::*:  : ...       .
//                             ::  *..***.::. ::*. ::
//                     *:        : **:::***#*##**:::*:    :
//                          :      :::*:*#:##**:* ::*
//                         *         *##******         **
//                            *#***  *** ##**##**    *
//                              *    *#* *@@@# *****     *
//      ##    #                           ###      #
//                       #                @@@#  #
//                                      ####@  #
//                                  #    ##  #
//       @                         #     #     ##        @
//      @                                @        @
//                                                @
//                                                @
//                            @@          @
