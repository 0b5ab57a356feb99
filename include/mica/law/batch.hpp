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
// Needs no flag but the target's -march: native_lanes<Real> are as many as its registers hold.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "../numeric/pack.hpp"
#include "../random/uniform_stream.hpp"
#include "binomial_law.hpp"
#include "multinomial.hpp"

namespace mica {

namespace detail {

/// Elements [first, first + size) of a range, at most as many as a pack has lanes.
struct pack_range {
    std::size_t first;
    std::size_t size;
};

/// Lanes beyond the range are 0.
template <class Pack>
Pack load(std::span<const scalar_of<Pack>> from, pack_range range) {
    if (range.size == static_cast<std::size_t>(lanes_of<Pack>)) return Pack::load(from.data() + range.first);
    std::array<scalar_of<Pack>, lanes_of<Pack>> lanes{};
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(range.first), range.size, lanes.begin());
    return Pack::load(lanes.data());
}

template <class Pack>
void store(Pack value, std::span<scalar_of<Pack>> to, pack_range range) {
    if (range.size == static_cast<std::size_t>(lanes_of<Pack>)) return value.store(to.data() + range.first);
    std::array<scalar_of<Pack>, lanes_of<Pack>> lanes;
    value.store(lanes.data());
    std::copy_n(lanes.begin(), range.size, to.begin() + static_cast<std::ptrdiff_t>(range.first));
}

/// Calls body(range, stream) for the packs of `size` elements, the last perhaps not full.
template <class Pack, class Body>
void each_pack(std::size_t size, std::uint32_t seed, std::uint32_t first, const Body& body) {
    using Index = index_of<Pack>;
    constexpr std::size_t lanes = lanes_of<Pack>;
    for (std::size_t i = 0; i < size; i += lanes) {
        const pack_range range{i, (std::min)(lanes, size - i)};
        body(range, uniform_stream<Pack>(Index(seed), Index::iota(first + static_cast<std::uint32_t>(i))));
    }
}

template <class Pack, class Law>
void sample(const Law& law, std::span<const scalar_of<Pack>> trials, std::span<const scalar_of<Pack>> probabilities,
            std::uint32_t seed, std::span<scalar_of<Pack>> successes, std::uint32_t first) {
    MICA_ASSERT(trials.size() == successes.size() && probabilities.size() == successes.size());
    const std::size_t size = (std::min)({trials.size(), probabilities.size(), successes.size()});
    each_pack<Pack>(size, seed, first, [&](pack_range range, uniform_stream<Pack> xi) {
        store(law(load<Pack>(trials, range), load<Pack>(probabilities, range), xi).successes, successes, range);
    });
}

template <class Pack, class Law>
void sample(const Law& law, scalar_of<Pack> trials, scalar_of<Pack> probability, std::uint32_t seed,
            std::span<scalar_of<Pack>> successes, std::uint32_t first) {
    each_pack<Pack>(successes.size(), seed, first, [&](pack_range range, uniform_stream<Pack> xi) {
        store(law(Pack(trials), Pack(probability), xi).successes, successes, range);
    });
}

template <class Pack, std::size_t K, class Law>
void sample(const multinomial<K, Law>& law, std::span<const scalar_of<Pack>> trials,
            const std::array<std::span<const scalar_of<Pack>>, K>& probabilities, std::uint32_t seed,
            const std::array<std::span<scalar_of<Pack>>, K>& counts, std::uint32_t first) {
    std::size_t size = trials.size();
    for (std::size_t k = 0; k < K; ++k) {
        MICA_ASSERT(probabilities[k].size() == trials.size() && counts[k].size() == trials.size());
        size = (std::min)({size, probabilities[k].size(), counts[k].size()});
    }
    each_pack<Pack>(size, seed, first, [&](pack_range range, uniform_stream<Pack> xi) {
        std::array<Pack, K> p;
        for (std::size_t k = 0; k < K; ++k) p[k] = load<Pack>(probabilities[k], range);
        const std::array<Pack, K> drawn = law(load<Pack>(trials, range), p, xi);
        for (std::size_t k = 0; k < K; ++k) store(drawn[k], counts[k], range);
    });
}

} // namespace detail

// One overload for float and one for double, not a template over both: so that vectors and arrays convert to spans.

/// successes[i] of trials[i] facets, each with probabilities[i].
template <int Lanes = native_lanes<float>, binomial_law<pack<float, Lanes>> Law>
void sample(const Law& law, std::span<const float> trials, std::span<const float> probabilities, std::uint32_t seed,
            std::span<float> successes, std::uint32_t first = 0) {
    detail::sample<pack<float, Lanes>>(law, trials, probabilities, seed, successes, first);
}
template <int Lanes = native_lanes<double>, binomial_law<pack<double, Lanes>> Law>
void sample(const Law& law, std::span<const double> trials, std::span<const double> probabilities, std::uint32_t seed,
            std::span<double> successes, std::uint32_t first = 0) {
    detail::sample<pack<double, Lanes>>(law, trials, probabilities, seed, successes, first);
}

/// The same with one number of trials and one probability for all.
template <int Lanes = native_lanes<float>, binomial_law<pack<float, Lanes>> Law>
void sample(const Law& law, float trials, float probability, std::uint32_t seed, std::span<float> successes,
            std::uint32_t first = 0) {
    detail::sample<pack<float, Lanes>>(law, trials, probability, seed, successes, first);
}
template <int Lanes = native_lanes<double>, binomial_law<pack<double, Lanes>> Law>
void sample(const Law& law, double trials, double probability, std::uint32_t seed, std::span<double> successes,
            std::uint32_t first = 0) {
    detail::sample<pack<double, Lanes>>(law, trials, probability, seed, successes, first);
}

/// counts[k][i] of trials[i] facets, each in category k with probabilities[k][i].
template <int Lanes = native_lanes<float>, std::size_t K, binomial_law<pack<float, Lanes>> Law>
void sample(const multinomial<K, Law>& law, std::span<const float> trials,
            const std::array<std::span<const float>, K>& probabilities, std::uint32_t seed,
            const std::array<std::span<float>, K>& counts, std::uint32_t first = 0) {
    detail::sample<pack<float, Lanes>>(law, trials, probabilities, seed, counts, first);
}
template <int Lanes = native_lanes<double>, std::size_t K, binomial_law<pack<double, Lanes>> Law>
void sample(const multinomial<K, Law>& law, std::span<const double> trials,
            const std::array<std::span<const double>, K>& probabilities, std::uint32_t seed,
            const std::array<std::span<double>, K>& counts, std::uint32_t first = 0) {
    detail::sample<pack<double, Lanes>>(law, trials, probabilities, seed, counts, first);
}

} // namespace mica
