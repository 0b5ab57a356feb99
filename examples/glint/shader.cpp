#include "shader.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <mica/shade/environment_glints.hpp>
#include <mica/shade/lights.hpp>

#include "frame_file.hpp"
#include "picture.hpp"
#include "scene.hpp"

namespace glint {

namespace {

const mica::microfacet_table& table() {
    static const mica::microfacet_table built;
    return built;
}

/// Numbers of levels that the program is compiled for.
using compiled_levels = std::index_sequence<2, 3, 4, 5, 6, 7, 8>;

/// Calls body(std::integral_constant<std::size_t, K>{}) with K = levels.
template <class Body, std::size_t First, std::size_t... More>
auto with_levels(std::size_t levels, const Body& body, std::index_sequence<First, More...>) {
    if constexpr (sizeof...(More) > 0)
        if (levels != First) return with_levels(levels, body, std::index_sequence<More...>{});
    return body(std::integral_constant<std::size_t, First>{});
}

template <class Body>
auto with_levels(int levels, const Body& body) {
    return with_levels(static_cast<std::size_t>(levels), body, compiled_levels{}); // check() saw to the rest
}

template <class Environment, std::size_t K>
class environment_light : public light_source {
  public:
    explicit environment_light(Environment environment) : environment_(std::move(environment)) {}

    std::size_t classes() const override { return K; }
    bool takes_the_rest() const override { return true; }
    bool has_half_vector() const override { return false; }

    vector fill(const mica::shading_point<float>& point, const surface_description& surface,
                std::span<mica::light_class<float>> classes) const override {
        const auto all = mica::light_classes(point, surface.material, environment_, table());
        std::copy(all.begin(), all.end(), classes.begin());
        return {};
    }

  private:
    Environment environment_;
};

template <class Environment, std::size_t K>
std::unique_ptr<light_source> environment_of(Environment environment, std::integral_constant<std::size_t, K>) {
    return std::make_unique<environment_light<Environment, K>>(std::move(environment));
}

std::unique_ptr<light_source> make_environment(const light_description& light, const scene_description& description) {
    const auto map = map_of(light);
    std::vector<float> roughnesses;
    for (const auto& surface : description.surfaces) roughnesses.push_back(surface.material.roughness);
    std::sort(roughnesses.begin(), roughnesses.end());
    roughnesses.erase(std::unique(roughnesses.begin(), roughnesses.end()), roughnesses.end());
    const parallel_loop loop{"prefiltering"};
    return with_levels(light.levels, [&](auto levels) {
        constexpr std::size_t K = decltype(levels)::value;
        if (light.classes == "published") {
            if (description.occluder)
                throw std::invalid_argument(
                    "an occluder is not compiled in for published levels (for the others it is)");
            return environment_of(
                mica::prefiltered_environment<K>(map, mica::environment_levels<K>(map), roughnesses, loop), levels);
        }
        const auto classes = light.classes == "colour" ? mica::environment_classes<K>::by_colour(map)
                                                       : mica::environment_classes<K>::by_brightness(map);
        const auto visible = [&description](vector w) { return hides(description.occluder, w) ? 0.F : 1.F; };
        return environment_of(mica::prefiltered_classes<K>(map, classes, roughnesses, visible, loop), levels);
    });
}

/// WDH20 as KK25 restates it: the smooth radiance of an environment, with a probability that the user picks.
class constant_probability : public light_source {
  public:
    constant_probability(std::unique_ptr<light_source> environment, float probability)
        : environment_(std::move(environment)), probability_(probability) {}

    std::size_t classes() const override { return 1; }
    bool has_half_vector() const override { return false; }

    vector fill(const mica::shading_point<float>& point, const surface_description& surface,
                std::span<mica::light_class<float>> classes) const override {
        std::array<mica::light_class<float>, most_classes> all{};
        environment_->fill(point, surface, all);
        classes[0] = {{0, 0, 0}, probability_};
        for (std::size_t k = 0; k < environment_->classes(); ++k) classes[0].smooth = classes[0].smooth + all[k].smooth;
        return {};
    }

  private:
    std::unique_ptr<light_source> environment_;
    float probability_;
};

/// Lights with one lobe, by the distribution of the surface's facets.
template <class Light>
class lobe_light : public light_source {
  public:
    lobe_light(Light light, const std::optional<vector>& wall_side, vector towards)
        : light_(light), visible_(hides(wall_side, towards) ? 0.F : 1.F) {}

    std::size_t classes() const override { return 1; }

    vector fill(const mica::shading_point<float>& point, const surface_description& surface,
                std::span<mica::light_class<float>> classes) const override {
        const auto& material = surface.material;
        const float across = surface.roughness_across > 0 ? surface.roughness_across : material.roughness;
        const auto response = surface.distribution == "beckmann"
                                  ? respond(mica::beckmann<float>{material.roughness, across}, point, material)
                                  : respond(mica::ggx<float>{material.roughness, across}, point, material);
        classes[0] = {visible_ * response.smooth, visible_ * response.probability};
        return response.half_vector;
    }

  private:
    template <class Facets>
    mica::light_response<float> respond(const Facets& facets, const mica::shading_point<float>& point,
                                        const mica::glint_material& material) const {
        return mica::respond(light_, point, facets, material.f0, table());
    }

    Light light_;
    float visible_;
};

template <class Light>
std::unique_ptr<light_source> lobe_light_of(Light light, const scene_description& description, vector towards) {
    return std::make_unique<lobe_light<Light>>(light, description.occluder, towards);
}

std::unique_ptr<light_source> make_light(const light_description& light, const scene_description& description) {
    if (light.type == "environment") return make_environment(light, description);
    if (light.type == "wdh20")
        return std::make_unique<constant_probability>(make_environment(light, description), light.gamma);
    const vector direction = mica::normalized(light.direction);
    if (light.type == "directional")
        return lobe_light_of(mica::directional_light{direction, light.radiance, light.glint_fraction}, description,
                             direction);
    if (light.type == "sun")
        return lobe_light_of(mica::sun_light{direction, light.radiance, light.half_angle}, description, direction);
    if (light.type == "rectangle" || light.type == "area")
        return lobe_light_of(mica::rectangle_light{light.centre, light.half_u, light.half_v, light.radiance},
                             description, light.centre);
    return lobe_light_of(mica::disk_light{light.centre, mica::normalized(light.normal), light.radius, light.radiance},
                         description, light.centre);
}

/// Lights of a scene, prepared (environments filtered for the roughnesses of the surfaces).
std::vector<std::unique_ptr<light_source>> make_lights(const scene_description& description) {
    check(description);
    std::vector<std::unique_ptr<light_source>> lights;
    for (const auto& light : description.lights) lights.push_back(make_light(light, description));
    // The environment first, so that its dimmest class is class 0.
    std::stable_partition(lights.begin(), lights.end(), [](const auto& light) { return light->takes_the_rest(); });
    return lights;
}

} // namespace

mica::environment_map map_of(const light_description& light) {
    if (light.file == "white") return white_environment();
    if (const auto degrees = lamps_apart(light.file)) return lamps_environment(*degrees);
    if (light.file.empty()) return procedural_environment();
    return light.file.ends_with(".exr") ? read_exr_environment(light.file) : read_environment(light.file);
}

shader::shader(const scene_description& description) : lights_(make_lights(description)) {
    for (const auto& light : lights_) classes_ += light->classes();
    categories_ = lights_.front()->takes_the_rest() && !description.occluder ? classes_ - 1 : classes_;
    kernel_ = find_kernel(description.counting, classes_);
}

shader::illumination shader::illuminate(const mica::shading_point<float>& point,
                                        const surface_description& surface) const {
    // A single light has a half vector; several share that of the eye.
    illumination all{{}, 0.5F * point.local(point.wo)};
    std::size_t filled = 0;
    for (const auto& light : lights_) {
        const vector own = light->fill(point, surface, {all.classes.data() + filled, light->classes()});
        if (lights_.size() == 1 && light->has_half_vector()) all.half_vector = own;
        filled += light->classes();
    }
    // What flashes towards other lights is no longer dim.
    if (lights_.front()->takes_the_rest())
        for (std::size_t k = lights_.front()->classes(); k < classes_; ++k)
            all.classes[0].probability = std::max(all.classes[0].probability - all.classes[k].probability, 0.F);
    return all;
}

mica::glint_radiance<float> shader::operator()(const mica::shading_point<float>& point,
                                               const surface_description& surface, const illumination& light,
                                               std::uint32_t seed) const {
    return kernel_.shade(point, surface.material, {light.classes.data(), classes_}, light.half_vector, seed);
}

mica::glint_radiance<float> shader::operator()(const mica::shading_point<float>& point,
                                               const surface_description& surface, std::uint32_t seed) const {
    return (*this)(point, surface, illuminate(point, surface), seed);
}

mica::rgb<float> shader::illumination::smooth() const {
    mica::rgb<float> sum{0, 0, 0};
    for (const auto& one : classes) sum = sum + one.smooth;
    return sum;
}

float shader::illumination::flash_probability() const {
    float sum = 0;
    for (const auto& one : classes) sum += one.probability;
    return std::min(sum, 1.F);
}

} // namespace glint
