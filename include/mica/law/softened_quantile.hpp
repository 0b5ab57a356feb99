// mica/law/softened_quantile.hpp: the expected binomial count, given part of the randomness.
//
// A quantile law makes its count of one normal variate Z. Of Z = c z + s E, c = sqrt(1 - s^2), only z is known, E is
// standard normal and averaged over; s in [0, 1) is the softness. With S_k = P(X > k), G gates, X of M trials:
//
//     n_M(z) = sum over k < G of Phi((c z + Phi^-1(S_k)) / s)  +  E max(0, g(c z + s E) - G)
//
// The first terms are exact: E Phi((c Z + Phi^-1(S)) / s) = S, so they have the mean of the steps they replace. Beyond the
// gates g is the expansion of smooth_quantile.hpp, linear in E around c z, where the expectation is
// (a - G) Phi(h) + b phi(h), h = (a - G) / b, with a = E g and b = s g'; S_(G-1) is corrected as there. Real N: between the
// counts of floor N and floor N + 1 trials, linearly; N < 1 as there: one term for a success at N p, one for a failure.
//
// Source: mica's own.
// Output: real counts; successes + failures = N for N >= 1, in expectation below. Continuous in z, N and p, but for a seam
//   of up to 4e-3 of N at p = 1/2 beyond the gates, where successes and failures change places.
// Error, 4 gates: mean within 0.1 % (tests/blended_test.cpp). Variance that is left where N p >= 0.75:
//
//     s        whole N, at least (a single facet)    real N, at least (between 1 and 2)
//     0.05          94 %                                   48 %
//     0.1           89 %                                   46 %
//     0.25          74 %                                   42 %
//     0.5           49 %                                   31 %
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

    const Real m = maximum(n, Real(gates + 1));
    const Real w = p * q, d = q - p;
    const Real deviation = mica::sqrt(maximum(m * w, Real(1e-8F)));
    const Real y = clamp(x, Real(-3) * deviation, (Real(4) + Real(5) * d) * deviation);
    const Real inverse = Real(1) / (Real(72) * deviation);
    const Real linear = Real(1) + Real(14) * w, cubic = Real(1) + Real(2) * w;
    const Real square = y * y, spread = s * s;
    const Real centre = m * p + deviation * y + d * (square + spread - Real(1)) * Real(Scalar(1) / 6) +
                        y * (linear - cubic * (square + Real(3) * spread)) * inverse;
    const Real slope = deviation + d * y * Real(Scalar(1) / 3) + (linear - Real(3) * cubic * square) * inverse;
    const Real width = maximum(s * slope, Real(1e-4F));
    const Real excess = centre - Real(gates);
    const Real h = excess / width;
    const Real density = Real(Scalar(0.39894228040143267794)) * mica::exp(Real(-0.5) * h * h);
    const Real beyond = maximum(Real(0), excess * normal_cdf(h) + width * density);
    const Real weight = clamp(n - Real(gates), Real(0), Real(1));
    const Real drawn = minimum(gated + weight * beyond, n);

    const auto below_one = n < Real(1);
    const Real lone = minimum(n, Real(1));
    const Real rarer = select(below_one, step(lone * p, x), drawn);
    const Real others = select(below_one, step(lone * q, -x), n - drawn);
    return {select(failures_rarer, others, rarer), select(failures_rarer, rarer, others)};
}

} // namespace mica::detail
