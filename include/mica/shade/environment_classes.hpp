// mica/shade/environment_classes.hpp: an environment parted into K classes of light, each texel in one of them.
//
// Every texel belongs to the class whose centre is nearest, in the logarithm of its luminance and, for classes by colour, in
// its chromaticity. What a class shines with is not said here: it is filtered with the rest of the environment
// (prefiltered_classes), so that it is local, and in colour.
//
// Source: the levels are those of KK25 Eq. 18; crisp classes around them, and classes by colour, are mica's own.
// Host only.
#pragma once

#include "environment.hpp"

namespace mica {

/// Which class each radiance of an environment belongs to.
template <std::size_t K>
class environment_classes {
    static_assert(K >= 2, "an environment needs at least two classes, one of them dim");

  public:
    /// Bounded by the geometric means of neighbouring levels exp(lerp(log min, log max, (k-1)/(K-1))), class 0 the dimmest.
    /// A constant environment is all of class K - 1, black texels are of class 0. floor > 0 as for environment_levels: darker
    /// texels count as it.
    static environment_classes by_brightness(const environment_map& map, float floor = 1e-3F) {
        environment_classes classes(floor);
        const auto [lowest, highest] = detail::luminance_range(map);
        const float low = std::log2(maximum(lowest, floor)), high = std::log2(maximum(highest, floor));
        for (std::size_t k = 0; k < K; ++k) {
            const float part = static_cast<float>(k) / (K - 1);
            classes.centre_[k] = {(1 - part) * low + part * high, 0, 0};
        }
        return classes;
    }

    /// Clusters of brightness and colour, where brightness alone cannot part the lamps: the K means of texels weighted by
    /// their light (solid angle times luminance), from centres each of which is the texel farthest from those before it.
    /// Colours at the two ends of a mixing triangle are as far apart as 32 stops of brightness. Class 0 is the dimmest.
    static environment_classes by_colour(const environment_map& map, float floor = 1e-3F) {
        environment_classes classes(floor);
        classes.by_colour_ = true;
        const auto samples = classes.samples_of(map);
        if (samples.empty()) return by_brightness(map, floor); // black
        classes.spread(samples);
        constexpr int most_rounds = 32;
        for (int round = 0; round < most_rounds && classes.improve(samples); ++round) {
        }
        std::sort(classes.centre_.begin(), classes.centre_.end(),
                  [](const feature& a, const feature& b) { return a.brightness < b.brightness; });
        return classes;
    }

    /// The class of a radiance >= 0, in 0 .. K - 1.
    std::size_t class_of(rgb<float> radiance) const {
        return luminance(radiance) > 0 ? nearest(feature_of(radiance)) : 0;
    }

  private:
    /// Where a texel lies: log2 of its luminance, and its chromaticity, so scaled that distances compare.
    struct feature {
        float brightness, red, green;
    };
    struct sample {
        feature place;
        double weight;
    };

    explicit environment_classes(float floor) : floor_(floor) {
        if (!(floor > 0)) MICA_FAIL("floor", floor, "positive");
    }

    feature feature_of(rgb<float> radiance) const {
        const float brightness = std::log2(maximum(luminance(radiance), floor_));
        if (!by_colour_) return {brightness, 0, 0};
        const float largest = maximum(radiance.r, maximum(radiance.g, radiance.b)); // so that no sum overflows
        const float r = radiance.r / largest, g = radiance.g / largest, b = radiance.b / largest;
        const float scale = stops_per_colour / (r + g + b);
        return {brightness, scale * r, scale * g};
    }

    static float distance(const feature& a, const feature& b) {
        const float x = a.brightness - b.brightness, y = a.red - b.red, z = a.green - b.green;
        return x * x + y * y + z * z;
    }

    /// Of equally near centres the last.
    std::size_t nearest(const feature& place) const {
        std::size_t best = 0;
        for (std::size_t k = 1; k < K; ++k)
            if (distance(place, centre_[k]) <= distance(place, centre_[best])) best = k;
        return best;
    }

    std::vector<sample> samples_of(const environment_map& map) const {
        const auto& image = map.image();
        std::vector<sample> samples;
        for (std::size_t y = 0; y < image.height; ++y) {
            const double solid_angle = texel_solid_angle(image.width, image.height, y);
            for (std::size_t x = 0; x < image.width; ++x) {
                const auto radiance = image.at(x, y);
                const auto light = static_cast<double>(luminance(radiance));
                if (light > 0) samples.push_back({feature_of(radiance), solid_angle * light});
            }
        }
        return samples;
    }

    /// Starts with the brightest; then the texel farthest from all centres so far.
    void spread(const std::vector<sample>& samples) {
        const auto brightest = std::max_element(samples.begin(), samples.end(), [](const sample& a, const sample& b) {
            return a.place.brightness < b.place.brightness;
        });
        centre_.fill(brightest->place);
        std::vector<float> apart(samples.size(), std::numeric_limits<float>::infinity());
        for (std::size_t k = 1; k < K; ++k) {
            std::size_t farthest = 0;
            for (std::size_t i = 0; i < samples.size(); ++i) {
                apart[i] = minimum(apart[i], distance(samples[i].place, centre_[k - 1]));
                if (apart[i] > apart[farthest]) farthest = i;
            }
            centre_[k] = samples[farthest].place;
        }
    }

    /// Moves every centre to the mean of what is nearest to it; false when none moves.
    bool improve(const std::vector<sample>& samples) {
        struct mean {
            double weight = 0, brightness = 0, red = 0, green = 0;
        };
        std::array<mean, K> means{};
        for (const auto& one : samples) {
            mean& m = means[nearest(one.place)];
            m.weight += one.weight;
            m.brightness += one.weight * static_cast<double>(one.place.brightness);
            m.red += one.weight * static_cast<double>(one.place.red);
            m.green += one.weight * static_cast<double>(one.place.green);
        }
        bool moved = false;
        for (std::size_t k = 0; k < K; ++k) {
            const mean& m = means[k];
            if (!(m.weight > 0)) continue; // fewer colours than classes
            const feature now{static_cast<float>(m.brightness / m.weight), static_cast<float>(m.red / m.weight),
                              static_cast<float>(m.green / m.weight)};
            moved = moved || distance(now, centre_[k]) > 1e-6F;
            centre_[k] = now;
        }
        return moved;
    }

    static constexpr float stops_per_colour = 22.6F; ///< 32 / sqrt 2, the side of the mixing triangle

    float floor_;
    bool by_colour_ = false;
    std::array<feature, K> centre_{};
};

} // namespace mica
