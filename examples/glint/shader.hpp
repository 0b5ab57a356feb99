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

/// Lights of a scene, prepared (environments filtered for the roughnesses of the surfaces).
/// The map that a light names.
mica::environment_map map_of(const light_description& light);

std::vector<std::unique_ptr<light_source>> make_lights(const scene_description& description);

/// All that shades a scene.
class shader {
  public:
    explicit shader(const scene_description& description);

    static constexpr std::size_t most_classes = 8;

    /// What shines on a pixel, the same in all realisations.
    struct illumination {
        std::array<mica::light_class<float>, most_classes> classes{};
        mica::vector3<float> half_vector;
    };
    illumination illuminate(const mica::shading_point<float>& point, const surface_description& surface) const;

    /// The radiance of a pixel of one realisation.
    mica::glint_radiance<float> operator()(const mica::shading_point<float>& point, const surface_description& surface,
                                           const illumination& light, std::uint32_t seed) const;
    mica::glint_radiance<float> operator()(const mica::shading_point<float>& point, const surface_description& surface,
                                           std::uint32_t seed) const;

    /// The limit of infinitely many facets.
    mica::rgb<float> smooth(const mica::shading_point<float>& point, const surface_description& surface) const;

    /// That a facet flashes at all.
    float flash_probability(const mica::shading_point<float>& point, const surface_description& surface) const;

    /// Calls body(light_class) for all classes of light of a pixel.
    template <class Body>
    void for_classes(const mica::shading_point<float>& point, const surface_description& surface,
                     const Body& body) const {
        const auto all = illuminate(point, surface);
        for (std::size_t k = 0; k < classes_; ++k) body(all.classes[k]);
    }

    std::size_t binomials_per_pixel() const { return kernel_.binomials(categories_); }

  private:
    std::vector<std::unique_ptr<light_source>> lights_;
    std::size_t classes_ = 0, categories_ = 0;
    compiled_kernel kernel_;
};

} // namespace glint
