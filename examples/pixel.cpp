// One pixel of a glittering surface: under a sun and a lamp that share one multinomial, and under a sky.
#include <array>
#include <cstdio>
#include <utility>
#include <vector>

#include <mica/mica.hpp>

int main() {
    // The surface, as the pixel sees it: two uv per thousand pixels.
    mica::glint_material material;
    material.roughness = 0.3F;
    material.log_density = 20; // some two thousand facets in the pixel
    mica::shading_point<float> point{};
    point.normal = {0, 0, 1};
    point.tangent = {1, 0, 0};
    point.wo = mica::normalized(mica::vector3<float>{0.3F, 0, 1});
    point.uv = {0.3F, 0.7F};
    point.derivatives = {0.002F, 0, 0, 0.002F};

    const auto towards_sun = mica::normalized(mica::vector3<float>{-0.4F, 0.1F, 1});
    const mica::vector3<float> centre{-1, 1, 2}, half_u{0, -0.4F, 0.2F}, half_v{-0.4F, 0, -0.2F};
    const mica::rgb<float> sun_radiance{2e4F, 1.8e4F, 1.5e4F}, radiance{5, 6, 8};
    const std::uint32_t seed = 1;
    const mica::microfacet_table table; // once per program

    using kernel =
        mica::glint_kernel<mica::quantile_binomial<4>, mica::blended_variates, mica::effects<mica::tinted_glints>>;

    const mica::ggx<float> facets{material.roughness, material.roughness};
    const auto sun = mica::respond(mica::sun_light{towards_sun, sun_radiance}, point, facets, material.f0);
    const auto lamp =
        mica::respond(mica::rectangle_light{centre, half_u, half_v, radiance}, point, facets, material.f0, table);
    const std::array<mica::light_class<float>, 2> classes{
        {{sun.smooth, sun.probability}, {lamp.smooth, lamp.probability}}};
    mica::rgb<float> glint = kernel{}(point, material, classes, sun.half_vector, seed).glint;

    // The sky, filtered once for the roughness of the surface.
    std::vector<mica::rgb<float>> texels;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            texels.push_back(y == 8 && x == 50 ? mica::rgb<float>{900, 800, 700} : mica::rgb<float>{0.2F, 0.3F, 0.5F});
    const mica::environment_map sky(64, 32, std::move(texels));
    const std::array roughnesses{material.roughness};
    const mica::prefiltered_classes<4> filtered_environment(sky, mica::environment_classes<4>::by_brightness(sky),
                                                            roughnesses);

    mica::rgb<float> under_sky = mica::shade(kernel{}, point, material, filtered_environment, table, seed).glint;

    std::printf("sun and lamp: %.3f %.3f %.3f, sky: %.3f %.3f %.3f\n", static_cast<double>(glint.r),
                static_cast<double>(glint.g), static_cast<double>(glint.b), static_cast<double>(under_sky.r),
                static_cast<double>(under_sky.g), static_cast<double>(under_sky.b));
}

// Prints:
//
//     sun and lamp: 0.230 0.319 0.358, sky: 0.163 0.249 0.383
