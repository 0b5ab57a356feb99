// mica/law/softened_quantile.hpp: the expected binomial count, given part of the randomness.
//
// A quantile law makes its count of one normal variate Z. Of Z = c z + s E, c = sqrt(1 - s^2), only z is known, E is
// standard normal and averaged over; s in [0, 1) is the softness. With S_k = P(X > k), G gates, X of M trials:
//
//     n_M(z) = sum over k < G of Phi((c z + Phi^-1(S_k)) / s)  +  E max(0, g(c z + s E) - G)
//
// The first terms are exact: E Phi((c Z + Phi^-1(S)) / s) = S, so they have the mean of the steps they replace. Beyond
// the gates g is the expansion of smooth_quantile.hpp, taken as linear in E between its values at c z - s and c z + s,
// where the expectation is (a - G) Phi(h) + b phi(h), h = (a - G) / b, with a half the sum of the two values and b half
// their difference. (The derivative of g instead would be unbounded as N p -> 0: it once gave 3.7 of 20 facets at p =
// 0.) S_(G-1) is corrected as there, and near p = 1/2 a takes the place of all, so that there is no seam. Real N:
// between the counts of floor N and floor N + 1 trials, linearly; N < 1 as there: one term for a success at N p, one
// for a failure.
//
// Source: mica's own.
// Output: real counts; successes + failures = N for N >= 1, in expectation below. Exactly 0 successes at p = 0, and 0
//   failures at p = 1. Continuous in z, N and p. s is limited to [1e-3, 1]: a law of integers is not among them, since
//   N is not rounded and nor is what lies beyond the gates.
// Error, 4 gates, N p from 1e-7 to 1e6: mean within 0.1 % for s up to 0.5, 1.5 % at 0.9. Of the variance, N p q + f
//   (1-f) p^2 with f the fraction of N, there is left at least, where the rarer of successes and failures has the mean
//   r = N min(p, q) (tests/blended_test.cpp):
//
//              whole N                              real N
//     s        r >= 0.75   r >= 0.1   r >= 0.01     r >= 0.75   r >= 0.1
//     0.05       96 %        94 %       92 %          69 %        24 %
//     0.1        92 %        88 %       84 %          67 %        22 %
//     0.25       81 %        72 %       62 %          62 %        20 %
//     0.5        61 %        45 %       30 %          48 %        12 %
//
//   Trials are not rounded, so the f (1-f) p^2 of rounding is missing. Where failures are rare that is nearly all of the
//   variance, and of real N nearly nothing is left (4 % at N = 1.5, p = 0.99). All of it falls with r: the flash of a rare
//   facet is spread over variates that differ by s.
#pragma once

#include "smooth_quantile.hpp"

namespace mica::detail {

/// The softened count of `Gates` gates, with variate z (large where successes are many) and softness s.
template <int Gates, real_number Real>
MICA_HOST_DEVICE constexpr counts<Real> softened_quantile(Real trials, Real probability, Real z, Real softness) {
    using Scalar = scalar_of<Real>;
    constexpr Scalar gates = Gates;
    const auto [n, success_probability] = in_domain(trials, probability);
    const auto failures_rarer = success_probability > Real(0.5);
    const Real p = minimum(success_probability, Real(1) - success_probability);
    const Real q = Real(1) - p;
    const Real s = clamp(softness, Real(1e-3F), Real(1));
    const Real c = mica::sqrt(Real(1) - s * s);
    const Real x = c * select(failures_rarer, -z, z);
    const Real one_over_s = Real(1) / s;
    const auto step = [&](Real tail, Real variate) { // Phi((variate + Phi^-1(tail)) / s), 0 for a tail of 0
        const auto positive = tail > Real(1e-9F);
        const Real inside = clamp(tail, Real(1e-9F), Real(1 - std::numeric_limits<Scalar>::epsilon() / 2));
        return select(positive, normal_cdf((variate + normal_quantile(inside)) * one_over_s), Real(0));
    };

    const auto whole_trials = make_whole_trials(n, p);
    const auto [at_whole, at_next] = passed_gates<Gates>(
        n, p, whole_trials, -mica::expm1(whole_trials.exponent), [&](pair_of<Real> tail, pair_of<Real>) {
            return pair_of<Real>{step(tail.first, x), step(tail.second, x)};
        });
    const Real gated = at_whole + whole_trials.part * (at_next - at_whole);

    // Two points, x - s and x + s, have the mean of a cubic under the normal variate x + s E; in their span g is taken as
    // linear. Values, not the slope, of g: it is limited far out and where N p is small, and its slope there is not.
    const Real m = trials_with_tail<Gates>(n);
    const Real low = smooth_expansion(m, p, x - s), high = smooth_expansion(m, p, x + s);
    const Real expansion = Real(0.5) * (low + high), excess = expansion - Real(gates);
    const Real width = maximum(Real(0.5) * (high - low), Real(1e-4F));
    const Real h = excess / width;
    const Real density = Real(Scalar(0.39894228040143267794)) * mica::exp(Real(-0.5) * h * h);
    const Real beyond = maximum(Real(0), excess * normal_cdf(h) + width * density);
    const Real drawn = with_tail<Gates>(n, p, gated, at_next, beyond, expansion);

    const auto below_one = n < Real(1);
    const Real lone = minimum(n, Real(1));
    const Real rarer = select(below_one, step(lone * p, x), drawn);
    const Real others = select(below_one, step(lone * q, -x), n - drawn);
    return {select(failures_rarer, others, rarer), select(failures_rarer, rarer, others)};
}

} // namespace mica::detail
