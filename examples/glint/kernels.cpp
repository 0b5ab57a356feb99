#include "kernels.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <mica/law/bernoulli_sum.hpp>
#include <mica/law/dual_gated.hpp>
#include <mica/law/exact.hpp>
#include <mica/law/floored_gated.hpp>
#include <mica/law/gated.hpp>
#include <mica/law/gaussian.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>

namespace glint {

namespace {

/// DB23's law with its gate as published, which fails for small p.
using published_gated = mica::basic_floored_gated_binomial<mica::naive_gate>;

template <std::size_t K, class Kernel>
compiled_kernel compiled(const Kernel& kernel) {
    return {[kernel](const mica::shading_point<float>& point, const mica::glint_material& material,
                     std::span<const mica::light_class<float>> classes, mica::vector3<float> half_vector,
                     std::uint32_t seed) {
                std::array<mica::light_class<float>, K> all;
                std::copy_n(classes.begin(), K, all.begin());
                return kernel(point, material, all, half_vector, seed);
            },
            [](std::size_t categories) { return Kernel::binomials(categories); }};
}

template <std::size_t K = 1, class Kernel>
compiled_kernel for_classes(std::size_t classes, const Kernel& kernel) {
    if (classes == K) return compiled<K>(kernel);
    if constexpr (K < most_classes) return for_classes<K + 1>(classes, kernel);
    throw std::invalid_argument(std::to_string(classes) + " classes of light are not compiled in (1 to 8 are)");
}

template <class Law, class Interpolation, class Effects = mica::effects<>>
compiled_kernel kernel_of(std::size_t classes, Interpolation interpolation, Effects effects = {}) {
    return for_classes(classes, mica::glint_kernel<Law, Interpolation, Effects>{interpolation, effects});
}

/// Effects one after the other: each is there or not.
template <class Interpolation, class... Chosen>
compiled_kernel with_tolerance(const effects_description& asked, std::size_t classes, Interpolation interpolation,
                               Chosen... chosen) {
    using law = mica::quantile_binomial<4>;
    if (asked.smooth_tolerance)
        return kernel_of<law>(classes, interpolation,
                              mica::effects<Chosen..., mica::smooth_where_dense>{chosen..., {*asked.smooth_tolerance}});
    return kernel_of<law>(classes, interpolation, mica::effects<Chosen...>{chosen...});
}

template <class Interpolation, class... Chosen>
compiled_kernel with_tint(const effects_description& asked, std::size_t classes, Interpolation interpolation,
                          Chosen... chosen) {
    if (asked.tint) return with_tolerance(asked, classes, interpolation, chosen..., mica::tinted_glints{*asked.tint});
    return with_tolerance(asked, classes, interpolation, chosen...);
}

template <class Interpolation, class... Chosen>
compiled_kernel with_density(const effects_description& asked, std::size_t classes, Interpolation interpolation,
                             Chosen... chosen) {
    if (asked.varied_density)
        return with_tint(asked, classes, interpolation, chosen..., mica::varied_density{*asked.varied_density});
    return with_tint(asked, classes, interpolation, chosen...);
}

compiled_kernel with_effects(const counting_description& counting, std::size_t classes) {
    const auto& asked = counting.effects;
    const bool counts = counting.interpolate == "counts";
    if (counting.law != "quantile" && counting.law != "quantile:4")
        throw std::invalid_argument("effects are not compiled in for law '" + counting.law +
                                    "' (for quantile they are)");
    if (asked.one_grid) {
        if (!counts) throw std::invalid_argument("one_grid is for counts: variates have no grids to leave out");
        if (asked.varied_density || asked.tint || asked.smooth_tolerance)
            throw std::invalid_argument("one_grid is not compiled in with other effects than angular_grid");
        if (asked.angular_grid)
            return kernel_of<mica::quantile_binomial<4>>(
                classes, mica::interpolated_counts{},
                mica::effects<mica::one_grid, mica::angular_grid>{{}, {*asked.angular_grid}});
        return kernel_of<mica::quantile_binomial<4>>(classes, mica::interpolated_counts{},
                                                     mica::effects<mica::one_grid>{});
    }
    if (counts) {
        if (!asked.angular_grid || asked.varied_density || asked.tint || asked.smooth_tolerance)
            throw std::invalid_argument("counts are not compiled in with other effects than angular_grid, one_grid");
        return kernel_of<mica::quantile_binomial<4>>(classes, mica::interpolated_counts{},
                                                     mica::effects<mica::angular_grid>{{*asked.angular_grid}});
    }
    if (counting.softness > 0) throw std::invalid_argument("softness is not compiled in with effects");
    if (asked.angular_grid)
        return with_density(asked, classes, mica::blended_variates{}, mica::angular_grid{*asked.angular_grid});
    return with_density(asked, classes, mica::blended_variates{});
}

/// Calls body(Law{}) with the law of that name.
template <class Body>
compiled_kernel with_law(const std::string& name, const Body& body) {
    if (name == "none") return body(mica::no_glints{});
    if (name == "quantile" || name == "quantile:4") return body(mica::quantile_binomial<4>{});
    if (name == "quantile:8") return body(mica::quantile_binomial<8>{});
    if (name == "smooth_quantile" || name == "smooth_quantile:4") return body(mica::smooth_quantile_binomial<4>{});
    if (name == "dual_gated") return body(mica::dual_gated_binomial{});
    if (name == "gated") return body(mica::gated_binomial{});
    if (name == "published_gated") return body(published_gated{});
    if (name == "floored_gated") return body(mica::floored_gated_binomial{});
    if (name == "bernoulli_sum") return body(mica::bernoulli_sum_binomial{});
    if (name == "gaussian") return body(mica::gaussian_binomial{});
    if (name == "exact") return body(mica::exact_binomial{});
    throw std::invalid_argument("unknown law '" + name + "' (known: " + known_laws + ")");
}

template <class... Law>
constexpr bool is_one_of(auto law) {
    return (std::is_same_v<decltype(law), Law> || ...);
}

} // namespace

compiled_kernel find_kernel(const counting_description& counting, std::size_t classes) {
    const std::string &law_name = counting.law, &interpolate = counting.interpolate;
    const double softness = counting.softness;
    if (!(softness >= 0 && softness < 1))
        throw std::invalid_argument("--softness " + std::to_string(softness) + " is not in [0, 1)");
    if (interpolate != "variates" && interpolate != "counts")
        throw std::invalid_argument("unknown interpolation '" + interpolate + "' (known: variates, counts)");
    if (softness > 0 && interpolate == "counts")
        throw std::invalid_argument("--softness is for --interpolate variates");
    return with_law(law_name, [&](auto law) {
        using Law = decltype(law);
        if (counting.effects.any()) return with_effects(counting, classes);
        if (softness > 0) {
            if constexpr (is_one_of<mica::quantile_binomial<4>, mica::quantile_binomial<8>>(Law{}))
                return kernel_of<Law>(classes, mica::softened_variates{static_cast<float>(softness)});
            throw std::invalid_argument("--softness needs --law quantile");
        }
        if (interpolate == "counts") {
            if constexpr (is_one_of<mica::quantile_binomial<4>, mica::dual_gated_binomial>(Law{}))
                return kernel_of<Law>(classes, mica::interpolated_counts{});
            // As they were published: for one light.
            if constexpr (is_one_of<mica::floored_gated_binomial, published_gated>(Law{}))
                if (classes == 1) return compiled<1>(mica::glint_kernel<Law, mica::interpolated_counts>{});
            throw std::invalid_argument("counts are not compiled in for law '" + law_name +
                                        "' (for quantile and dual_gated they are)");
        }
        return kernel_of<Law>(classes, mica::blended_variates{});
    });
}

} // namespace glint
