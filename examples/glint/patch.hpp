// A flat patch of glints without light: what one footprint holds, by each of the ways to count it.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include <mica/grid/distributed.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/reference/facets.hpp>
#include <tbb/parallel_for.h>

#include "picture.hpp"

namespace glint {

/// A footprint in a patch that is one unit of uv wide: `ratio` times as long as wide, turned by `turn` half turns, its
/// level `level` (2^level uv) where the footprint scale is 1.
struct patch_footprint {
    double ratio, turn, level;

    template <class Real>
    mica::uv_derivatives<Real> derivatives() const {
        const double width = std::exp2(level), c = std::cos(std::numbers::pi * turn),
                     s = std::sin(std::numbers::pi * turn);
        const auto number = [](double x) { return Real(static_cast<float>(x)); };
        return {number(ratio * width * c), number(ratio * width * s), number(-width * s), number(width * c)};
    }

    double area() const { return ratio * std::exp2(2 * level); }
};

/// Counts at a place of a patch of one seed.
template <class Law, class Interpolation>
struct distributed_patch {
    patch_footprint shape;
    float footprint_scale;
    Interpolation interpolation;

    template <class Real>
    Real operator()(mica::uv_point<Real> uv, Real trials, Real probability, std::uint32_t seed) const {
        const auto footprint = mica::make_footprint(shape.derivatives<Real>());
        const auto vertices = mica::make_grid_vertices(footprint, uv, trials, seed, Real(footprint_scale));
        return mica::distributed_binomial<Law, Interpolation>{interpolation}(vertices, probability);
    }
    static constexpr std::size_t evaluations = Interpolation::template evaluations<mica::grid_vertices<float>>;
};

/// Draws grey(x, y), linear, for size x size pixels, each `enlarged` pixels wide; rows side by side.
template <class Grey>
void draw_patch(srgb_picture& picture, std::size_t left, std::size_t top, std::size_t size, std::size_t enlarged,
                float exposure, const Grey& grey) {
    const std::size_t side = size * enlarged;
    radiance_picture values{side, side, std::vector<mica::rgb<float>>(side * side)};
    tbb::parallel_for(std::size_t{0}, size, [&](std::size_t y) {
        for (std::size_t x = 0; x < size; ++x) {
            const float value = grey(static_cast<double>(x), static_cast<double>(y));
            for (std::size_t j = 0; j < enlarged; ++j)
                for (std::size_t i = 0; i < enlarged; ++i)
                    values.pixels[(enlarged * y + j) * side + enlarged * x + i] = {value, value, value};
        }
    });
    tone_map(values, exposure, picture, left, top);
}

} // namespace glint
