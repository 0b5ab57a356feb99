// examples/gpu/view.hpp: what a pixel sees, on either processor: the unit sphere as `glint render` draws it, or a plane that
// fills the picture, as published timings have it.
#pragma once

#include <cmath>

#include <mica/shade/glint_kernel.hpp>

/// A camera before one of the two surfaces.
struct view {
    bool sphere;     ///< or the plane
    unsigned width;  ///< of the picture, in pixels
    unsigned height; ///< of the picture, in pixels

    using vector = mica::vector3<float>; ///< in the scene
    /// What a pixel sees.
    struct hit {
        bool seen;                        ///< whether it is the surface
        mica::shading_point<float> point; ///< where
    };

    /// The surface through the middle of pixel (x, y), with the analytic derivatives of uv by the pixel (Igehy 1999), as in
    /// examples/glint/scene.hpp. One unit of uv^2 is the area of the sphere.
    MICA_HOST_DEVICE hit operator()(unsigned x, unsigned y) const {
        // From (0, 0, 4) towards the middle of the sphere; from 1.2 above the plane, half a right angle down.
        const float slope = std::sqrt(0.5F);
        const vector eye = sphere ? vector{0, 0, 4} : vector{0, 1.2F, 0};
        const vector forward = sphere ? vector{0, 0, -1} : vector{0, -slope, -slope};
        const vector right{1, 0, 0}, up = sphere ? vector{0, 1, 0} : vector{0, slope, -slope};
        const float smaller = static_cast<float>(width < height ? width : height);
        const float step =
            2 * std::tan((sphere ? 0.546F : 0.8456F) / 2) / smaller; // from pixel to pixel, at distance 1
        const float across = step * (static_cast<float>(x) + 0.5F - static_cast<float>(width) / 2);
        const float above = step * (static_cast<float>(height) / 2 - static_cast<float>(y) - 0.5F);
        const vector ray = forward + across * right + above * up;

        hit result{};
        float t = -eye.y / ray.y;
        if (sphere) {
            const float a = dot(ray, ray), b = dot(eye, ray), c = dot(eye, eye) - 1;
            const float discriminant = b * b - a * c;
            if (!(discriminant > 0)) return result;
            t = (-b - std::sqrt(discriminant)) / a;
        }
        result.seen = true;
        auto& point = result.point;
        point.position = eye + t * ray;
        const vector p = point.position;
        point.normal = sphere ? mica::normalized(p) : vector{0, 1, 0};
        point.tangent = sphere ? mica::normalized(vector{p.z, 0, -p.x}) : vector{1, 0, 0};
        point.wo = mica::normalized(-1.F * ray);
        point.uv = sphere ? mica::uv_point<float>{std::atan2(p.x, p.z) / (2 * pi) + 0.5F, (1 - p.y) / 2} : on_plane(p);
        const mica::uv_point<float> by_x = moved(point, ray, t, step * right), by_y = moved(point, ray, t, -step * up);
        point.derivatives = {by_x.u, by_x.v, by_y.u, by_y.v};
        return result;
    }

  private:
    static constexpr float pi = 3.14159265F;

    MICA_HOST_DEVICE static mica::uv_point<float> on_plane(vector p) {
        const float unit = std::sqrt(4 * pi);
        return {p.x / unit, -p.z / unit};
    }

    /// The change of uv when the ray changes by so much.
    MICA_HOST_DEVICE mica::uv_point<float> moved(const mica::shading_point<float>& point, vector ray, float t,
                                                 vector change) const {
        const vector p = point.position;
        const vector by = t * (change - (dot(point.normal, change) / dot(point.normal, ray)) * ray);
        if (!sphere) return on_plane(by);
        return {(p.z * by.x - p.x * by.z) / (p.x * p.x + p.z * p.z) / (2 * pi), -by.y / 2};
    }
};
