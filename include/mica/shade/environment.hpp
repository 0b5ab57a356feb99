// mica/shade/environment.hpp: an environment map, and its partition into K brightness levels.
//
// Host only: maps allocate.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "vector.hpp"

namespace mica {

/// A point of an equirectangular map: u in [0,1) from left to right, v in [0,1] from top to bottom.
struct equirect_point {
    float u; ///< from left to right
    float v; ///< from top to bottom
};

/// The point of the map in direction w: +y is the top, -z the middle, +x right of it. w of length 1.
inline equirect_point equirect_of(vector3<float> w) {
    constexpr float pi = 3.14159265358979F;
    const float u = std::atan2(w.x, -w.z) / (2 * pi) + 0.5F;
    return {u < 1 ? u : 0.F, std::acos(clamp(w.y, -1.F, 1.F)) / pi};
}

/// The direction of a point of the map.
inline vector3<float> direction_of(equirect_point point) {
    constexpr float pi = 3.14159265358979F;
    const float azimuth = 2 * pi * (point.u - 0.5F), polar = pi * point.v;
    return {std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth)};
}

/// A grid of texels over the sphere, row 0 at the top; texel (x, y) is centred at ((x+1/2)/width, (y+1/2)/height).
template <class Texel>
struct equirect_image {
    std::size_t width = 0;     ///< in texels
    std::size_t height = 0;    ///< in texels
    std::vector<Texel> texels; ///< width * height, row by row

    /// Column x, row y.
    const Texel& at(std::size_t x, std::size_t y) const { return texels[y * width + x]; }

    /// A texel near a direction. Beyond a pole lies the same row, half way round.
    struct tap {
        std::size_t index; ///< in texels
        float weight;      ///< bilinear, >= 0
    };
    /// The four texels around direction w, of length 1; their weights sum to 1.
    std::array<tap, 4> taps(vector3<float> w) const {
        const equirect_point point = equirect_of(w);
        const float x = point.u * static_cast<float>(width) - 0.5F, y = point.v * static_cast<float>(height) - 0.5F;
        const float x0 = std::floor(x), y0 = std::floor(y);
        const float fx = x - x0, fy = y - y0;
        const auto index = [this](float column, float row) {
            const bool beyond_pole = row < 0 || row > static_cast<float>(height - 1);
            const std::size_t i = column < 0 ? width - 1 : static_cast<std::size_t>(column);
            const std::size_t j = row < 0 ? 0 : (std::min)(static_cast<std::size_t>(row), height - 1);
            return j * width + (beyond_pole ? i + width / 2 : i) % width;
        };
        return {{{index(x0, y0), (1 - fx) * (1 - fy)},
                 {index(x0 + 1, y0), fx * (1 - fy)},
                 {index(x0, y0 + 1), (1 - fx) * fy},
                 {index(x0 + 1, y0 + 1), fx * fy}}};
    }
};

/// Solid angle of a texel of row y, in steradians.
inline double texel_solid_angle(std::size_t width, std::size_t height, std::size_t y) {
    constexpr double pi = 3.14159265358979323846;
    const double top = std::cos(pi * static_cast<double>(y) / static_cast<double>(height));
    const double bottom = std::cos(pi * static_cast<double>(y + 1) / static_cast<double>(height));
    return 2 * pi / static_cast<double>(width) * (top - bottom);
}

/// Radiance from every direction.
class environment_map {
  public:
    /// texels: width * height, linear radiance, >= 0 (more than 1e30, infinity too, counts as 1e30).
    /// Fails (std::invalid_argument) on an empty map, a wrong number of texels, a negative or NaN radiance.
    environment_map(std::size_t width, std::size_t height, std::vector<rgb<float>> texels)
        : image_{width, height, std::move(texels)} {
        if (width == 0) MICA_FAIL("width", width, "positive");
        if (height == 0) MICA_FAIL("height", height, "positive");
        if (image_.texels.size() / width != height || image_.texels.size() % width != 0)
            MICA_FAIL("number of texels", image_.texels.size(), "width * height");
        for (auto& texel : image_.texels)
            for (float* band : {&texel.r, &texel.g, &texel.b}) {
                if (is_nan(*band) || *band < 0) MICA_FAIL("radiance", *band, ">= 0");
                *band = minimum(*band, 1e30F);
            }
    }

    /// The texels.
    const equirect_image<rgb<float>>& image() const { return image_; }

    /// Radiance from direction w, bilinear.
    rgb<float> operator()(vector3<float> w) const {
        rgb<float> sum{0, 0, 0};
        for (const auto& tap : image_.taps(w)) sum = sum + tap.weight * image_.texels[tap.index];
        return sum;
    }

  private:
    equirect_image<rgb<float>> image_;
};

namespace detail {

/// The least and the greatest luminance of a map.
inline std::pair<float, float> luminance_range(const environment_map& map) {
    float lowest = std::numeric_limits<float>::max(), highest = 0;
    for (const auto& texel : map.image().texels) {
        lowest = minimum(lowest, luminance(texel));
        highest = maximum(highest, luminance(texel));
    }
    return {lowest, highest};
}

} // namespace detail

/// K levels of luminance and the fuzzy indicators that assign every luminance to its two neighbours (KK25 Sec. 5,
/// Eq. 18 and 19):
///
///     L_1 = 0,  L_k = exp(lerp(log min, log max, (k-1)/(K-1))),   sum_k w_k(L) = 1,  sum_k L_k w_k(L) = L
///
/// w is piecewise linear in linear luminance. The dimmest level has no radiance: it also stands for the facets that
/// reflect nothing. A constant environment (Eq. 19 is 0/0 there) is all of the top level, a black one all of level 1.
template <std::size_t K>
class environment_levels {
    static_assert(K >= 2, "an environment needs at least two levels, one of them dark");

  public:
    /// `floor` > 0, as published in [1e-5, 1e-2], keeps levels from being spent on the dark: the luminance minimum
    /// counts as at least it.
    explicit environment_levels(const environment_map& map, float floor = 1e-3F) {
        if (!(floor > 0)) MICA_FAIL("floor", floor, "positive");
        const auto [darkest, highest] = detail::luminance_range(map);
        const float lowest = minimum(maximum(darkest, floor), highest);
        radiance_[K - 1] = highest; // itself, not exp(log(highest)): the brightest texel is exactly the top level
        if (!(highest > 0)) return;
        for (std::size_t k = 1; k + 1 < K; ++k) {
            const double part = static_cast<double>(k) / (K - 1);
            const double logarithm =
                (1 - part) * std::log(static_cast<double>(lowest)) + part * std::log(static_cast<double>(highest));
            radiance_[k] = minimum(static_cast<float>(std::exp(logarithm)), highest);
        }
    }

    /// L_1 = 0 .. L_K, ascending.
    const std::array<float, K>& radiance() const { return radiance_; }

    /// w_1 .. w_K for a luminance >= 0; one beyond the top level is of the top level.
    std::array<float, K> indicators(float luminance) const {
        std::array<float, K> w{};
        if (luminance >= radiance_[K - 1]) {
            w[radiance_[K - 1] > 0 ? K - 1 : 0] = 1;
            return w;
        }
        std::size_t above = 1;
        while (luminance >= radiance_[above]) ++above; // ends: luminance < radiance_[K - 1]
        w[above] = (luminance - radiance_[above - 1]) / (radiance_[above] - radiance_[above - 1]);
        w[above - 1] = 1 - w[above];
        return w;
    }

  private:
    std::array<float, K> radiance_{};
};

} // namespace mica
