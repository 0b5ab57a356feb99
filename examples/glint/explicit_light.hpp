// Light and facets, direction by direction and one by one: what the kernels are held against. Plain, in binary64, and without
// their formulas: densities, masking and areas are written here once more. Isotropic GGX alone.
#pragma once

#include <memory>
#include <random>
#include <vector>

#include <mica/shade/environment.hpp>

#include "picture.hpp"
#include "scene.hpp"

namespace glint {

/// Light from a small solid angle.
struct beam {
    vector towards;
    double solid_angle;
    colour radiance;
};

/// A light as it shines on a point.
class explicit_light {
  public:
    virtual ~explicit_light() = default;

    /// All of it, in beams narrower than any glint lobe that is compared (an environment: its texels).
    virtual std::vector<beam> beams(const mica::shading_point<float>& point) const = 0;

    /// What comes from one direction.
    virtual colour radiance(const mica::shading_point<float>& point, vector towards) const = 0;
};

/// A directional light has facets of the size that DB23's probability says, which depends on the roughness.
std::unique_ptr<explicit_light> make_explicit_light(const light_description& light,
                                                    const std::optional<vector>& occluder, float roughness);

/// What a facet of a pixel may do: flash towards a beam, with a probability, which gives the pixel radiance / N.
struct outcome {
    double probability;
    double radiance; ///< luminance
};

/// All outcomes of a pixel; the rest of the probability is dark.
class facet_outcomes {
  public:
    explicit facet_outcomes(const std::vector<outcome>& all);

    /// Of one facet: E[Y] and E[Y^2].
    double mean() const { return mean_; }
    double mean_square() const { return mean_square_; }
    double flash_probability() const { return cumulated_.empty() ? 0 : cumulated_.back(); }

    /// The sum of Y over n facets, over `facets`.
    template <class Random>
    double sample(std::uint64_t n, double facets, Random& random) const {
        const double lit = std::min(flash_probability(), 1.);
        std::uint64_t flashes = lit > 0 ? std::binomial_distribution<std::uint64_t>(n, lit)(random) : 0;
        std::uniform_real_distribution<double> place(0, flash_probability());
        double sum = 0;
        for (; flashes > 0; --flashes) sum += at(place(random));
        return sum / facets;
    }

  private:
    double at(double cumulated) const;

    std::vector<double> cumulated_, radiance_;
    double mean_ = 0, mean_square_ = 0;
};

/// Normals of GGX facets by area: the tangent of the angle to n, of a uniform in (0, 1).
class facet_normals {
  public:
    explicit facet_normals(double roughness);
    double tangent(double uniform) const;

    /// D_H, by quadrature.
    double total_area() const { return total_area_; }

  private:
    double total_area_ = 0;
    std::vector<double> tangent_; ///< at equal steps of the facet area within
};

/// The facets of the surface under beams: normals with density D / D_H, each reflecting with its own Fresnel factor and
/// masking.
facet_outcomes facets_under(const std::vector<beam>& beams, const mica::shading_point<float>& point,
                            const mica::glint_material& material, const facet_normals& normals);

/// The same with the albedo of the split sum, shared by all facets that reflect to above the horizon; `filtered` with the
/// lobe that environments are filtered with (n = v = r): what a kernel would count if every beam were a class of its own.
facet_outcomes facets_of_split_sum(const std::vector<beam>& beams, const mica::shading_point<float>& point,
                                   const mica::glint_material& material, const facet_normals& normals, double albedo,
                                   bool filtered);

/// Facet radiance Y of a facet with normal h, in the surface's world: its pixel gets Y / N.
/// `total_area` is D_H.
colour facet_radiance(const explicit_light& light, const mica::shading_point<float>& point,
                      const mica::glint_material& material, double total_area, vector h);

/// A picture whose pixels add up the facets in their ellipses, at fixed places on the surface: exp(log density) of them per
/// unit uv^2, which should be below 1e7. A pixel with more than 4000 of them shows as many other ones.
radiance_picture picture_of_facets(const scene& seen, const explicit_light& light, const surface_description& surface,
                                   std::uint32_t seed);

} // namespace glint
