// mica/law/multinomial.hpp: multinomial counts by a binary tree of binomials.
//
//     multinomial<K, Law>{}(trials, probabilities, xi) -> std::array<Real, K>
//     multinomial<std::dynamic_extent, Law>{}(trials, probabilities, xi, counts)      spans of equal length
//
// Every node gives its trials to its two halves by one binomial with the conditional probability of a half (KK25
// Sec. 6). Probabilities may sum to less than 1: the rest of the trials goes to an implicit category "none", split
// off first and not returned. (A sum within 4 epsilon of 1 is 1: rounding must not cost a trial.) K categories whose
// probabilities sum to 1 cost K - 1 binomials, otherwise K; whoever has a dimmest or default category leaves it out
// and pays K - 1 in either case.
//
// - With a law of integer counts, real trials are rounded to an integer once, at the root, and the counts (with
//   "none") sum to it exactly, up to 2^24 trials in float and to one ulp beyond. The dual-gated law dithers
//   every node below two trials, so there the sum is right in expectation only.
// - A category of probability 0 never receives anything.
// - Each node evaluates its less probable half, so a rare category keeps its relative accuracy wherever it stands in
//   the order: as 1 - p of a likely one, 1e-9 would be lost in float.
// - Each node has a stream of its own, forked from xi at the price of one draw, so the outcome is the same for every
//   lane count and for static and dynamic K. A source that cannot fork is drawn from in the order of the nodes.
// - Probabilities are clamped to [0,1] one by one and may sum to a few ulp more than 1; a NaN counts as 0. trials as
//   in binomial_law.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

#include "binomial_law.hpp"

namespace mica {

namespace detail {

template <class Uniform>
MICA_HOST_DEVICE constexpr decltype(auto) node_stream(Uniform& stream, std::uint32_t node) {
    if constexpr (requires { stream.substream(node); })
        return stream.substream(node);
    else
        return static_cast<Uniform&>(stream);
}

/// Successes and failures by a law, or what is expected of them where the source says that only part of its randomness is
/// known.
template <class Law, real_number Real, class Uniform>
MICA_HOST_DEVICE constexpr counts<Real> drawn_counts(Real trials, Real probability, Uniform& xi) {
    if constexpr (requires { xi.softness; })
        return Law::softened(trials, probability, xi.normal(), xi.softness);
    else
        return Law{}(trials, probability, xi);
}

/// Trials of a node, an integer for laws of integer counts, and a probability of at most 1/2.
template <class Law, real_number Real, class Uniform>
MICA_HOST_DEVICE constexpr counts<Real> divided(Real trials, Real probability, Uniform& xi) {
    if constexpr (
        !requires { xi.softness; } && requires { Law{}.rarer_successes(trials, probability, xi); }) {
        const Real successes = Law{}.rarer_successes(trials, probability, xi);
        return {successes, trials - successes};
    } else {
        return drawn_counts<Law>(trials, probability, xi);
    }
}

/// What the left and the right half of a node receive of its trials, given the halves' probabilities.
template <class Law, real_number Real, class Uniform>
MICA_FLATTEN MICA_HOST_DEVICE constexpr counts<Real> divide_trials(Real trials, Real left, Real right, Uniform&& xi) {
    const auto left_is_rarer = left <= right;
    const Real rarer = select(left_is_rarer, left, right);
    const Real total = left + right;
    const Real probability = select(total > Real(0), rarer / select(total > Real(0), total, Real(1)), Real(0));
    const counts<Real> drawn = divided<Law>(trials, probability, xi);
    // Both halves 0 happens only below a node whose probability is 0, and that has received nothing.
    return {select(left_is_rarer, drawn.successes, drawn.failures),
            select(left_is_rarer, drawn.failures, drawn.successes)};
}

/// The trials that go to any category at all, real trials rounded for laws of integer counts. `total` is the sum of
/// the probabilities.
template <class Law, real_number Real, class Uniform>
MICA_HOST_DEVICE constexpr Real categorised_trials(Real trials, Real total, Uniform& stream) {
    if constexpr (Law::integer_counts && !requires { stream.softness; }) {
        trials = dithered(trials, stream());
    }
    using Scalar = scalar_of<Real>;
    const auto complete = total >= Real(1 - 4 * std::numeric_limits<Scalar>::epsilon());
    if (all(complete)) return trials;
    auto&& node = node_stream(stream, 1U);
    return select(complete, trials, drawn_counts<Law>(trials, minimum(total, Real(1)), node).successes);
}

/// Nodes are numbered as in a heap: the root of the categories is 2, the children of m are 2m and 2m + 1.
inline constexpr std::uint32_t root_node = 2U;

} // namespace detail

/// K known when the program is compiled.
template <std::size_t K, class Law>
struct multinomial {
    static_assert(K >= 1, "a multinomial has at least one category");

    /// The count of every category.
    template <real_number Real, class Uniform>
        requires(binomial_law<Law, Real>)
    MICA_HOST_DEVICE constexpr std::array<Real, K>
    operator()(std::type_identity_t<Real> trials, const std::array<Real, K>& probabilities, Uniform&& xi) const {
        std::array<Real, K> p{};
        for (std::size_t k = 0; k < K; ++k) p[k] = detail::in_domain(trials, probabilities[k]).probability;
        auto&& stream = detail::forked(xi);
        const Real n = detail::in_domain(trials, Real(0)).trials;
        std::array<Real, K> result{};
        divide<0, K>(detail::categorised_trials<Law>(n, sum<0, K>(p), stream), p, stream, detail::root_node, result);
        return result;
    }

  private:
    template <std::size_t First, std::size_t Count, class Real>
    MICA_HOST_DEVICE static constexpr Real sum(const std::array<Real, K>& p) {
        if constexpr (Count == 1)
            return p[First];
        else
            return sum<First, (Count + 1) / 2>(p) + sum<First + (Count + 1) / 2, Count / 2>(p);
    }

    template <std::size_t First, std::size_t Count, class Real, class Uniform>
    MICA_HOST_DEVICE static constexpr void divide(Real trials, const std::array<Real, K>& p, Uniform& stream,
                                                  std::uint32_t node, std::array<Real, K>& result) {
        if constexpr (Count == 1) {
            result[First] = trials;
        } else {
            constexpr std::size_t left = (Count + 1) / 2;
            constexpr std::size_t right = Count / 2;
            const auto [to_left, to_right] = detail::divide_trials<Law>(
                trials, sum<First, left>(p), sum<First + left, right>(p), detail::node_stream(stream, node));
            divide<First, left>(to_left, p, stream, 2 * node, result);
            divide<First + left, right>(to_right, p, stream, 2 * node + 1, result);
        }
    }
};

/// K known at run time: counts[k] for probabilities[k]; no allocation, depth log2 K, O(K log K) additions.
template <class Law>
struct multinomial<std::dynamic_extent, Law> {
    /// Spans of equal, positive length; where the lengths differ the shorter counts.
    template <real_number Real, class Uniform>
        requires(binomial_law<Law, Real>)
    MICA_HOST_DEVICE constexpr void operator()(Real trials, std::span<const std::type_identity_t<Real>> probabilities,
                                               Uniform&& xi, std::span<std::type_identity_t<Real>> counts) const {
        MICA_ASSERT(probabilities.size() == counts.size());
        const std::size_t size = probabilities.size() < counts.size() ? probabilities.size() : counts.size();
        if (size == 0) return;
        auto&& stream = detail::forked(xi);
        const Real n = detail::in_domain(trials, Real(0)).trials;
        const Real categorised = detail::categorised_trials<Law>(n, sum<Real>(probabilities.first(size)), stream);
        divide<Real>(categorised, probabilities.first(size), stream, detail::root_node, counts.first(size));
    }

  private:
    template <class Real>
    MICA_HOST_DEVICE static constexpr Real sum(std::span<const Real> p) {
        if (p.size() == 1) return detail::in_domain(Real(0), p[0]).probability;
        const std::size_t left = (p.size() + 1) / 2;
        return sum(p.first(left)) + sum(p.subspan(left));
    }

    template <class Real, class Uniform>
    MICA_HOST_DEVICE static constexpr void divide(Real trials, std::span<const Real> p, Uniform& stream,
                                                  std::uint32_t node, std::span<Real> counts) {
        if (p.size() == 1) {
            counts[0] = trials;
            return;
        }
        const std::size_t left = (p.size() + 1) / 2;
        const auto [to_left, to_right] = detail::divide_trials<Law>(trials, sum(p.first(left)), sum(p.subspan(left)),
                                                                    detail::node_stream(stream, node));
        divide(to_left, p.first(left), stream, 2 * node, counts.first(left));
        divide(to_right, p.subspan(left), stream, 2 * node + 1, counts.subspan(left));
    }
};

} // namespace mica
