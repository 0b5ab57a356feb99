// mica/law/batch.hpp: many draws at once, as many side by side as the registers hold.
//
//     sample(law, trials, probabilities, seed, successes)       binomial counts, parameters of their own for each
//     sample(law, trials, probability, seed, successes)         the same parameters for all
//     sample(multinomial<K, Law>{}, trials, probabilities, seed, counts)      probabilities and counts by category
//
// Element i is what the scalar law gives with uniform_stream<Real>{seed, first + i}. It does not depend on the number of
// lanes (to the last bit when floating contraction is off), and a second call with first = n goes on where n elements
// ended. Real is float or double; parameters, error and cost are the law's. A seed has 2^32 elements.
//
// Spans of equal length; where the lengths differ the shortest counts (MICA_CHECKED: fails). The output may be one of the
// inputs, but must not overlap them otherwise.
//
// Needs no flag but the target's -march. By default two registers full are drawn side by side.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "../numeric/pack_pair.hpp"
#include "../random/uniform_stream.hpp"
#include "binomial_law.hpp"
#include "multinomial.hpp"

namespace mica {

namespace detail {

/// The number type of `Lanes` lanes: a pack, or a pair of packs where that fills two registers.
template <class Real, int Lanes>
using batch_number =
    std::conditional_t<Lanes == 2 * native_lanes<Real>, pack_pair<pack<Real, Lanes / 2>>, pack<Real, Lanes>>;

template <class Real>
inline constexpr int batch_lanes = 2 * native_lanes<Real>;

/// Elements [first, first + size) of a range, at most as many as a number has lanes.
struct lane_range {
    std::size_t first;
    std::size_t size;
};

/// Lanes beyond the range are 0.
template <class Number>
Number load(std::span<const scalar_of<Number>> from, lane_range range) {
    if (range.size == static_cast<std::size_t>(lanes_of<Number>)) return Number::load(from.data() + range.first);
    std::array<scalar_of<Number>, lanes_of<Number>> lanes{};
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(range.first), range.size, lanes.begin());
    return Number::load(lanes.data());
}

template <class Number>
void store(Number value, std::span<scalar_of<Number>> to, lane_range range) {
    if (range.size == static_cast<std::size_t>(lanes_of<Number>)) return value.store(to.data() + range.first);
    std::array<scalar_of<Number>, lanes_of<Number>> lanes;
    value.store(lanes.data());
    std::copy_n(lanes.begin(), range.size, to.begin() + static_cast<std::ptrdiff_t>(range.first));
}

/// Calls body(range, stream) as often as it takes `size` elements, the last time perhaps not with all lanes.
template <class Number, class Body>
void each_range(std::size_t size, std::uint32_t seed, std::uint32_t first, const Body& body) {
    using Index = index_of<Number>;
    constexpr std::size_t lanes = lanes_of<Number>;
    for (std::size_t i = 0; i < size; i += lanes) {
        const lane_range range{i, (std::min)(lanes, size - i)};
        body(range, uniform_stream<Number>(Index(seed), Index::iota(first + static_cast<std::uint32_t>(i))));
    }
}

template <class Number, class Law>
MICA_FLATTEN void sample(const Law& law, std::span<const scalar_of<Number>> trials,
                         std::span<const scalar_of<Number>> probabilities, std::uint32_t seed,
                         std::span<scalar_of<Number>> successes, std::uint32_t first) {
    MICA_ASSERT(trials.size() == successes.size() && probabilities.size() == successes.size());
    const std::size_t size = (std::min)({trials.size(), probabilities.size(), successes.size()});
    each_range<Number>(size, seed, first, [&](lane_range range, uniform_stream<Number> xi) {
        store(law(load<Number>(trials, range), load<Number>(probabilities, range), xi).successes, successes, range);
    });
}

template <class Number, class Law>
MICA_FLATTEN void sample(const Law& law, scalar_of<Number> trials, scalar_of<Number> probability, std::uint32_t seed,
                         std::span<scalar_of<Number>> successes, std::uint32_t first) {
    each_range<Number>(successes.size(), seed, first, [&](lane_range range, uniform_stream<Number> xi) {
        store(law(Number(trials), Number(probability), xi).successes, successes, range);
    });
}

template <class Number, std::size_t K, class Law>
MICA_FLATTEN void sample(const multinomial<K, Law>& law, std::span<const scalar_of<Number>> trials,
                         const std::array<std::span<const scalar_of<Number>>, K>& probabilities, std::uint32_t seed,
                         const std::array<std::span<scalar_of<Number>>, K>& counts, std::uint32_t first) {
    std::size_t size = trials.size();
    for (std::size_t k = 0; k < K; ++k) {
        MICA_ASSERT(probabilities[k].size() == trials.size() && counts[k].size() == trials.size());
        size = (std::min)({size, probabilities[k].size(), counts[k].size()});
    }
    each_range<Number>(size, seed, first, [&](lane_range range, uniform_stream<Number> xi) {
        std::array<Number, K> p;
        for (std::size_t k = 0; k < K; ++k) p[k] = load<Number>(probabilities[k], range);
        const std::array<Number, K> drawn = law(load<Number>(trials, range), p, xi);
        for (std::size_t k = 0; k < K; ++k) store(drawn[k], counts[k], range);
    });
}

} // namespace detail

// One overload for float and one for double, not a template over both: so that vectors and arrays convert to spans.

/// successes[i] of trials[i] facets, each with probabilities[i].
template <int Lanes = detail::batch_lanes<float>, binomial_law<detail::batch_number<float, Lanes>> Law>
void sample(const Law& law, std::span<const float> trials, std::span<const float> probabilities, std::uint32_t seed,
            std::span<float> successes, std::uint32_t first = 0) {
    detail::sample<detail::batch_number<float, Lanes>>(law, trials, probabilities, seed, successes, first);
}
/// The same in double.
template <int Lanes = detail::batch_lanes<double>, binomial_law<detail::batch_number<double, Lanes>> Law>
void sample(const Law& law, std::span<const double> trials, std::span<const double> probabilities, std::uint32_t seed,
            std::span<double> successes, std::uint32_t first = 0) {
    detail::sample<detail::batch_number<double, Lanes>>(law, trials, probabilities, seed, successes, first);
}

/// The same with one number of trials and one probability for all.
template <int Lanes = detail::batch_lanes<float>, binomial_law<detail::batch_number<float, Lanes>> Law>
void sample(const Law& law, float trials, float probability, std::uint32_t seed, std::span<float> successes,
            std::uint32_t first = 0) {
    detail::sample<detail::batch_number<float, Lanes>>(law, trials, probability, seed, successes, first);
}
/// The same in double.
template <int Lanes = detail::batch_lanes<double>, binomial_law<detail::batch_number<double, Lanes>> Law>
void sample(const Law& law, double trials, double probability, std::uint32_t seed, std::span<double> successes,
            std::uint32_t first = 0) {
    detail::sample<detail::batch_number<double, Lanes>>(law, trials, probability, seed, successes, first);
}

/// counts[k][i] of trials[i] facets, each in category k with probabilities[k][i].
template <int Lanes = detail::batch_lanes<float>, std::size_t K, binomial_law<detail::batch_number<float, Lanes>> Law>
void sample(const multinomial<K, Law>& law, std::span<const float> trials,
            const std::array<std::span<const float>, K>& probabilities, std::uint32_t seed,
            const std::array<std::span<float>, K>& counts, std::uint32_t first = 0) {
    detail::sample<detail::batch_number<float, Lanes>>(law, trials, probabilities, seed, counts, first);
}
/// The same in double.
template <int Lanes = detail::batch_lanes<double>, std::size_t K, binomial_law<detail::batch_number<double, Lanes>> Law>
void sample(const multinomial<K, Law>& law, std::span<const double> trials,
            const std::array<std::span<const double>, K>& probabilities, std::uint32_t seed,
            const std::array<std::span<double>, K>& counts, std::uint32_t first = 0) {
    detail::sample<detail::batch_number<double, Lanes>>(law, trials, probabilities, seed, counts, first);
}

} // namespace mica
