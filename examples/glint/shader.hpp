// From a description of lights and surfaces to the radiance of pixels.
#pragma once

#include <array>
#include <memory>
#include <span>

#include <mica/shade/environment.hpp>

#include "kernels.hpp"
#include "render_loop.hpp"

namespace glint {

/// The classes of light of one light, in a pixel.
class light_source {
  public:
    virtual ~light_source() = default;

    virtual std::size_t classes() const = 0;

    /// Whether its first class takes all facets that flash nowhere else, so that it needs no binomial.
    virtual bool takes_the_rest() const { return false; }

    /// Fills classes() classes. Returns the half vector in the surface's frame, for lights that have one.
    virtual mica::vector3<float> fill(const mica::shading_point<float>& point, const surface_description& surface,
                                      std::span<mica::light_class<float>> classes) const = 0;

    virtual bool has_half_vector() const { return true; }
};

/// The map that a light names.
mica::environment_map map_of(const light_description& light);

/// All that shades a scene.
class shader {
  public:
    explicit shader(const scene_description& description);

    /// What shines on a pixel, the same in all realisations.
    struct illumination {
        std::array<mica::light_class<float>, most_classes> classes{}; ///< black beyond those of the lights
        mica::vector3<float> half_vector;

        /// The limit of infinitely many facets.
        mica::rgb<float> smooth() const;

        /// That a facet flashes at all.
        float flash_probability() const;
    };
    illumination illuminate(const mica::shading_point<float>& point, const surface_description& surface) const;

    /// The radiance of a pixel of one realisation.
    mica::glint_radiance<float> operator()(const mica::shading_point<float>& point, const surface_description& surface,
                                           const illumination& light, std::uint32_t seed) const;
    mica::glint_radiance<float> operator()(const mica::shading_point<float>& point, const surface_description& surface,
                                           std::uint32_t seed) const;

    std::size_t binomials_per_pixel() const { return kernel_.binomials(categories_); }

  private:
    std::vector<std::unique_ptr<light_source>> lights_;
    std::size_t classes_ = 0, categories_ = 0;
    compiled_kernel kernel_;
};

} // namespace glint
