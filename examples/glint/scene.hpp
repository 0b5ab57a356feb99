// What there is to see: a sphere or a plane, a camera in front of it, and an environment that needs no file.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <mica/shade/environment.hpp>

#include "description.hpp"

namespace glint {

/// A pinhole camera and the surfaces in front of it. One uv unit square is the area of the unit sphere, 4 pi, on every
/// shape, so that a density means the same.
class scene {
  public:
    /// A point that a pixel sees, and on which surface.
    struct hit {
        mica::shading_point<float> point;
        std::size_t surface;
    };

    scene(const camera_description& camera, std::vector<surface_description> surfaces, std::size_t width,
          std::size_t height)
        : surfaces_(std::move(surfaces)), width_(width), height_(height), eye_(camera.eye),
          forward_(mica::normalized(camera.target - camera.eye)) {
        const vector side = mica::cross(forward_, {0, 1, 0});
        right_ = dot(side, side) > 0 ? mica::normalized(side) : vector{1, 0, 0}; // looking straight up or down
        up_ = mica::cross(right_, forward_);
        step_ = 2 * std::tan(camera.field_of_view / 2) / static_cast<float>((std::min)(width, height));
    }

    std::size_t width() const { return width_; }
    std::size_t height() const { return height_; }
    const std::vector<surface_description>& surfaces() const { return surfaces_; }

    /// The surface seen through the middle of a pixel, with the derivatives of its uv by the pixel, analytic: the ray
    /// moves on the tangent plane, dP/dx = t (dD - D (n.dD) / (n.D)) for the ray direction D (Igehy 1999).
    std::optional<hit> surface(std::size_t x, std::size_t y) const {
        const float right = step_ * (static_cast<float>(x) + 0.5F - static_cast<float>(width_) / 2);
        const float above = step_ * (static_cast<float>(height_) / 2 - static_cast<float>(y) - 0.5F);
        const vector ray = forward_ + right * right_ + above * up_;

        float t = std::numeric_limits<float>::infinity();
        std::size_t nearest = surfaces_.size();
        for (std::size_t i = 0; i < surfaces_.size(); ++i) {
            const auto distance = distance_to(surfaces_[i], ray);
            if (distance && *distance < t) {
                t = *distance;
                nearest = i;
            }
        }
        if (nearest == surfaces_.size()) return std::nullopt;

        const surface_description& seen = surfaces_[nearest];
        const bool sphere = seen.shape == "sphere";
        hit result{{}, nearest};
        auto& point = result.point;
        point.position = eye_ + t * ray;
        const vector from_centre = (1 / seen.radius) * (point.position - seen.centre);
        point.normal = sphere ? mica::normalized(from_centre) : vector{0, 1, 0};
        point.wo = mica::normalized(-1.F * ray);
        point.tangent = sphere ? tangent_of(point.normal) : vector{1, 0, 0};
        point.uv = sphere ? uv_of_sphere(from_centre) : uv_of_plane(point.position - seen.centre);
        const auto moved = [&](vector ray_derivative) {
            const vector by = t * (ray_derivative - (dot(point.normal, ray_derivative) / dot(point.normal, ray)) * ray);
            return sphere ? uv_change_of_sphere(from_centre, (1 / seen.radius) * by) : uv_of_plane(by);
        };
        const auto by_x = moved(step_ * right_), by_y = moved(-step_ * up_);
        point.derivatives = {by_x.u, by_x.v, by_y.u, by_y.v};
        return result;
    }

  private:
    static constexpr float pi = std::numbers::pi_v<float>;

    std::optional<float> distance_to(const surface_description& surface, vector ray) const {
        const vector from = eye_ - surface.centre;
        if (surface.shape != "sphere") {
            const float t = -from.y / ray.y;
            return ray.y < 0 && t > 0 ? std::optional(t) : std::nullopt;
        }
        const float a = dot(ray, ray), b = dot(from, ray), c = dot(from, from) - surface.radius * surface.radius;
        const float discriminant = b * b - a * c;
        if (!(discriminant > 0)) return std::nullopt;
        const float t = (-b - std::sqrt(discriminant)) / a;
        return t > 0 ? std::optional(t) : std::nullopt;
    }

    /// Towards growing u.
    static vector tangent_of(vector normal) {
        const vector around{normal.z, 0, -normal.x};
        return dot(around, around) > 1e-12F ? mica::normalized(around) : vector{1, 0, 0};
    }

    /// Sphere: u = phi / 2 pi with the seam behind, v = (1 - cos theta) / 2. Plane: world x and -z.
    static mica::uv_point<float> uv_of_sphere(vector p) {
        return {std::atan2(p.x, p.z) / (2 * pi) + 0.5F, (1 - p.y) / 2};
    }
    static mica::uv_point<float> uv_of_plane(vector p) {
        const float unit = std::sqrt(4 * pi);
        return {p.x / unit, -p.z / unit};
    }

    /// The change of uv when a point of the unit sphere moves.
    static mica::uv_point<float> uv_change_of_sphere(vector p, vector by) {
        return {(p.z * by.x - p.x * by.z) / (p.x * p.x + p.z * p.z) / (2 * pi), -by.y / 2};
    }

    std::vector<surface_description> surfaces_;
    std::size_t width_, height_;
    vector eye_, forward_, right_, up_;
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

/// Three lamps of 2.5 degrees half angle, red, green and blue of equal luminance, so many degrees apart above the camera.
inline mica::environment_map lamps_environment(float degrees_apart) {
    constexpr std::size_t width = 1024, height = 512;
    constexpr float pi = std::numbers::pi_v<float>;
    const vector middle = mica::normalized(vector{0, 0.45F, 1}), right{1, 0, 0}, above = mica::cross(middle, right);
    // At the corners of an equilateral triangle, whose sides are seen under the angle.
    const float from_middle = std::asin(std::sin(degrees_apart / degrees_per_radian / 2) / std::sin(pi / 3));
    std::array<vector, 3> lamps;
    for (std::size_t i = 0; i < 3; ++i) {
        const float turn = pi / 2 + static_cast<float>(i) * 2 * pi / 3;
        lamps[i] =
            std::cos(from_middle) * middle + std::sin(from_middle) * (std::cos(turn) * right + std::sin(turn) * above);
    }
    const colour colours[] = {{3.2F, 0.3F, 0.3F}, {0.3F, 1.25F, 0.3F}, {0.6F, 0.6F, 6.1F}};
    std::vector<colour> texels;
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const vector w =
                mica::direction_of({(static_cast<float>(x) + 0.5F) / width, (static_cast<float>(y) + 0.5F) / height});
            colour radiance{0.01F, 0.01F, 0.01F};
            for (std::size_t i = 0; i < 3; ++i)
                if (dot(w, lamps[i]) > std::cos(2.5F / degrees_per_radian))
                    radiance = (300 / luminance(colours[i])) * colours[i];
            texels.push_back(radiance);
        }
    return mica::environment_map(width, height, std::move(texels));
}

} // namespace glint
