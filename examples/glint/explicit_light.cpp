#include "explicit_light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <mica/reference/facets.hpp>

#include "render_loop.hpp"
#include "shader.hpp"

namespace glint {

namespace {

constexpr double pi = std::numbers::pi;

double cosine(vector a, vector b) {
    return static_cast<double>(a.x) * static_cast<double>(b.x) + static_cast<double>(a.y) * static_cast<double>(b.y) +
           static_cast<double>(a.z) * static_cast<double>(b.z);
}

double ggx(double n_dot_h, double alpha) {
    const double tangent_square = (1 - n_dot_h * n_dot_h) / (n_dot_h * n_dot_h);
    const double t = 1 + tangent_square / (alpha * alpha);
    return 1 / (pi * alpha * alpha * std::pow(n_dot_h, 4) * t * t);
}

/// Facet area within an angle, by quadrature over the angle's tangent t = alpha s: 2 pi D sin d theta.
std::vector<double> facet_area_within(double alpha, const std::vector<double>& tangents) {
    std::vector<double> area{0};
    for (std::size_t i = 1; i < tangents.size(); ++i) {
        constexpr int steps = 16;
        double sum = 0;
        for (int j = 0; j < steps; ++j) {
            const double t = tangents[i - 1] + (tangents[i] - tangents[i - 1]) * (j + 0.5) / steps;
            const double c2 = 1 / (1 + t * t);
            sum += 2 * pi * ggx(std::sqrt(c2), alpha) * t * std::pow(c2, 1.5);
        }
        area.push_back(area.back() + sum * (tangents[i] - tangents[i - 1]) / steps);
    }
    return area;
}

std::vector<double> tangents_for(double alpha) {
    std::vector<double> tangents;
    constexpr int size = 4096;
    for (int i = 0; i < size; ++i) {
        const double part = i / static_cast<double>(size);
        tangents.push_back(alpha * part / (1 - part) * std::sqrt(1 / (1 - part)));
    }
    return tangents;
}

double total_facet_area(double roughness) { return facet_area_within(roughness, tangents_for(roughness)).back(); }

/// The integral of D(h) n.l over the directions l above the horizon, n = wo: what the filter of environments divides by.
double filter_weight(double alpha) {
    double sum = 0, before = 0;
    for (const double t : tangents_for(alpha)) {
        const double middle = (t + before) / 2, c2 = 1 / (1 + middle * middle), c = std::sqrt(c2);
        if (t > 1) break; // l at the horizon
        sum += ggx(c, alpha) * (2 * c2 - 1) * 4 * c * 2 * pi * middle * c2 * c * (t - before);
        before = t;
    }
    return sum;
}

/// Both masking and shadowing, height correlated, over 4 n.l n.v times the 4 n.l that a beam has: G / n.v.
double masking_over_cosine(double n_dot_l, double n_dot_v, double alpha) {
    const auto lambda = [alpha](double c) { return (std::sqrt(1 + alpha * alpha * (1 - c * c) / (c * c)) - 1) / 2; };
    return 1 / ((1 + lambda(n_dot_l) + lambda(n_dot_v)) * n_dot_v);
}

double fresnel(float f0, double cos) {
    return static_cast<double>(f0) + (1 - static_cast<double>(f0)) * std::pow(1 - cos, 5);
}

colour scaled(double by, colour c) { return static_cast<float>(by) * c; }

vector any_perpendicular(vector n) {
    return mica::normalized(mica::cross(n, std::abs(n.x) < 0.7F ? vector{1, 0, 0} : vector{0, 1, 0}));
}

/// Directions of a cone, equally dense: cosines from 1 down to 1 - depth.
template <class Body>
void for_cone(vector axis, double depth, const Body& body) {
    constexpr int rings = 24, spokes = 48;
    const vector first = any_perpendicular(axis), second = mica::cross(axis, first);
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < spokes; ++j) {
            const double below = depth * (i + 0.5) / rings;
            const double sine = std::sqrt(below * (2 - below)), azimuth = 2 * pi * (j + 0.5) / spokes;
            const vector w = static_cast<float>(1 - below) * axis +
                             static_cast<float>(sine * std::cos(azimuth)) * first +
                             static_cast<float>(sine * std::sin(azimuth)) * second;
            body(mica::normalized(w), 2 * pi * depth / (rings * spokes));
        }
}

using wall = std::optional<vector>; ///< what it hides is dark

class explicit_environment : public explicit_light {
  public:
    explicit_environment(mica::environment_map map, wall occluder) : map_(std::move(map)), wall_(occluder) {
        const auto& image = map_.image();
        for (std::size_t y = 0; y < image.height; ++y)
            for (std::size_t x = 0; x < image.width; ++x) {
                const vector w =
                    mica::direction_of({(static_cast<float>(x) + 0.5F) / static_cast<float>(image.width),
                                        (static_cast<float>(y) + 0.5F) / static_cast<float>(image.height)});
                if (!hides(wall_, w))
                    texels_.push_back({w, mica::texel_solid_angle(image.width, image.height, y), image.at(x, y)});
            }
    }
    std::vector<beam> beams(const mica::shading_point<float>&) const override { return texels_; }
    colour radiance(const mica::shading_point<float>&, vector w) const override {
        return hides(wall_, w) ? colour{0, 0, 0} : map_(w);
    }

  private:
    mica::environment_map map_;
    wall wall_;
    std::vector<beam> texels_;
};

/// A light from one direction, as DB23 means it: a facet flashes where its normal lies in the solid angle A_h = R D_H / D(n)
/// around h, and then has the radiance that makes up the irradiance.
class explicit_directional : public explicit_light {
  public:
    explicit_directional(const light_description& light, wall occluder, double roughness)
        : towards_(mica::normalized(light.direction)),
          area_(static_cast<double>(light.glint_fraction) * total_facet_area(roughness) * pi * roughness * roughness),
          irradiance_(hides(occluder, towards_) ? colour{0, 0, 0} : light.radiance) {}

    std::vector<beam> beams(const mica::shading_point<float>& point) const override {
        std::vector<beam> all;
        if (!(dot(point.wo + towards_, point.wo) > 0)) return all;
        const vector h = mica::normalized(point.wo + towards_);
        for_cone(h, area_ / (2 * pi), [&](vector normal, double solid_angle) {
            const double cos = cosine(point.wo, normal);
            all.push_back(
                {mica::reflected(point.wo, normal), 4 * cos * solid_angle, scaled(1 / (4 * cos * area_), irradiance_)});
        });
        return all;
    }
    colour radiance(const mica::shading_point<float>& point, vector w) const override {
        const vector h = mica::normalized(point.wo + towards_), normal = mica::normalized(point.wo + w);
        const bool flashes = cosine(h, normal) > 1 - area_ / (2 * pi);
        return flashes ? scaled(1 / (4 * cosine(point.wo, normal) * area_), irradiance_) : colour{0, 0, 0};
    }

  private:
    vector towards_;
    double area_; ///< A_h, steradians
    colour irradiance_;
};

class explicit_sun : public explicit_light {
  public:
    explicit_sun(const light_description& light, wall occluder)
        : towards_(mica::normalized(light.direction)), depth_(1 - std::cos(static_cast<double>(light.half_angle))),
          radiance_(hides(occluder, towards_) ? colour{0, 0, 0} : light.radiance) {}

    std::vector<beam> beams(const mica::shading_point<float>&) const override {
        std::vector<beam> all;
        for_cone(towards_, depth_, [&](vector w, double solid_angle) { all.push_back({w, solid_angle, radiance_}); });
        return all;
    }
    colour radiance(const mica::shading_point<float>&, vector w) const override {
        const vector apart = w - towards_; // 1 - cos = |w - t|^2 / 2
        return cosine(apart, apart) / 2 < depth_ ? radiance_ : colour{0, 0, 0};
    }

  private:
    vector towards_;
    double depth_;
    colour radiance_;
};

/// Rectangle or disk: half_u and half_v span it.
class explicit_area : public explicit_light {
  public:
    explicit_area(vector centre, vector half_u, vector half_v, bool disk, colour radiance, wall occluder)
        : centre_(centre), half_u_(half_u), half_v_(half_v), normal_(mica::normalized(mica::cross(half_u, half_v))),
          disk_(disk), radiance_(hides(occluder, centre) ? colour{0, 0, 0} : radiance) {}

    std::vector<beam> beams(const mica::shading_point<float>& point) const override {
        constexpr int side = 192;
        const double cell =
            4 * std::sqrt(cosine(mica::cross(half_u_, half_v_), mica::cross(half_u_, half_v_))) / (side * side);
        std::vector<beam> all;
        for (int i = 0; i < side; ++i)
            for (int j = 0; j < side; ++j) {
                const auto at = [](int k) { return (2 * static_cast<float>(k) + 1) / side - 1; };
                if (disk_ && at(i) * at(i) + at(j) * at(j) > 1) continue;
                const vector to = centre_ + at(i) * half_u_ + at(j) * half_v_ - point.position;
                const double square = cosine(to, to);
                const vector w = mica::normalized(to);
                const double facing = -cosine(w, normal_);
                if (facing > 0) all.push_back({w, cell * facing / square, radiance_});
            }
        return all;
    }
    colour radiance(const mica::shading_point<float>& point, vector w) const override {
        const double facing = -cosine(w, normal_), distance = -cosine(centre_ - point.position, normal_) / facing;
        if (!(facing > 0 && distance > 0)) return {0, 0, 0};
        const vector across = point.position + static_cast<float>(distance) * w - centre_;
        const double u = cosine(across, half_u_) / cosine(half_u_, half_u_);
        const double v = cosine(across, half_v_) / cosine(half_v_, half_v_);
        const bool hit = disk_ ? u * u + v * v < 1 : std::abs(u) < 1 && std::abs(v) < 1;
        return hit ? radiance_ : colour{0, 0, 0};
    }

  private:
    vector centre_, half_u_, half_v_, normal_;
    bool disk_;
    colour radiance_;
};

} // namespace

std::unique_ptr<explicit_light> make_explicit_light(const light_description& light,
                                                    const std::optional<vector>& occluder, float roughness) {
    if (light.type == "directional")
        return std::make_unique<explicit_directional>(light, occluder, static_cast<double>(roughness));
    if (light.type == "sun") return std::make_unique<explicit_sun>(light, occluder);
    if (light.type == "disk") {
        const vector normal = mica::normalized(light.normal), first = any_perpendicular(normal);
        return std::make_unique<explicit_area>(light.centre, light.radius * first,
                                               light.radius * mica::cross(normal, first), true, light.radiance,
                                               occluder);
    }
    if (light.type == "area" || light.type == "rectangle")
        return std::make_unique<explicit_area>(light.centre, light.half_u, light.half_v, false, light.radiance,
                                               occluder);
    return std::make_unique<explicit_environment>(map_of(light), occluder);
}

facet_outcomes::facet_outcomes(const std::vector<outcome>& all) {
    cumulated_.reserve(all.size());
    radiance_.reserve(all.size());
    double sum = 0;
    for (const auto& one : all) {
        if (!(one.probability > 0)) continue;
        sum += one.probability;
        mean_ += one.probability * one.radiance;
        mean_square_ += one.probability * one.radiance * one.radiance;
        cumulated_.push_back(sum);
        radiance_.push_back(one.radiance);
    }
}

double facet_outcomes::at(double cumulated) const {
    const auto found = std::upper_bound(cumulated_.begin(), cumulated_.end() - 1, cumulated);
    return radiance_[static_cast<std::size_t>(found - cumulated_.begin())];
}

namespace {

/// D_H F G (wo.h) L / n.v, the radiance of a facet.
template <class Light>
colour radiance_of_facet(const mica::shading_point<float>& point, const mica::glint_material& material, double area,
                         vector h, vector w, Light light) {
    const double n_dot_v = cosine(point.normal, point.wo), n_dot_l = cosine(point.normal, w), cos = cosine(point.wo, h);
    if (!(n_dot_v > 0 && n_dot_l > 0 && cos > 0 && cosine(point.normal, h) > 0)) return {0, 0, 0};
    const double alpha = static_cast<double>(material.roughness);
    const double common = area * cos * masking_over_cosine(n_dot_l, n_dot_v, alpha);
    const auto& f0 = material.f0;
    const colour reflectance{static_cast<float>(common * fresnel(f0.r, cos)),
                             static_cast<float>(common * fresnel(f0.g, cos)),
                             static_cast<float>(common * fresnel(f0.b, cos))};
    return reflectance * light();
}

} // namespace

facet_outcomes facets_under(const std::vector<beam>& beams, const mica::shading_point<float>& point,
                            const mica::glint_material& material, const facet_normals& normals) {
    const double alpha = static_cast<double>(material.roughness), area = normals.total_area();
    std::vector<outcome> all;
    all.reserve(beams.size());
    for (const auto& one : beams) {
        if (!(dot(one.towards, point.normal) > 0)) continue;
        const vector h = mica::normalized(one.towards + point.wo);
        const double n_dot_h = cosine(point.normal, h), cos = cosine(point.wo, h);
        if (!(n_dot_h > 0 && cos > 0)) continue;
        const double probability = ggx(n_dot_h, alpha) / area * one.solid_angle / (4 * cos);
        const colour y = radiance_of_facet(point, material, area, h, one.towards, [&] { return one.radiance; });
        all.push_back({probability, static_cast<double>(luminance(y))});
    }
    return facet_outcomes(std::move(all));
}

namespace {

/// E_D / D_H: the share of the facets that reflect the eye's ray to above the horizon, by counting normals.
double visible_share(const mica::shading_point<float>& point, const facet_normals& normals) {
    constexpr int rings = 512, spokes = 64;
    int above = 0;
    const double mu = cosine(point.normal, point.wo), sine_v = std::sqrt(std::max(0., 1 - mu * mu));
    for (int i = 0; i < rings; ++i) {
        const double t = normals.tangent((i + 0.5) / rings), c = 1 / std::sqrt(1 + t * t), s = t * c;
        for (int j = 0; j < spokes; ++j) {
            const double wo_h = mu * c + sine_v * s * std::cos(2 * pi * (j + 0.5) / spokes);
            above += wo_h > 0 && 2 * wo_h * c - mu > 0;
        }
    }
    return static_cast<double>(above) / (rings * spokes);
}

} // namespace

facet_outcomes facets_of_split_sum(const std::vector<beam>& beams, const mica::shading_point<float>& point,
                                   const mica::glint_material& material, const facet_normals& normals, double albedo,
                                   bool filtered) {
    const double alpha = static_cast<double>(material.roughness), visible = visible_share(point, normals);
    const double scale = filtered ? visible / filter_weight(alpha) : 1 / normals.total_area();
    const vector r = mica::reflected(point.wo, point.normal);
    std::vector<outcome> all;
    all.reserve(beams.size());
    for (const auto& one : beams) {
        double weight = 0;
        if (filtered) {
            const double cos = cosine(one.towards, r);
            weight = cos > 0 ? ggx(std::sqrt((1 + cos) / 2), alpha) * cos : 0;
        } else if (dot(one.towards, point.normal) > 0) {
            const vector h = mica::normalized(one.towards + point.wo);
            weight = dot(point.normal, h) > 0 ? ggx(cosine(point.normal, h), alpha) / (4 * cosine(point.wo, h)) : 0;
        }
        all.push_back(
            {scale * weight * one.solid_angle, albedo / visible * static_cast<double>(luminance(one.radiance))});
    }
    return facet_outcomes(std::move(all));
}

facet_normals::facet_normals(double roughness) {
    const auto tangents = tangents_for(roughness);
    const auto area = facet_area_within(roughness, tangents);
    total_area_ = area.back();
    constexpr std::size_t size = 65536;
    std::size_t k = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const double wanted = area.back() * static_cast<double>(i) / size;
        while (area[k + 1] < wanted) ++k;
        const double part = (wanted - area[k]) / (area[k + 1] - area[k]);
        tangent_.push_back(tangents[k] + part * (tangents[k + 1] - tangents[k]));
    }
    tangent_.push_back(tangents.back());
}

double facet_normals::tangent(double uniform) const {
    const double at = uniform * static_cast<double>(tangent_.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(at), tangent_.size() - 2);
    return tangent_[i] + (at - static_cast<double>(i)) * (tangent_[i + 1] - tangent_[i]);
}

colour facet_radiance(const explicit_light& light, const mica::shading_point<float>& point,
                      const mica::glint_material& material, double total_area, vector h) {
    const vector w = mica::reflected(point.wo, h);
    return radiance_of_facet(point, material, total_area, h, w, [&] { return light.radiance(point, w); });
}

radiance_picture picture_of_facets(const scene& seen, const explicit_light& light, const surface_description& surface,
                                   std::uint32_t seed) {
    constexpr int enough_facets = 4000;
    const auto& material = surface.material;
    const auto per_side = static_cast<std::size_t>(std::exp(static_cast<double>(material.log_density) / 2));
    const mica::reference::facet_set facets(per_side, mica::reference::facet_positions::jittered, seed);
    const facet_normals normals(static_cast<double>(material.roughness));
    const std::size_t width = seen.width(), height = seen.height();
    radiance_picture picture{width, height, std::vector<colour>(width * height, colour{0, 0, 0})};
    parallel_loop{"explicit facets"}(height, [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x) {
            const auto hit = seen.surface(x, y);
            if (!hit) continue;
            const auto& point = hit->point;
            const auto& m = point.derivatives;
            const double trials = facets.density() * static_cast<double>(mica::make_footprint(point.derivatives).area);
            const vector bitangent = mica::cross(point.normal, point.tangent);
            colour sum{0, 0, 0};
            const auto add_slopes = [&](double slope_u, double slope_v) {
                // They are standard normal: their direction is uniform, and exp(-r^2/2) is.
                const double r = std::hypot(slope_u, slope_v);
                const double t = normals.tangent(-std::expm1(-r * r / 2)) / r;
                const vector h = mica::normalized(static_cast<float>(t * slope_u) * point.tangent +
                                                  static_cast<float>(t * slope_v) * bitangent + point.normal);
                sum = sum + facet_radiance(light, point, material, normals.total_area(), h);
            };
            if (trials > enough_facets) { // towards a horizon there is no end of them
                std::mt19937 random(mica::hash(seed, static_cast<std::uint32_t>(y * width + x)));
                std::normal_distribution<double> slope;
                for (int i = 0; i < enough_facets; ++i) {
                    const double slope_u = slope(random);
                    add_slopes(slope_u, slope(random));
                }
                picture.pixels[y * width + x] = (1.F / enough_facets) * sum;
                continue;
            }
            const auto add = [&](const mica::reference::facet& f) {
                add_slopes(f.slope_u, f.slope_v);
                return false;
            };
            facets.count({static_cast<double>(point.uv.u), static_cast<double>(point.uv.v),
                          static_cast<double>(m.du_dx), static_cast<double>(m.dv_dx), static_cast<double>(m.du_dy),
                          static_cast<double>(m.dv_dy)},
                         add);
            picture.pixels[y * width + x] = static_cast<float>(1 / trials) * sum;
        }
    });
    return picture;
}

} // namespace glint
