// From names and numbers on the command line to the types that the library is compiled for.
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include <mica/law/dual_gated.hpp>
#include <mica/law/exact.hpp>
#include <mica/law/quantile.hpp>

namespace glint {

/// Numbers of levels that the program is compiled for.
using compiled_levels = std::index_sequence<2, 3, 4, 5, 6, 7, 8>;

/// Calls body(Law{}) with the law of that name.
template <class Body>
decltype(auto) with_law(const std::string& name, const Body& body) {
    if (name == "quantile") return body(mica::quantile_binomial<4>{});
    if (name == "dual_gated") return body(mica::dual_gated_binomial{});
    if (name == "exact") return body(mica::exact_binomial{});
    throw std::invalid_argument("unknown law '" + name + "' (known: quantile, dual_gated, exact)");
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
