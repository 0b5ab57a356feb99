// mica/shade/environment_glints.hpp: glints under an environment.
//
//     p_k = (E_D / D_H) w_k   for all classes of its radiance but the dimmest, which gets the rest
//
// w_k is the part of the lobe around the mirror direction that shows class k. What is missing to sum p = 1 are facets that
// reflect nothing; the dimmest class takes them in, dimmed so that its energy is kept. So K classes cost K - 1 binomials.
// What an occluder hides is dark, and where it hides something they cost K.
// Source: KK25 Sec. 4 and 5, Eq. 15, 17, 21. The smooth radiance is that of the split sum.
//
// Two kinds of classes: those of prefiltered_classes, crisp and with the colour and brightness that each has in the lobe
// (the default), and the fuzzy levels of prefiltered_environment, as published, whose glints have the colour of the whole
// lobe and the radiance of their level.
#pragma once

#include "glint_kernel.hpp"
#include "microfacet.hpp"
#include "prefilter.hpp"

namespace mica {

/// What the lobe around a direction sees of the K classes of an environment: the radiance of each in it, all together that
/// of the lobe, and the part of the lobe that shows it.
template <real_number Real, std::size_t K>
struct environment_lobe {
    std::array<rgb<Real>, K> radiance; ///< of each class in the lobe
    std::array<Real, K> share;         ///< sum 1; less where something occludes the environment
};

/// The lobe in published levels: all of the colour of the whole, as bright as L_k is beside the others.
template <std::size_t K>
MICA_HOST_DEVICE environment_lobe<float, K> lobe_of(const prefiltered_environment<K>& environment, vector3<float> r,
                                                    float roughness) {
    const auto seen = environment(r, roughness);
    const auto& levels = environment.levels().radiance();
    environment_lobe<float, K> lobe{{}, seen.indicator};
    const float brightest = levels[K - 1] > 0 ? levels[K - 1] : 1; // so that no product overflows
    float total = 0;
    for (std::size_t k = 0; k < K; ++k) total += levels[k] / brightest * seen.indicator[k];
    for (std::size_t k = 0; k < K; ++k) {
        // Without light in any level (a black lobe) the dimmest has what there is.
        const float part = total > 0 ? levels[k] / brightest * seen.indicator[k] / total : (k == 0 ? 1.F : 0.F);
        lobe.radiance[k] = part * seen.radiance;
    }
    return lobe;
}

/// The lobe in local classes.
template <std::size_t K>
MICA_HOST_DEVICE environment_lobe<float, K> lobe_of(const prefiltered_classes<K>& environment, vector3<float> r,
                                                    float roughness) {
    const auto seen = environment(r, roughness);
    return {seen.radiance, seen.share};
}

/// The same on a GPU.
template <std::size_t K>
MICA_HOST_DEVICE environment_lobe<float, K> lobe_of(const prefiltered_classes_view<K>& environment, vector3<float> r,
                                                    float roughness) {
    const auto seen = environment(r, roughness);
    return {seen.radiance, seen.share};
}

namespace detail {

/// Everything that comes of tables: the lobe, its reflectance, and E_D / D_H.
template <real_number Real, std::size_t K>
struct environment_seen {
    environment_lobe<Real, K> lobe;
    rgb<Real> reflectance;
    Real visible_fraction;
};

/// Nothing from behind the surface.
template <std::size_t K, class Environment>
MICA_HOST_DEVICE environment_seen<float, K> seen_of(const Environment& environment, const microfacet_table& table,
                                                    const glint_material& material, vector3<float> r, float n_dot_v) {
    if (!(n_dot_v > 0)) return {};
    return {lobe_of(environment, r, material.roughness), table.albedo(n_dot_v, material.roughness)(material.f0),
            table.visible_fraction(n_dot_v, material.roughness)};
}

/// Packs look up their lanes one by one.
template <std::size_t K, real_number Real, class Environment>
MICA_HOST_DEVICE environment_seen<Real, K> seen_of(const Environment& environment, const microfacet_table& table,
                                                   const glint_material& material, vector3<Real> r, Real n_dot_v) {
    environment_seen<Real, K> seen{};
    for (int i = 0; i < lanes_of<Real>; ++i) {
        const vector3<float> towards{lane(r.x, i), lane(r.y, i), lane(r.z, i)};
        const auto one = seen_of<K>(environment, table, material, towards, lane(n_dot_v, i));
        for (std::size_t k = 0; k < K; ++k) {
            set_lane(seen.lobe.radiance[k], i, one.lobe.radiance[k]);
            set_lane(seen.lobe.share[k], i, one.lobe.share[k]);
        }
        set_lane(seen.reflectance, i, one.reflectance);
        set_lane(seen.visible_fraction, i, one.visible_fraction);
    }
    return seen;
}

} // namespace detail

/// The classes of an environment (prefiltered_classes<K> or prefiltered_environment<K>) in a pixel. All black where the
/// eye is behind the surface.
template <real_number Real, template <std::size_t> class Environment, std::size_t K>
MICA_HOST_DEVICE std::array<light_class<Real>, K>
light_classes(const shading_point<Real>& point, const glint_material& material, const Environment<K>& environment,
              const microfacet_table& table) {
    const Real n_dot_v = dot(point.normal, point.wo);
    const auto seen = detail::seen_of<K>(environment, table, material, reflected(point.wo, point.normal), n_dot_v);
    std::array<light_class<Real>, K> classes;
    Real whole = Real(0), others = Real(0);
    for (std::size_t k = 0; k < K; ++k) {
        classes[k] = {seen.reflectance * seen.lobe.radiance[k], seen.visible_fraction * seen.lobe.share[k]};
        whole = whole + seen.lobe.share[k];
        if (k > 0) others = others + classes[k].probability;
    }
    // The dimmest class takes in what reflects nothing, but not what an occluder hides.
    const Real share_hidden = Real(1) - whole;
    const Real hidden = seen.visible_fraction * select(share_hidden > Real(1e-4F), share_hidden, Real(0));
    classes[0].probability = maximum(Real(1) - others - hidden, Real(0));
    return classes;
}

/// The radiance of a pixel under an environment. `seed` picks the realisation.
template <class Kernel, real_number Real, template <std::size_t> class Environment, std::size_t K>
MICA_HOST_DEVICE glint_radiance<Real> shade(const Kernel& kernel, const shading_point<Real>& point,
                                            const glint_material& material, const Environment<K>& environment,
                                            const microfacet_table& table, std::uint32_t seed) {
    vector3<Real> half_of_eye{};
    if constexpr (Kernel::has_half_vectors) half_of_eye = Real(0.5) * point.local(point.wo);
    return kernel(point, material, light_classes(point, material, environment, table), half_of_eye, seed);
}

} // namespace mica
