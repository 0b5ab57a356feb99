// mica/law/quantile.hpp: the binomial quantile, exact at small counts, Cornish-Fisher beyond.
//
//     n >= k + 1  exactly where  xi < S_k = P(X > k),  k < Gates;   beyond the gates  n = max(Gates, floor f(z))
//
// with z = -Phi^-1(xi), and for p <= 1/2, s = sqrt(N p q), d = q - p, w = p q
//
//     f(z) = N p + 1/2 + s z + d (z^2-1)/6 - z [(1+2w) z^2 + 2 - 14w] / (72 s)                        third order
//          + d (2+w) (3 z^4 + 7 z^2 - 16) / (1620 s^2)                                                fourth
//          + z [(9w^2+117w-51.75) z^4 + (256w^2+403w-137) z^2 + 671-1354w-433w^2] / (38880 s^3)       fifth
//
// the Cornish-Fisher expansion of the binomial quantile, Sheppard's correction included. The polynomial turns back far
// out, so |z| is limited to 4 s, s (3+d), s (3+2d). Its defect is all at small counts, which the gates take. For
// p > 1/2 the failures are evaluated at 1 - xi.
//
// Source: mica's own (Cornish & Fisher 1938 for the expansion). Orders: third up to 3 gates, fourth with 4, fifth from
//   5 on; below 5 gates the fifth hurts.
// Draws: two uniforms, the quantile first, then the rounding of real N: trials = floor(N) + (xi' < N - floor(N)).
// Output: integers that sum to the trials. n does not increase with xi: small xi means many successes.
// Error: over N in {3..1e7}, N p in [1e-3, 300], both sides of p = 1/2, binary32, computed without sampling
//   (tests/quantile_test.cpp):
//
//     gates   total variation   relative mean error   relative variance error
//       4         8e-4               1.2e-3                 9e-3
//       8         1e-4               1e-4                   1e-3
//
//   At N p = 1e-6 the relative mean error is below 1e-3, at 1e-8 below 5e-2: the resolution of the uniforms near 0.
//   Rare failures (p near 1) have that of 1 - xi, 2^-24.
#pragma once

#include "../numeric/gate.hpp"
#include "../numeric/normal.hpp"
#include "binomial_law.hpp"

namespace mica {

namespace detail {

/// f(z) of the given order, for p <= 1/2. Below a variance of 1e-4, where no outcome passes the gates, that of 1e-4.
template <int Order, real_number Real>
MICA_HOST_DEVICE constexpr Real cornish_fisher(Real trials, Real p, Real z) {
    using Scalar = scalar_of<Real>;
    const Real q = Real(1) - p;
    const Real w = p * q;
    const Real d = q - p;
    const Real s = sqrt(maximum(trials * w, Real(1e-4F)));
    const Real limit = Order == 5 ? s * (Real(3) + Real(2) * d) : Order == 4 ? s * (Real(3) + d) : s * Real(4);
    const Real x = clamp(z, -limit, limit);
    const Real x2 = x * x;
    const Real r = Real(1) / s;
    Real sum = d * (x2 - Real(1)) * Real(Scalar(1) / 6) -
               x * r * ((Real(1) + Real(2) * w) * x2 + Real(2) - Real(14) * w) * Real(Scalar(1) / 72);
    if constexpr (Order >= 4)
        sum = sum + d * (Real(2) + w) * ((Real(3) * x2 + Real(7)) * x2 - Real(16)) * (r * r) * Real(Scalar(1) / 1620);
    if constexpr (Order >= 5) {
        const Real fifth = (Real(9) * w + Real(117)) * w - Real(51.75F);
        const Real third = (Real(256) * w + Real(403)) * w - Real(137);
        const Real first = Real(671) - (Real(433) * w + Real(1354)) * w;
        sum = sum + x * ((fifth * x2 + third) * x2 + first) * (r * r * r) * Real(Scalar(1) / 38880);
    }
    return trials * p + s * x + (sum + Real(0.5F));
}

} // namespace detail

/// Gates in 1..16: how many small counts are exact.
template <int Gates>
struct quantile_binomial {
    static_assert(Gates >= 1 && Gates <= 16, "a quantile law has 1 to 16 gates");
    static constexpr bool integer_counts = true;

    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        using Scalar = scalar_of<Real>;
        const auto [real_trials, p] = detail::in_domain(trials, probability);
        const Real u = xi();
        const Real n = detail::dithered(real_trials, xi());

        const auto mirrored = p > Real(0.5);
        const Real rarer = select(mirrored, Real(1) - p, p);
        const Real tail = select(mirrored, Real(1) - u, u);

        // The recursion multiplies q^N by up to (N p/q)^Gates, so q^N has to underflow to zero.
        const Real exponent = n * log1p_neg(rarer);
        const Real odds = rarer / (Real(1) - rarer);
        Real above = -expm1(exponent); // P(X > gate)
        Real mass = exp(exponent);     // P(X = gate)
        Real passed = Real(0);
        for (int gate = 0; gate < Gates; ++gate) {
            const auto k = static_cast<Scalar>(gate);
            passed = passed + select(tail < above, Real(1), Real(0));
            mass = mass * ((n - Real(k)) * odds * Real(1 / (k + 1)));
            above = above - mass;
        }

        constexpr Scalar gates = Gates;
        constexpr int order = Gates >= 5 ? 5 : Gates == 4 ? 4 : 3;
        const Real quantile = normal_quantile(u);
        const Real z = select(mirrored, quantile, -quantile);
        const Real beyond = maximum(floor(detail::cornish_fisher<order>(n, rarer, z)), Real(gates));
        const Real drawn = minimum(select(passed < Real(gates), passed, beyond), n);
        return {select(mirrored, n - drawn, drawn), select(mirrored, drawn, n - drawn)};
    }
};

} // namespace mica
