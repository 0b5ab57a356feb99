// What there is to see: a sphere or a plane, a camera in front of it, and an environment that needs no file.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <mica/shade/environment_glints.hpp>

namespace glint {

enum class shape { sphere, plane };

/// A pinhole camera and the shape in front of it. One uv unit square is the area of the unit sphere, 4 pi, on both
/// shapes, so that a density means the same.
class scene {
  public:
    scene(shape what, std::size_t width, std::size_t height) : what_(what), width_(width), height_(height) {
        // The smaller side of the picture sees the sphere with a margin; the plane is seen from a height of 1.2.
        const auto smaller = static_cast<float>((std::min)(width, height));
        if (what == shape::sphere) {
            eye_ = {0, 0, 4};
            forward_ = {0, 0, -1};
            step_ = 0.56F / smaller;
        } else {
            eye_ = {0, 1.2F, 0};
            forward_ = mica::normalized(mica::vector3<float>{0, -0.42F, -1});
            step_ = 0.9F / smaller;
        }
        up_ = mica::cross({1, 0, 0}, forward_);
    }

    /// The surface seen through the middle of a pixel, with the derivatives of its uv by the pixel, analytic: the ray
    /// moves on the tangent plane, dP/dx = t (dD - D (n.dD) / (n.D)) for the ray direction D (Igehy 1999).
    std::optional<mica::shading_point<float>> surface(std::size_t x, std::size_t y) const {
        using vector = mica::vector3<float>;
        const float right = step_ * (static_cast<float>(x) + 0.5F - static_cast<float>(width_) / 2);
        const float above = step_ * (static_cast<float>(height_) / 2 - static_cast<float>(y) - 0.5F);
        const vector ray = forward_ + vector{right, 0, 0} + above * up_;
        const vector ray_dx = {step_, 0, 0}, ray_dy = -step_ * up_;

        float t = 0;
        vector normal{0, 1, 0};
        if (what_ == shape::sphere) {
            const float a = dot(ray, ray), b = dot(eye_, ray), c = dot(eye_, eye_) - 1;
            const float discriminant = b * b - a * c;
            if (!(discriminant > 0)) return std::nullopt;
            t = (-b - std::sqrt(discriminant)) / a;
            normal = mica::normalized(eye_ + t * ray);
        } else {
            if (!(ray.y < 0)) return std::nullopt;
            t = -eye_.y / ray.y;
        }
        const vector point = eye_ + t * ray;
        const auto moved = [&](vector ray_derivative) {
            return t * (ray_derivative - (dot(normal, ray_derivative) / dot(normal, ray)) * ray);
        };
        mica::shading_point<float> result{normal, mica::normalized(-1 * ray), {}, {}};
        result.uv = uv(point);
        const auto by_x = uv_change(point, moved(ray_dx)), by_y = uv_change(point, moved(ray_dy));
        result.derivatives = {by_x.u, by_x.v, by_y.u, by_y.v};
        return result;
    }

  private:
    static constexpr float pi = 3.14159265358979F;

    /// Sphere: u = phi / 2 pi with the seam behind, v = (1 - cos theta) / 2. Plane: world x and -z.
    mica::uv_point<float> uv(mica::vector3<float> p) const {
        if (what_ == shape::sphere) return {std::atan2(p.x, p.z) / (2 * pi) + 0.5F, (1 - p.y) / 2};
        const float unit = std::sqrt(4 * pi);
        return {p.x / unit, -p.z / unit};
    }

    /// The change of uv when the point moves.
    mica::uv_point<float> uv_change(mica::vector3<float> p, mica::vector3<float> by) const {
        if (what_ == shape::sphere) return {(p.z * by.x - p.x * by.z) / (p.x * p.x + p.z * p.z) / (2 * pi), -by.y / 2};
        return uv(by);
    }

    shape what_;
    std::size_t width_, height_;
    mica::vector3<float> eye_, forward_, up_;
    float step_; ///< from pixel to pixel, at distance 1
};

/// An environment without a file: a dusk sky over dark ground, a small sun, and three lamps of different size, colour
/// and strength. Its brightest texel is 3000 times brighter than its sky.
inline mica::environment_map procedural_environment() {
    constexpr std::size_t width = 512, height = 256;
    struct lamp {
        mica::vector3<float> towards;
        float half_angle; ///< radians
        mica::rgb<float> radiance;
    };
    const lamp lamps[] = {{{0.55F, 0.6F, 0.6F}, 0.035F, {900, 780, 600}}, // sun, front right
                          {{-0.75F, 0.55F, 0.5F}, 0.22F, {18, 20, 24}},   // soft box, front left
                          {{0.9F, 0.1F, -0.35F}, 0.12F, {30, 17, 8}},     // warm lamp, right, behind
                          {{-0.5F, -0.1F, -0.85F}, 0.1F, {6, 12, 30}}};   // cool lamp, left, behind
    std::vector<mica::rgb<float>> texels;
    texels.reserve(width * height);
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const auto w =
                mica::direction_of({(static_cast<float>(x) + 0.5F) / width, (static_cast<float>(y) + 0.5F) / height});
            const float horizon = std::exp(-6 * std::abs(w.y));
            mica::rgb<float> radiance =
                w.y > 0 ? mica::rgb<float>{0.10F, 0.16F, 0.30F} + horizon * mica::rgb<float>{0.5F, 0.35F, 0.2F}
                        : mica::rgb<float>{0.05F, 0.045F, 0.04F} + horizon * mica::rgb<float>{0.1F, 0.08F, 0.06F};
            for (const auto& lamp : lamps) {
                const float cosine = dot(w, mica::normalized(lamp.towards));
                // A smooth edge, a tenth of the lamp wide.
                const float edge =
                    (lamp.half_angle - std::acos(mica::clamp(cosine, -1.F, 1.F))) / (0.1F * lamp.half_angle);
                radiance = radiance + mica::clamp(edge, 0.F, 1.F) * lamp.radiance;
            }
            texels.push_back(radiance);
        }
    return mica::environment_map(width, height, std::move(texels));
}

/// The white furnace: radiance 1 from everywhere.
inline mica::environment_map white_environment() {
    constexpr std::size_t width = 64, height = 32;
    return mica::environment_map(width, height, std::vector<mica::rgb<float>>(width * height, {1, 1, 1}));
}

} // namespace glint
