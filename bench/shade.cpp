// bench/shade.cpp: a pixel from derivatives, view and light to radiance.
#include <mica/law/quantile.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/shade/environment_glints.hpp>
#include <mica/shade/lights.hpp>

#include "suites.hpp"

namespace {

using law = mica::quantile_binomial<4>;
using mica::blended_variates;
using mica::effects;

constexpr std::size_t pixels = 1024;

/// Pixels that see the surface from all sides, at random places.
struct pixel_stream {
    std::vector<float> u, v, azimuth_x, azimuth_y, cosine;
};

const pixel_stream& stream() {
    static const auto values = [] {
        pixel_stream all;
        mica::uniform_stream<float> xi(1);
        for (std::size_t i = 0; i < pixels; ++i) {
            all.u.push_back(xi());
            all.v.push_back(xi());
            const float azimuth = 6.2831853F * xi();
            all.azimuth_x.push_back(std::cos(azimuth));
            all.azimuth_y.push_back(std::sin(azimuth));
            all.cosine.push_back(0.1F + 0.9F * xi());
        }
        return all;
    }();
    return values;
}

template <class Real>
Real load(const std::vector<float>& values, std::size_t i) {
    if constexpr (mica::scalar_number<Real>)
        return values[i];
    else
        return Real::load(&values[i]);
}

template <class Real>
mica::shading_point<Real> point_at(std::size_t i) {
    const auto& all = stream();
    const Real v = load<Real>(all.v, i), cosine = load<Real>(all.cosine, i);
    const Real sine = mica::sqrt(Real(1) - cosine * cosine);
    mica::shading_point<Real> point;
    point.normal = {Real(0), Real(0), Real(1)};
    point.tangent = {Real(1), Real(0), Real(0)};
    point.wo = {sine * load<Real>(all.azimuth_x, i), sine * load<Real>(all.azimuth_y, i), cosine};
    point.uv = {load<Real>(all.u, i), v};
    point.derivatives = {Real(0.01F) + v * Real(0.001F), Real(0.002F) * point.uv.u, Real(-0.001F), Real(0.004F)};
    point.position = {Real(0), Real(0), Real(0)};
    return point;
}

template <class Real, class Shade>
MICA_FLATTEN void shade_pixels(const Shade& shade, std::vector<float>& radiance) {
    for (std::size_t i = 0; i < pixels; i += mica::lanes_of<Real>) {
        const auto colour = shade(point_at<Real>(i)).glint;
        const Real sum = colour.r + colour.g + colour.b;
        if constexpr (mica::scalar_number<Real>)
            radiance[i] = sum;
        else
            sum.store(&radiance[i]);
    }
}

template <class Real, class Shade>
void register_pixel(const std::string& name, Shade shade) {
    streams::measure(name, pixels, [shade, radiance = std::vector<float>(pixels)]() mutable {
        shade_pixels<Real>(shade, radiance);
        benchmark::DoNotOptimize(radiance.data());
    });
}

/// A sky with a sun and a lamp.
const mica::environment_map& sky() {
    static const auto map = [] {
        constexpr std::size_t width = 64, height = 32;
        std::vector<mica::rgb<float>> texels;
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                const float up = 1 - static_cast<float>(y) / height;
                const bool sun = x == 40 && y == 9, lamp = x > 10 && x < 16 && y > 10 && y < 15;
                texels.push_back(sun    ? mica::rgb<float>{9000, 8000, 6000}
                                 : lamp ? mica::rgb<float>{30, 20, 10}
                                        : mica::rgb<float>{0.1F + 0.2F * up, 0.1F + 0.4F * up, 0.1F + 0.8F * up});
            }
        return mica::environment_map(width, height, std::move(texels));
    }();
    return map;
}

const mica::microfacet_table& table() {
    static const mica::microfacet_table built;
    return built;
}

constexpr mica::glint_material material() {
    mica::glint_material surface;
    surface.roughness = 0.3F;
    surface.log_density = 14; // some 50 facets in a pixel
    return surface;
}

template <std::size_t K>
const mica::prefiltered_classes<K>& classes_of_sky() {
    static const std::array<float, 1> roughness{material().roughness};
    static const mica::prefiltered_classes<K> built(sky(), mica::environment_classes<K>::by_brightness(sky()),
                                                    roughness);
    return built;
}

template <class Real>
void register_kernels(const std::string& suite) {
    const auto environment = [&]<std::size_t K>(const std::string& name, auto kernel,
                                                std::integral_constant<std::size_t, K>) {
        register_pixel<Real>(suite + name, [kernel](const mica::shading_point<Real>& point) {
            return mica::shade(kernel, point, material(), classes_of_sky<K>(), table(), 1U);
        });
    };
    // The kernel alone, its classes at hand.
    const auto kernel_alone = [&]<std::size_t K>(const std::string& name, auto kernel,
                                                 std::integral_constant<std::size_t, K>) {
        register_pixel<Real>(suite + name, [kernel](const mica::shading_point<Real>& point) {
            std::array<mica::light_class<Real>, K> classes;
            for (std::size_t k = 0; k < K; ++k) {
                const Real part = Real(1.F / static_cast<float>(K));
                classes[k] = {{part, part * point.wo.z, part}, part * point.wo.z};
            }
            return kernel(point, material(), classes, Real(0.5F) * point.wo, 1U);
        });
    };
    using four = std::integral_constant<std::size_t, 4>;
    using eight = std::integral_constant<std::size_t, 8>;
    using plain = mica::glint_kernel<law>;
    register_pixel<Real>(suite + "smooth_4_without_kernel", [](const mica::shading_point<Real>& point) {
        mica::rgb<Real> smooth{Real(0), Real(0), Real(0)};
        for (const auto& one : mica::light_classes(point, material(), classes_of_sky<4>(), table()))
            smooth = smooth + one.smooth;
        return mica::glint_radiance<Real>{smooth, smooth};
    });
    environment("smooth_4", mica::glint_kernel<mica::no_glints>{}, four{});
    environment("environment_4", plain{}, four{});
    environment("environment_8", plain{}, eight{});
    environment("environment_4_counts", mica::glint_kernel<law, mica::interpolated_counts>{}, four{});
    kernel_alone("kernel_4", plain{}, four{});
    kernel_alone("kernel_8", plain{}, eight{});
    kernel_alone("kernel_4_angular_grid", mica::glint_kernel<law, blended_variates, effects<mica::angular_grid>>{},
                 four{});
    kernel_alone("kernel_4_varied_density", mica::glint_kernel<law, blended_variates, effects<mica::varied_density>>{},
                 four{});
    kernel_alone("kernel_4_tint", mica::glint_kernel<law, blended_variates, effects<mica::tinted_glints>>{}, four{});
    const auto lit = [&](const std::string& name, auto light, auto kernel) {
        register_pixel<Real>(suite + name, [light, kernel](const mica::shading_point<Real>& point) {
            const mica::ggx<Real> facets{Real(material().roughness), Real(material().roughness)};
            const auto response = mica::respond(light, point, facets, material().f0, table());
            const std::array<mica::light_class<Real>, 1> one{{{response.smooth, response.probability}}};
            return kernel(point, material(), one, response.half_vector, 1U);
        });
    };
    const mica::vector3<float> above = mica::normalized(mica::vector3<float>{0.3F, 0.2F, 1});
    lit("directional", mica::directional_light{above, mica::rgb<float>{1, 1, 1}, 1.F}, plain{});
    lit("sun", mica::sun_light{above, mica::rgb<float>{1, 1, 1}, 0.00465F}, plain{});
    lit("rectangle",
        mica::rectangle_light{mica::vector3<float>{0.5F, 0.3F, 2}, mica::vector3<float>{0, 0.5F, 0},
                              mica::vector3<float>{0.5F, 0, 0}, mica::rgb<float>{1, 1, 1}},
        plain{});
}

/// A map that changes: its classes and its filtered map, for one roughness. An item is a whole map.
void register_prefilter() {
    const auto measure = [](const std::string& name, std::size_t width, float roughness,
                            mica::prefilter_quality quality) {
        std::vector<mica::rgb<float>> texels;
        for (std::size_t y = 0; y < width / 2; ++y)
            for (std::size_t x = 0; x < width; ++x)
                texels.push_back(
                    sky()(mica::direction_of({(static_cast<float>(x) + 0.5F) / static_cast<float>(width),
                                              2 * (static_cast<float>(y) + 0.5F) / static_cast<float>(width)})));
        const mica::environment_map map(width, width / 2, std::move(texels));
        streams::measure("prefilter/" + name, 1, [map, roughness, quality] {
            const float roughnesses[] = {roughness};
            const mica::prefiltered_classes<4> filtered(map, mica::environment_classes<4>::by_brightness(map),
                                                        roughnesses, {}, {}, quality);
            benchmark::DoNotOptimize(filtered({0, 1, 0}, roughness).share[0]);
        });
    };
    measure("every_frame_128_rough_0.16", 128, 0.16F, mica::every_frame);
    measure("every_frame_128_rough_0.3", 128, 0.3F, mica::every_frame);
    measure("every_frame_64_rough_0.3", 64, 0.3F, mica::every_frame);
    measure("static_1024_rough_0.16", 1024, 0.16F, {});
    measure("static_1024_rough_0.3", 1024, 0.3F, {});
}

} // namespace

void suites::register_shade() {
    register_prefilter();
    register_kernels<float>("shade_scalar/");
    register_kernels<mica::pack<float, mica::native_lanes<float>>>("shade/");
}
