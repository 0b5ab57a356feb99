// mica/law/smooth_quantile.hpp: the quantile law's real-valued twin, for shading, where an integer step along a smooth
// gradient shows.
//
// With m = floor(N) >= 1, f = N - m, G = Gates, p <= 1/2, ramp(x) = clamp(x + 1/2, 0, 1), S_k = P(X > k) and
// pmf_k = P(X = k) of M trials, and s, d, w, z as in law/quantile.hpp:
//
//     A_M  = sum over k < G of ramp(2 (1/pmf_k + 1/pmf_(k+1)) (c_k - xi))
//     c_k  = S_k, but the last one, where it has a tail beyond it (M > G):
//            S_(G-1) - pmf_G (1 - h^4) / 12  + bend,   h = max(0, G + 1/4 - N p) / (0.7 (G + 1))
//     bend = f (1-f) p^2 pmf_(G-1) / 2 for N > G + 1, pmf that of m trials, else 0
//     g(z) = clamp(N p + s z + d (z^2-1)/6 + z [1 + 14w - (1+2w) z^2] / (72 s), 0, N),   z in [-3s, (4+5d) s]
//     n    = (1-f) A_m + f A_(m+1) + clamp(N - G, 0, 1) max(0, g - G);   g at G + 1 trials where N is below that
//
// A_(m+1) comes almost free from the recursion for m trials: pmf_k(m+1) = q pmf_k + p pmf_(k-1), S_k(m+1) = S_k + p
// pmf_k. The ramps keep the mean of the steps they replace. g has the moments of X, so beyond the gates the sum
// P(X > G) + P(X > G + 1) + ... is the integral of max(0, g - G) less pmf_G / 12 (Euler and Maclaurin), taken off the
// last gate; h fades that where N p is small and g poor (a fit, for all G). That tail is evaluated once, at real N; it
// lies below the interpolated one by half its second difference in N, which is p^2 pmf_(G-1): the bend.
//
// For N > G and p from 0.45 to 0.5, n is blended into g, symmetric at p = 1/2, so that there is no seam where successes
// and failures change places. p > 1/2 evaluates the failures at 1 - xi. N < 1 has one ramp for a success at N p and one
// for a failure at 1 - N q.
//
// Source: mica's own.
// Draws: one uniform.
// Output: real counts; successes + failures = N exactly for N >= 1, in expectation below. Continuous in xi, N and p.
// Error, with 4 gates and N p up to 300: relative mean error 4e-4 for real N, 1.5e-4 at integers N >= 8. Variance at
//   integer N >= 1 up to 8.4 % too small, where N p is small; up to 22 % between 1 and 2, 12 % beyond 3
//   (tests/smooth_quantile_test.cpp). Relative mean error with 1, 2, 5, 8 gates: 8e-2, 5e-3, 3e-4, 1.2e-4.
// Numerics: S_k comes by subtraction, so a ramp is misplaced by up to 6e-8 N p in xi. Where xi or 1 - xi is below 1e-3
//   the count can therefore step by more than 1e-3 from one float N or p to the next.
#pragma once

#include "../numeric/elementary.hpp"
#include "binomial_law.hpp"
#include "rarer_side.hpp"

namespace mica {

namespace detail {

template <real_number Real>
struct pair_of {
    Real first;
    Real second;
};

/// Smaller uniforms count as this. A ramp is at least 1e-18 wide, and reaches half as far below its step: a smaller uniform
/// would give half a success where N or p is 0.
inline constexpr float smallest_told_apart = 0x1p-58F;

/// 2 / a and 2 / b by one division. Below 1e-18, where no uniform tells a ramp from a step, those of 1e-18.
template <real_number Real>
MICA_HOST_DEVICE constexpr pair_of<Real> twice_reciprocals(Real a, Real b) {
    const Real x = maximum(a, Real(1e-18F));
    const Real y = maximum(b, Real(1e-18F));
    const Real both = Real(2) / (x * y);
    return {y * both, x * both};
}

/// From 0 to 1 where x goes from -1/2 to 1/2.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real ramp(Real x) {
    return clamp(x + Real(0.5), Real(0), Real(1));
}

/// g(z) for real trials m and p <= 1/2.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real smooth_expansion(Real m, Real p, Real z) {
    using Scalar = scalar_of<Real>;
    const Real w = p * (Real(1) - p);
    const Real d = Real(1) - p - p;
    const Real s = mica::sqrt(maximum(m * w, Real(1e-8F)));
    const Real x = clamp(z, Real(-3) * s, (Real(4) + Real(5) * d) * s);
    const Real x2 = x * x;
    const Real skewness = d * (x2 - Real(1)) * Real(Scalar(1) / 6);
    const Real kurtosis = x * (Real(1) + Real(14) * w - (Real(1) + Real(2) * w) * x2) / (Real(72) * s);
    return clamp(m * p + s * x + (skewness + kurtosis), Real(0), m);
}

/// N between the whole numbers of trials next to it, at least 1, and what the recursions of both start from.
template <real_number Real>
struct whole_trials {
    Real whole;    ///< the lower one, floor N
    Real part;     ///< N - floor N
    Real exponent; ///< log P(X = 0) of floor N trials
    Real none;     ///< P(X = 0)
};

template <real_number Real>
MICA_HOST_DEVICE constexpr whole_trials<Real> make_whole_trials(Real n, Real p) {
    // The recursion multiplies q^N by up to (N p/q)^Gates, so q^N has to underflow to zero.
    const Real whole = maximum(truncate(n), Real(1));
    const Real exponent = whole * log_complement(p);
    return {whole, clamp(n - whole, Real(0), Real(1)), exponent, mica::exp(exponent)};
}

/// What is added to S_(G-1) of floor N and of floor N + 1 trials, so that the tail beyond the gates has its sum: see above.
template <int Gates, real_number Real>
MICA_HOST_DEVICE constexpr pair_of<Real> last_gate(Real n, Real whole, Real part, Real p, Real mass, Real following,
                                                   Real following_next) {
    using Scalar = scalar_of<Real>;
    constexpr Scalar gates = Gates;
    const Real scarce = maximum(Real(0), (Real(gates + Scalar(0.25)) - n * p) * Real(1 / (Scalar(0.7) * (gates + 1))));
    const Real square = scarce * scarce;
    const Real twelfth = (Real(1) - square * square) * Real(Scalar(1) / 12);
    const Real curvature = Real(0.5) * part * (Real(1) - part) * p * p;
    const Real bend = select(n > Real(gates + 1), curvature * mass, Real(0));
    return {bend - select(whole > Real(gates), twelfth * following, Real(0)),
            bend - select(whole >= Real(gates), twelfth * following_next, Real(0))};
}

/// The expected number of gates that are passed, between those of floor N and of floor N + 1 trials. `above` is S_0 of floor
/// N trials less what is to be taken off every S_k; step({S_k, S_k of one more}, {pmf_(k+1), pmf_(k+1) of one more}) gives
/// what gate k contributes to each.
template <int Gates, real_number Real, class Step>
MICA_HOST_DEVICE constexpr pair_of<Real> passed_gates(Real n, Real p, const whole_trials<Real>& trials, Real above,
                                                      Step&& step) {
    using Scalar = scalar_of<Real>;
    const Real q = Real(1) - p, odds = p / q;
    Real mass = trials.none; // pmf_k of floor N trials
    pair_of<Real> passed{Real(0), Real(0)};
    MICA_UNROLL
    for (int gate = 0; gate < Gates; ++gate) {
        const auto k = static_cast<Scalar>(gate);
        const Real following = mass * (maximum(trials.whole - Real(k), Real(0)) * odds * Real(1 / (k + 1)));
        const Real following_next = q * following + p * mass;
        pair_of<Real> centre{above, above + p * mass};
        if (gate == Gates - 1) {
            const auto last = last_gate<Gates>(n, trials.whole, trials.part, p, mass, following, following_next);
            centre = {centre.first + last.first, centre.second + last.second};
        }
        const pair_of<Real> steps = step(centre, pair_of<Real>{following, following_next});
        passed = {passed.first + steps.first, passed.second + steps.second};
        above = above - following;
        mass = following;
    }
    // S_k that should be 0 (k >= whole) has the rounding of the subtractions.
    return {minimum(passed.first, trials.whole), passed.second};
}

/// The trials of which the tail beyond the gates is taken. Between G and G + 1 only the larger neighbour has a tail.
template <int Gates, real_number Real>
MICA_HOST_DEVICE constexpr Real trials_with_tail(Real n) {
    return maximum(n, Real(scalar_of<Real>(Gates) + 1));
}

/// The passed gates (`at_next` those of floor N + 1 trials) and the tail beyond them; near p = 1/2 the expansion that has
/// the tail, whole.
template <int Gates, real_number Real>
MICA_HOST_DEVICE constexpr Real with_tail(Real n, Real p, Real gated, Real at_next, Real beyond, Real expansion) {
    constexpr scalar_of<Real> gates = Gates;
    const Real weight = clamp(n - Real(gates), Real(0), Real(1));
    const Real blend = clamp((p - Real(0.45F)) * Real(20), Real(0), Real(1));
    const Real replaced = select(n < Real(gates + 1), at_next, gated) + beyond;
    return minimum(gated + weight * (beyond + blend * (expansion - replaced)), n);
}

/// N <= 1: the rarer outcome, nothing, the other, with probabilities N p, 1 - N, N q.
template <real_number Real>
MICA_HOST_DEVICE constexpr pair_of<Real> lone_facet(Real n, const rarer_side<Real>& side) {
    const Real rare = n * side.probability, common = n * (Real(1) - side.probability);
    const auto steepness = twice_reciprocals(rare * (Real(1) - rare), common * (Real(1) - common));
    const auto& xi = side.variate;
    const Real rest = Real(1) - xi.distance;
    const Real tail = select(xi.many, xi.distance, rest), head = select(xi.many, rest, xi.distance);
    return {ramp((rare - tail) * steepness.first), ramp((common - head) * steepness.second)};
}

} // namespace detail

/// Gates in 1..16: how many small counts have steps (ramps) of their exact probability.
template <int Gates>
struct smooth_quantile_binomial {
    static_assert(Gates >= 1 && Gates <= 16, "a quantile law has 1 to 16 gates");
    static constexpr bool integer_counts = false; ///< successes and failures are real numbers

    /// The counts; arguments as in binomial_law.hpp. Draws one uniform.
    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        using Scalar = scalar_of<Real>;
        constexpr Scalar gates = Gates;
        const auto [n, success_probability] = detail::in_domain(trials, probability);
        const auto side =
            detail::make_rarer_side(success_probability, maximum(xi(), Real(detail::smallest_told_apart)));
        const Real p = side.probability;
        const auto whole_trials = detail::make_whole_trials(n, p);
        const Real part = whole_trials.part;
        auto steepness = detail::twice_reciprocals(whole_trials.none, (Real(1) - p) * whole_trials.none);
        const auto [at_whole, at_next] = detail::passed_gates<Gates>(
            n, p, whole_trials,
            detail::any_less_tail(side.variate, whole_trials.exponent, whole_trials.none), // S_0 - xi
            [&](detail::pair_of<Real> centre, detail::pair_of<Real> following) {
                const auto next = detail::twice_reciprocals(following.first, following.second);
                detail::pair_of<Real> steps{detail::ramp(centre.first * (steepness.first + next.first)),
                                            detail::ramp(centre.second * (steepness.second + next.second))};
                steepness = next;
                return steps;
            });
        const Real gated = at_whole + part * (at_next - at_whole);

        const Real expansion = detail::smooth_expansion(detail::trials_with_tail<Gates>(n), p, side.variate.z);
        const Real beyond = maximum(Real(0), expansion - Real(gates));
        const Real drawn = detail::with_tail<Gates>(n, p, gated, at_next, beyond, expansion);

        const auto below_one = n < Real(1);
        const auto [lone_rarer, lone_other] = detail::lone_facet(minimum(n, Real(1)), side);
        const Real rarer = select(below_one, lone_rarer, drawn);
        const Real others = select(below_one, lone_other, n - drawn);
        return {select(side.failures, others, rarer), select(side.failures, rarer, others)};
    }
};

} // namespace mica
