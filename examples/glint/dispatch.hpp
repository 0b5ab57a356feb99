// From names and numbers on the command line to the types that the library is compiled for.
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include <mica/grid/distributed.hpp>
#include <mica/law/bernoulli_sum.hpp>
#include <mica/law/dual_gated.hpp>
#include <mica/law/exact.hpp>
#include <mica/law/floored_gated.hpp>
#include <mica/law/gated.hpp>
#include <mica/law/gaussian.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>

namespace glint {

/// Numbers of levels that the program is compiled for.
using compiled_levels = std::index_sequence<2, 3, 4, 5, 6, 7, 8>;

/// The names that with_law() knows.
inline constexpr char known_laws[] = "gaussian, bernoulli_sum, floored_gated, gated, dual_gated, quantile, quantile:4, "
                                     "quantile:8, smooth_quantile, smooth_quantile:4, exact";

/// Calls body(Law{}) with the law of that name.
template <class Body>
void with_law(const std::string& name, const Body& body) {
    if (name == "quantile" || name == "quantile:4") return body(mica::quantile_binomial<4>{});
    if (name == "quantile:8") return body(mica::quantile_binomial<8>{});
    if (name == "smooth_quantile" || name == "smooth_quantile:4") return body(mica::smooth_quantile_binomial<4>{});
    if (name == "dual_gated") return body(mica::dual_gated_binomial{});
    if (name == "gated") return body(mica::gated_binomial{});
    if (name == "floored_gated") return body(mica::floored_gated_binomial{});
    if (name == "bernoulli_sum") return body(mica::bernoulli_sum_binomial{});
    if (name == "gaussian") return body(mica::gaussian_binomial{});
    if (name == "exact") return body(mica::exact_binomial{});
    throw std::invalid_argument("unknown law '" + name + "' (known: " + known_laws + ")");
}

/// Calls body(interpolation) with what makes a pixel's counts of its vertices, for a law.
template <class Law, class Body>
void with_interpolation(const std::string& name, double softness, Law, const Body& body) {
    if (!(softness >= 0 && softness < 1))
        throw std::invalid_argument("--softness " + std::to_string(softness) + " is not in [0, 1)");
    if (name != "variates" && name != "counts")
        throw std::invalid_argument("unknown interpolation '" + name + "' (known: variates, counts)");
    if (softness > 0) {
        if constexpr (requires { Law::softened(1.F, 0.5F, 0.F, 0.1F); }) {
            if (name == "counts") throw std::invalid_argument("--softness is for --interpolate variates");
            return body(mica::softened_variates{static_cast<float>(softness)});
        } else {
            throw std::invalid_argument("--softness needs --law quantile");
        }
    }
    if (name == "variates") return body(mica::blended_variates{});
    return body(mica::interpolated_counts{});
}

namespace detail {

template <class Body, std::size_t First, std::size_t... More>
decltype(auto) with_levels(std::size_t levels, const Body& body, std::index_sequence<First, More...>) {
    if constexpr (sizeof...(More) == 0) {
        return body(std::integral_constant<std::size_t, First>{});
    } else {
        if (levels == First) return body(std::integral_constant<std::size_t, First>{});
        return with_levels(levels, body, std::index_sequence<More...>{});
    }
}

template <std::size_t... K>
bool contains(std::size_t levels, std::index_sequence<K...>) {
    return ((levels == K) || ...);
}

} // namespace detail

/// Calls body(std::integral_constant<std::size_t, K>{}) with K = levels.
template <class Body>
decltype(auto) with_levels(int levels, const Body& body) {
    const std::string text = std::to_string(levels);
    if (levels < 2) throw std::invalid_argument("--levels " + text + " is below 2 (one level is the dark)");
    const auto k = static_cast<std::size_t>(levels);
    if (!detail::contains(k, compiled_levels{}))
        throw std::invalid_argument("--levels " + text + " is not compiled in (2 to 8 are)");
    return detail::with_levels(k, body, compiled_levels{});
}

} // namespace glint
