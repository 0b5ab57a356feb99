// mica/shade/prefilter.hpp: an environment and its level indicators, filtered by the GGX lobe of a roughness.
//
//     prefilter(f)(r) = sum f(l) D(h) n.l dOmega / sum D(h) n.l dOmega,   n = wo = r, h half-way between r and l
//
// the split-sum kernel of image-based lighting (Karis 2013), the same for radiance and indicators (KK25 Eq. 11, 21),
// so that sum_k L_k prefilter(w_k) = prefilter(L) to rounding.
//
// Method: the sum runs over all texels of the full-resolution map, with what is far from the lobe's centre, compared
// to the distance over which the kernel changes, taken together in blocks of 2 x 2, 4 x 4, ... texels. Nothing is
// sampled, so a small sun leaves neither noise nor squares, and the indicators are those of the texels, not of a
// downsampled map, which would lose it. Deterministic. Largest error against the plain sum of a map with a one-texel
// sun 1e5 times brighter than the rest: 2 % of the largest filtered value, 3 % with the bilinear interpolation of the
// result (tests/environment_test.cpp, roughness 0.05 to 1). Channels are float: 8 bits are not enough (KK25 Fig. 9).
//
// Host only: it allocates.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "environment_classes.hpp"
#include "microfacet.hpp"

namespace mica {

/// Runs body(0) .. body(count - 1) one after the other. Anything that may run them side by side can take its place.
struct serial_loop {
    /// One after the other.
    template <class Body>
    void operator()(std::size_t count, const Body& body) const {
        for (std::size_t i = 0; i < count; ++i) body(i);
    }
};

namespace detail {

/// A map and its blocks of 2^m x 2^m texels, m = 0, 1, ...: mean of each channel, direction and solid angle. The first
/// `Radiance` channels add up to the light of a texel.
template <std::size_t Channels, std::size_t Radiance>
class texel_pyramid {
  public:
    using value_type = std::array<float, Channels>;

    texel_pyramid(std::size_t width, std::size_t height, const std::vector<value_type>& values) {
        layer base{1, width, height, {}, {}};
        base.blocks.reserve(width * height);
        for (std::size_t y = 0; y < height; ++y) {
            const auto solid_angle = static_cast<float>(texel_solid_angle(width, height, y));
            const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(height);
            for (std::size_t x = 0; x < width; ++x) {
                const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(width);
                base.blocks.push_back({values[y * width + x], direction_of({u, v}), solid_angle});
            }
        }
        double light = 0, solid_angle = 0;
        for (const block& b : base.blocks) {
            light += static_cast<double>(b.solid_angle) * light_of(b);
            solid_angle += static_cast<double>(b.solid_angle);
        }
        ambient_ = light > 0 ? light / solid_angle : 1;
        layers_.push_back(std::move(base));
        while (layers_.back().width > 1 || layers_.back().height > 1) layers_.push_back(merged(layers_.back()));
        for (layer& blocks : layers_)
            for (std::size_t y = 0; y < blocks.height; ++y)
                blocks.radius.push_back(radius_of(blocks, y, width, height));
    }

    /// sum f D n.l dOmega / sum D n.l dOmega around r. A block is small against the kernel when its radius is below
    /// `fineness` times the kernel's scale and below `widest`, radians, for the cosine.
    value_type filtered(vector3<float> r, float alpha, float fineness, float widest) const {
        struct place {
            std::size_t layer, x, y;
        };
        std::array<place, 128> stack; // depth first: at most three waiting per layer
        std::size_t waiting = 0;
        stack[waiting++] = {layers_.size() - 1, 0, 0};
        value_type sum{};
        float total = 0;
        while (waiting > 0) {
            const place at = stack[--waiting];
            const layer& blocks = layers_[at.layer];
            const block& b = blocks.blocks[at.y * blocks.width + at.x];
            const float cosine = clamp(dot(r, b.direction), -1.F, 1.F);
            const float radius = blocks.radius[at.y];
            if (cosine < -2 * radius) continue; // all below the horizon, wherever in the block its light is
            // theta, half the angle between r and the block, is that between n and h:
            // D = alpha^2 / (pi q^2), q = sin^2 + alpha^2 cos^2, and it changes over
            // 2 sqrt(alpha^2 + tan^2) = 2 sqrt(q) / cos.
            const float cos_square = (1 + cosine) / 2;
            const float q = 1 - cos_square + alpha * alpha * cos_square;
            const bool small = radius < widest && radius * radius * cos_square < 4 * fineness * fineness * q;
            if (at.layer == 0 || small) {
                if (cosine <= 0) continue;
                const float weight = cosine * b.solid_angle / (q * q); // alpha^2 / pi is in both sums
                for (std::size_t c = 0; c < Channels; ++c) sum[c] += weight * b.mean[c];
                total += weight;
            } else {
                const layer& finer = layers_[at.layer - 1];
                for (std::size_t y = 2 * at.y; y < (std::min)(2 * at.y + 2, finer.height); ++y)
                    for (std::size_t x = 2 * at.x; x < (std::min)(2 * at.x + 2, finer.width); ++x)
                        stack[waiting++] = {at.layer - 1, x, y};
            }
        }
        if (!(total > 0))
            return layers_.back().blocks.front().mean; // a map so coarse that no texel is above the horizon
        for (float& channel : sum) channel /= total;
        return sum;
    }

  private:
    struct block {
        value_type mean;
        vector3<float> direction; ///< of its light, so that a small sun stays where it is in blocks of any size
        float solid_angle;
    };
    struct layer {
        std::size_t side; ///< of a block, in texels; less at the right and lower edge of the map
        std::size_t width, height;
        std::vector<block> blocks;
        std::vector<float> radius; ///< of the blocks of each row: angle from the middle to the farthest corner
    };

    static double light_of(const block& b) {
        double sum = 0;
        for (std::size_t c = 0; c < Radiance; ++c) sum += static_cast<double>(b.mean[c]);
        return sum;
    }

    /// What a block's direction is weighted by: its light over that of the mean texel, and 1 for the dark ones.
    double brightness(const block& b) const { return light_of(b) / ambient_ + 1; }

    layer merged(const layer& finer) const {
        layer result{2 * finer.side, (finer.width + 1) / 2, (finer.height + 1) / 2, {}, {}};
        result.blocks.reserve(result.width * result.height);
        for (std::size_t y = 0; y < result.height; ++y)
            for (std::size_t x = 0; x < result.width; ++x) {
                block sum{{}, {0, 0, 0}, 0};
                vector3<double> direction{0, 0, 0};
                std::array<double, Channels> mean{};
                for (std::size_t j = 2 * y; j < (std::min)(2 * y + 2, finer.height); ++j)
                    for (std::size_t i = 2 * x; i < (std::min)(2 * x + 2, finer.width); ++i) {
                        const block& part = finer.blocks[j * finer.width + i];
                        for (std::size_t c = 0; c < Channels; ++c)
                            mean[c] += static_cast<double>(part.solid_angle) * static_cast<double>(part.mean[c]);
                        const vector3<double> towards{static_cast<double>(part.direction.x),
                                                      static_cast<double>(part.direction.y),
                                                      static_cast<double>(part.direction.z)};
                        direction = direction + static_cast<double>(part.solid_angle) * brightness(part) * towards;
                        sum.solid_angle += part.solid_angle;
                    }
                for (std::size_t c = 0; c < Channels; ++c)
                    sum.mean[c] = static_cast<float>(mean[c] / static_cast<double>(sum.solid_angle));
                // Blocks around the whole sphere have no middle; they are never small enough to be used.
                if (dot(direction, direction) > 0) {
                    const vector3<double> unit = normalized(direction);
                    sum.direction = {static_cast<float>(unit.x), static_cast<float>(unit.y),
                                     static_cast<float>(unit.z)};
                }
                result.blocks.push_back(sum);
            }
        return result;
    }

    /// The radius of the blocks of row y.
    static float radius_of(const layer& blocks, std::size_t y, std::size_t width, std::size_t height) {
        constexpr float pi = 3.14159265358979F;
        if (4 * blocks.side > width) return pi; // a quarter turn and more: corners are not the farthest points
        const float right = static_cast<float>(blocks.side) / static_cast<float>(width);
        const float top = static_cast<float>(y * blocks.side) / static_cast<float>(height);
        const float bottom = static_cast<float>((std::min)((y + 1) * blocks.side, height)) / static_cast<float>(height);
        const vector3<float> middle = direction_of({right / 2, (top + bottom) / 2});
        // Left corners are as far away as right ones.
        const float cosine =
            minimum(dot(middle, direction_of({right, top})), dot(middle, direction_of({right, bottom})));
        return std::acos(clamp(cosine, -1.F, 1.F));
    }

    std::vector<layer> layers_;
    double ambient_ = 1; ///< light of the mean texel
};

} // namespace detail

/// How finely an environment is filtered: the time it takes and its error.
struct prefilter_quality {
    std::size_t most_columns = 1024; ///< of a filtered map, twice as many as rows
    float texels_per_roughness = 3;  ///< of it; two leave 4 % of the lobe's peak to the bilinear interpolation
    float fineness = 0.3F;           ///< radius of what is taken together, over the scale on which the lobe changes
    float widest = 0.12F;            ///< and at most so many radians
};

/// For environments that change from frame to frame: the classes and one filtered map of K = 4, from 128 x 64 texels, take
/// 3.6 ms of one core, a fortieth of what the defaults take from 1024 x 512 (mica_benchmark_avx2, prefilter/). Error against
/// those, the largest found over 96 places of a small sun: 19 % of the largest radiance at roughness 0.16, 7 % at 0.3, 2 % at
/// 0.6, half of it for the coarse result and half for the coarse blocks; of shares 0.06, 0.025 and 0.01, for the smaller map
/// (tests/classes_test.cpp holds it at six places).
inline constexpr prefilter_quality every_frame{48, 2, 0.6F, 0.25F};

namespace detail {

/// Maps of so many channels, filtered for a set of roughnesses. The first `Radiance` channels add up to the light.
template <std::size_t Channels, std::size_t Radiance>
class filtered_maps {
  public:
    using value_type = std::array<float, Channels>;

    template <class Loop>
    filtered_maps(std::size_t width, std::size_t height, const std::vector<value_type>& values,
                  std::span<const float> roughnesses, const Loop& loop, const prefilter_quality& quality) {
        if (roughnesses.empty()) MICA_FAIL("number of roughnesses", 0, "positive");
        const texel_pyramid<Channels, Radiance> pyramid(width, height, values);
        for (const float roughness : roughnesses) {
            if (!(roughness >= 0)) MICA_FAIL("roughness", roughness, ">= 0");
            if (!maps_.empty() && !(roughness > maps_.back().roughness))
                MICA_FAIL("roughness", roughness, "greater than the one before it");
            maps_.push_back({roughness, narrower_than_a_texel(roughness, height)
                                            ? image_type{width, height, values}
                                            : filtered(pyramid, roughness, loop, quality)});
        }
    }

    /// Between the given roughnesses linear in perceptual roughness, beyond them the nearest.
    value_type operator()(vector3<float> r, float roughness) const {
        std::size_t upper = 0;
        while (upper + 1 < maps_.size() && maps_[upper].roughness < roughness) ++upper;
        const std::size_t lower = upper == 0 || roughness >= maps_[upper].roughness ? upper : upper - 1;
        value_type value{};
        if (lower == upper) {
            add(value, maps_[upper].image, r, 1);
        } else {
            const float low = std::sqrt(maps_[lower].roughness), high = std::sqrt(maps_[upper].roughness);
            const float part = (std::sqrt(roughness) - low) / (high - low);
            add(value, maps_[lower].image, r, 1 - part);
            add(value, maps_[upper].image, r, part);
        }
        return value;
    }

  private:
    using image_type = equirect_image<value_type>;
    struct filtered_map {
        float roughness;
        image_type image;
    };
    static constexpr float pi = 3.14159265358979F;

    static bool narrower_than_a_texel(float roughness, std::size_t height) {
        return 2 * roughness < pi / static_cast<float>(height);
    }

    template <class Loop>
    static image_type filtered(const texel_pyramid<Channels, Radiance>& pyramid, float roughness, const Loop& loop,
                               const prefilter_quality& quality) {
        // The lobe's half width at half height is 1.3 roughness.
        const auto wanted = static_cast<std::size_t>(quality.texels_per_roughness * std::ceil(2 * pi / roughness));
        image_type result;
        result.width = std::clamp(wanted, (std::min)(std::size_t{64}, quality.most_columns), quality.most_columns);
        result.height = (std::max)(result.width / 2, std::size_t{1});
        result.texels.resize(result.width * result.height);
        loop(result.height, [&](std::size_t y) {
            const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(result.height);
            for (std::size_t x = 0; x < result.width; ++x) {
                const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(result.width);
                result.texels[y * result.width + x] =
                    pyramid.filtered(direction_of({u, v}), roughness, quality.fineness, quality.widest);
            }
        });
        return result;
    }

    static void add(value_type& sum, const image_type& image, vector3<float> r, float weight) {
        for (const auto& tap : image.taps(r))
            for (std::size_t c = 0; c < Channels; ++c) sum[c] += weight * tap.weight * image.texels[tap.index][c];
    }

    std::vector<filtered_map> maps_;
};

} // namespace detail

/// Radiance and the K level indicators of an environment, filtered for a set of roughnesses.
template <std::size_t K>
class prefiltered_environment {
  public:
    /// What the lobe around a direction sees.
    struct sample {
        /// The radiance of the lobe.
        rgb<float> radiance;
        std::array<float, K> indicator; ///< >= 0, sum 1
    };

    /// roughnesses: ascending, each >= 0, at least one; those whose lobe is narrower than a texel (and 0, the mirror)
    /// use the map as it is. `loop` runs the rows of the result, serially unless told otherwise.
    template <class Loop = serial_loop>
    prefiltered_environment(const environment_map& map, const environment_levels<K>& levels,
                            std::span<const float> roughnesses, const Loop& loop = {},
                            const prefilter_quality& quality = {})
        : levels_(levels),
          maps_(map.image().width, map.image().height, values_of(map, levels), roughnesses, loop, quality) {}

    /// The levels that the indicators are of.
    const environment_levels<K>& levels() const { return levels_; }

    /// The lobe of a roughness around direction r; between the given roughnesses linear in perceptual roughness,
    /// beyond them the nearest.
    sample operator()(vector3<float> r, float roughness) const {
        const auto value = maps_(r, roughness);
        sample result{{value[0], value[1], value[2]}, {}};
        std::copy(value.begin() + bands, value.end(), result.indicator.begin());
        return result;
    }

  private:
    static constexpr std::size_t bands = 3;
    using maps_type = detail::filtered_maps<bands + K, bands>;

    static std::vector<typename maps_type::value_type> values_of(const environment_map& map,
                                                                 const environment_levels<K>& levels) {
        std::vector<typename maps_type::value_type> values;
        values.reserve(map.image().texels.size());
        for (const auto& texel : map.image().texels) {
            auto& value = values.emplace_back(typename maps_type::value_type{texel.r, texel.g, texel.b});
            const auto indicators = levels.indicators(luminance(texel));
            std::copy(indicators.begin(), indicators.end(), value.begin() + bands);
        }
        return values;
    }

    environment_levels<K> levels_;
    maps_type maps_;
};

/// Nothing occludes the environment.
struct all_visible {
    /// All of every direction.
    float operator()(vector3<float>) const { return 1; }
};

/// The K classes of an environment, filtered for a set of roughnesses: what each shines with in a lobe, in colour, and how
/// much of the lobe shows it.
template <std::size_t K>
class prefiltered_classes {
  public:
    /// What the lobe around a direction sees.
    struct sample {
        std::array<rgb<float>, K> radiance; ///< of each class; their sum is the radiance of the lobe
        std::array<float, K> share;         ///< >= 0, sum 1; less where something occludes the environment
    };

    /// roughnesses and loop as for prefiltered_environment. visible(direction), in [0, 1], is what an occluder leaves of each
    /// texel: what it hides has no radiance and no share.
    template <class Visible = all_visible, class Loop = serial_loop>
    prefiltered_classes(const environment_map& map, const environment_classes<K>& classes,
                        std::span<const float> roughnesses, const Visible& visible = {}, const Loop& loop = {},
                        const prefilter_quality& quality = {})
        : maps_(map.image().width, map.image().height, values_of(map, classes, visible), roughnesses, loop, quality) {}

    /// The lobe of a roughness around direction r, as prefiltered_environment has it.
    sample operator()(vector3<float> r, float roughness) const {
        const auto value = maps_(r, roughness);
        sample result;
        for (std::size_t k = 0; k < K; ++k) {
            result.radiance[k] = {value[3 * k], value[3 * k + 1], value[3 * k + 2]};
            result.share[k] = value[3 * K + k];
        }
        return result;
    }

  private:
    /// The bands of all classes, then their indicators.
    using maps_type = detail::filtered_maps<4 * K, 3 * K>;

    template <class Visible>
    static std::vector<typename maps_type::value_type>
    values_of(const environment_map& map, const environment_classes<K>& classes, const Visible& visible) {
        const auto& image = map.image();
        std::vector<typename maps_type::value_type> values;
        values.reserve(image.texels.size());
        for (std::size_t y = 0; y < image.height; ++y)
            for (std::size_t x = 0; x < image.width; ++x) {
                const rgb<float>& texel = image.at(x, y);
                const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(image.width);
                const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(image.height);
                const float left = clamp(visible(direction_of({u, v})), 0.F, 1.F);
                const std::size_t k = classes.class_of(texel);
                auto& value = values.emplace_back(typename maps_type::value_type{});
                value[3 * k] = left * texel.r;
                value[3 * k + 1] = left * texel.g;
                value[3 * k + 2] = left * texel.b;
                value[3 * K + k] = left;
            }
        return values;
    }

    maps_type maps_;
};

} // namespace mica
