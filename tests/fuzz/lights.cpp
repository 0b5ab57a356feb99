// Lights, places and surfaces of ordinary size, and facets of any roughness: a light's response has a probability in [0, 1]
// and a finite radiance. Those of any bits do no harm.
#include <array>
#include <cmath>

#include <mica/shade/lights.hpp>

#include "input.hpp"

namespace {

mica::vector3<float> take_vector(input& bytes, float most) {
    return {bytes.within(-most, most), bytes.within(-most, most), bytes.within(-most, most)};
}

mica::vector3<float> take_direction(input& bytes) {
    const auto v = take_vector(bytes, 1);
    const float length = std::sqrt(dot(v, v));
    return length > 1e-3F ? (1 / length) * v : mica::vector3<float>{0, 0, 1};
}

mica::vector3<float> take_any(input& bytes) { return {bytes.take<float>(), bytes.take<float>(), bytes.take<float>()}; }

const mica::microfacet_table& table() {
    static const mica::microfacet_table built;
    return built;
}

template <class Light, class Facets>
void respond(const Light& light, const mica::shading_point<float>& point, const Facets& facets, bool ordinary) {
    const auto seen = mica::respond(light, point, facets, mica::rgb<float>{0.9F, 0.5F, 0.1F}, table());
    if (!ordinary) return;
    require(seen.probability >= 0 && seen.probability <= 1, "a probability is in [0, 1]",
            static_cast<double>(seen.probability));
    for (const float band : {seen.smooth.r, seen.smooth.g, seen.smooth.b})
        require(band >= 0 && std::isfinite(band), "a radiance is finite", static_cast<double>(band));
}

template <class Facets>
void require_terms(const Facets& facets, mica::vector3<float> a, mica::vector3<float> b) {
    const float density = facets.relative_density(a), visible = facets.masking_shadowing(a, b);
    require(density >= 0 && std::isfinite(density), "a density is finite", static_cast<double>(density));
    require(visible >= 0 && visible <= 1, "masking is in [0, 1]", static_cast<double>(visible));
}

template <class Facets>
void respond_to_lights(const Facets& facets, bool ordinary, input bytes) {
    const auto direction = [&] { return ordinary ? take_direction(bytes) : take_any(bytes); };
    const auto vector = [&](float most) { return ordinary ? take_vector(bytes, most) : take_any(bytes); };
    const auto number = [&](float low, float high) { return ordinary ? bytes.within(low, high) : bytes.take<float>(); };
    mica::shading_point<float> point;
    point.normal = direction();
    point.wo = direction();
    if (ordinary) require_terms(facets, point.normal, point.wo);
    const auto beside = direction();
    const auto across = mica::cross(point.normal, beside);
    const float length = std::sqrt(dot(across, across));
    point.tangent = ordinary ? (length > 1e-3F ? (1 / length) * across : mica::vector3<float>{}) : beside;
    if (ordinary && !(length > 1e-3F)) return; // no frame
    point.position = vector(100);
    const auto towards = direction(), centre = vector(100), half_u = vector(100), half_v = vector(100);
    const float size = number(1e-3F, 3), part = number(1e-6F, 1), strength = number(0, 1e6F);
    const mica::rgb<float> radiance{strength, 1, 0};
    respond(mica::directional_light{towards, radiance, part}, point, facets, ordinary);
    respond(mica::sun_light{towards, radiance, size}, point, facets, ordinary);
    respond(mica::rectangle_light{centre, half_u, half_v, radiance}, point, facets, ordinary);
    respond(mica::disk_light{centre, towards, size, radiance}, point, facets, ordinary);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    input bytes(data, size);
    const bool ordinary = bytes.below(2) == 0;
    const float along = bytes.take<float>(), across = bytes.take<float>();
    respond_to_lights(mica::ggx<float>{along, across}, ordinary, bytes);
    respond_to_lights(mica::beckmann<float>{along, across}, ordinary, bytes);
    const float fraction = table().visible_fraction(along, across);
    require(fraction >= 0 && fraction <= 1.00001F, "a visible fraction is in [0, 1]", static_cast<double>(fraction));
    return 0;
}
