// mica/law/quantile.hpp: the binomial quantile, exact at small counts, a Cornish-Fisher quotient beyond.
//
//     n >= k + 1  exactly where  xi < S_k = P(X > k),  k < Gates;   beyond the gates  n = max(Gates, floor f(z))
//
// with z = -Phi^-1(xi), and for p <= 1/2, w = p q, d = q - p, s = sqrt(N p q), y = z / s
//
//     f(z) = N p + 1/2 + s z + d (z^2-1)/6
//          - [ y ((1+2w) z^2 + 2 - 14w - 0.53/s^2) + (d/s^2) (1.46 - (0.24+2w) z^2) ]
//            / ( 72 [1 + y (0.225 d - (0.0125 + 0.085 w) y)] )
//
// The terms to the third order, those without a constant of two digits, are the Cornish-Fisher expansion of the binomial
// quantile with Sheppard's correction. Its next orders,
//
//     + d (2+w) (3 z^4 + 7 z^2 - 16) / (1620 s^2)
//     + z [(9w^2+117w-51.75) z^4 + (256w^2+403w-137) z^2 + 671-1354w-433w^2] / (38880 s^3),
//
// continue the third in powers of y as a geometric series nearly does, and diverge where y is large, just beyond the
// gates; so the series is summed as a quotient. Matching it order by order would give (2/15)(2+w)/(1+2w), about 0.267,
// for 0.225, and 1.42 + 0.71 w for 1.46; the constants above are fitted to the binomial for 4 to 8 gates at once
// (tools/fit_quantile) and rounded, and serve any number of gates. Below a variance of 1/20, where hardly anything
// passes the gates, s^2 is 1/20; z is limited to [-2s, (2.5 + 5.5 d) s], within which f increases. For p > 1/2 the
// failures are evaluated at 1 - xi.
//
// Source: mica's own (Cornish & Fisher 1938 for the expansion).
// Draws: two uniforms, the quantile first, then the rounding of real N: trials = floor(N) + (xi' < N - floor(N)).
// Output: integers that sum to the trials. n does not increase with xi (small xi means many successes) and does not
//   decrease with N or p, but for the rounding of S_k, 1e-7 of xi.
// Error: over N in {3..1e7}, N p in [1e-3, 300], both sides of p = 1/2, binary32, computed without sampling
//   (tests/quantile_test.cpp):
//
//     gates   total variation   relative mean error   relative variance error
//       1         5e-3               5e-2                1.5e-1
//       2         6e-4               4e-3                1.9e-2
//       3         2e-4               4e-4                2.6e-3
//       4         1e-4               5e-5                4e-4
//       8         3e-5               3e-5                1.5e-4
//      16         1e-5               3e-5                1.5e-4
//
//   The last figures of mean and variance are the resolution of 1 - xi and 1 - p, 2^-24: rare failures (p near 1) have no
//   better. At N p = 1e-6 the relative mean error is below 1e-3, at 1e-8 below 5e-2, the resolution of the uniforms near
//   0. Counts near 2^20 are found to 1/8, larger ones to their ulp.
#pragma once

#include "../numeric/elementary.hpp"
#include "binomial_law.hpp"
#include "rarer_side.hpp"
#include "softened_quantile.hpp"

namespace mica {

namespace detail {

/// f(z) for p <= 1/2.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real cornish_fisher_quotient(Real trials, Real p, Real z) {
    using Scalar = scalar_of<Real>;
    constexpr auto constant = [](double value) { return Real(static_cast<Scalar>(value)); };
    const Real w = p * (Real(1) - p);
    const Real d = Real(1) - p - p;
    const Real variance = maximum(trials * w, constant(0.05));
    const Real r = inverse_sqrt(variance);
    const Real s = variance * r;
    const Real x = clamp(z, Real(-2) * s, (Real(2.5F) + Real(5.5F) * d) * s);
    const Real x2 = x * x;
    const Real r2 = r * r;
    const Real y = x * r;
    const Real third = (constant(1. / 72) + constant(2. / 72) * w) * x2 + constant(2. / 72) - constant(14. / 72) * w;
    const Real fourth = constant(1.46 / 72) - (constant(0.24 / 72) + constant(2. / 72) * w) * x2;
    const Real above = y * (third - constant(0.53 / 72) * r2) + d * r2 * fourth;
    const Real below = Real(1) + y * (constant(0.225) * d - (constant(0.0125) + constant(0.085) * w) * y);
    return trials * p + s * x + (d * (x2 - Real(1)) * constant(1. / 6) + Real(0.5F) - above / below);
}

} // namespace detail

/// Gates in 1..16: how many small counts are exact.
template <int Gates>
struct quantile_binomial {
    static_assert(Gates >= 1 && Gates <= 16, "a quantile law has 1 to 16 gates");
    static constexpr bool integer_counts = true; ///< successes and failures are integers

    /// The counts; arguments as in binomial_law.hpp. Draws two uniforms.
    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        const auto [real_trials, p] = detail::in_domain(trials, probability);
        const auto side = detail::make_rarer_side(p, xi());
        const Real n = detail::dithered(real_trials, xi());
        const Real rarer = count(n, side.probability, side.variate);
        return {select(side.failures, n - rarer, rarer), select(side.failures, rarer, n - rarer)};
    }

    /// The successes where nothing needs to be checked, rounded or mirrored: finite integer trials >= 0, probability in
    /// [0, 1/2]. The same as above with the first of its two uniforms. What a multinomial asks at each of its nodes.
    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr Real rarer_successes(Real trials, Real probability, Uniform&& xi) const {
        const Real u = xi();
        return count(trials, probability, detail::make_count_variate(u, u < Real(0.5)));
    }

    /// The expected counts given part of the randomness: real, continuous, of the same mean (softened_quantile.hpp).
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr counts<Real> softened(Real trials, Real probability, Real z, Real softness) {
        return detail::softened_quantile<Gates>(trials, probability, z, softness);
    }

  private:
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real count(Real n, Real p, const detail::count_variate<Real>& xi) {
        using Scalar = scalar_of<Real>;
        // The recursion multiplies q^N by up to (N p/q)^Gates, so q^N has to underflow to zero.
        const Real exponent = n * log_complement(p);
        const Real odds = p / (Real(1) - p);
        Real arrangements = mica::exp(exponent);                        // gate! P(X = gate)
        Real above = detail::any_less_tail(xi, exponent, arrangements); // P(X > gate) - tail
        Real passed = Real(0);
        Scalar factorial = 1;
        MICA_UNROLL
        for (int gate = 0; gate < Gates; ++gate) {
            const auto k = static_cast<Scalar>(gate);
            passed = passed + select(above > Real(0), Real(1), Real(0));
            arrangements = arrangements * ((n - Real(k)) * odds);
            factorial = factorial * (k + 1);
            above = above - arrangements * Real(1 / factorial);
        }

        constexpr Scalar gates = Gates;
        const Real expansion = detail::cornish_fisher_quotient(n, p, xi.z);
        const Real beyond = truncate(maximum(expansion, Real(gates)));
        return minimum(select(passed < Real(gates), passed, beyond), n);
    }
};

} // namespace mica
