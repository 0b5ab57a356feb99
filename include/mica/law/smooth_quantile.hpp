// mica/law/smooth_quantile.hpp: the quantile law's real-valued twin, for shading, where an integer step along a smooth
// gradient shows.
//
// For integer m >= 1 and p <= 1/2, with ramp(x) = clamp(x + 1/2, 0, 1), S_k = P(X > k), pmf_k = P(X = k), and s, d, w,
// z as in law/quantile.hpp:
//
//     A    = sum over k < Gates of ramp((c_k - xi) / b_k),   b_k = pmf_k pmf_(k+1) / (2 (pmf_k + pmf_(k+1)))
//     c_k  = S_k, but for m > Gates the last one is S_k - pmf_(k+1) min(1, m p / 2) / 12
//     g(z) = min(m, m p + s z + d (z^2-1)/6 + z [1 + 14w - (1+2w) z^2] / (72 s)),   z in [-3s, (4+5d) s]
//     n    = A + max(0, g - Gates);   for m > Gates and p from 0.45 to 0.5 blended into clamp(g, 0, m)
//
// The ramps keep the mean of the steps they replace; the shift of the last one makes up for the cut of g; the blend,
// symmetric at p = 1/2, leaves no seam where successes and failures change places. p > 1/2 evaluates the failures at
// 1 - xi. Real N >= 1 interpolates between the neighbouring integers at the same xi; N < 1 has one ramp for a success
// at N p and one for a failure at 1 - N q.
//
// Source: mica's own.
// Draws: one uniform.
// Output: real counts; successes + failures = N exactly for N >= 1, in expectation below. Continuous in xi, N and p.
// Error: relative mean error 1e-3 for real N; variance at integer N >= 1 within 10 %, 1/12 too small where N p is small
//   (tests/quantile_test.cpp).
#pragma once

#include "../numeric/gate.hpp"
#include "../numeric/normal.hpp"
#include "binomial_law.hpp"

namespace mica {

namespace detail {

/// From 0 to 1 where x goes from -1/2 to 1/2.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real ramp(Real x) {
    return clamp(x + Real(0.5), Real(0), Real(1));
}

/// A step at 0 as wide as `width`; where that is too small to divide by, a step.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real ramp_of_width(Real x, Real width) {
    const auto wide = width > Real(std::numeric_limits<scalar_of<Real>>::min());
    const Real step = select(x > Real(0), Real(1), Real(0));
    return select(wide, ramp(x / select(wide, width, Real(1))), step);
}

/// The width of the ramp between two outcomes: a quarter of the harmonic mean of their probabilities.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real ramp_width(Real a, Real b) {
    const Real sum = a + b;
    return select(sum > Real(0), a * b / (Real(2) * select(sum > Real(0), sum, Real(1))), Real(0));
}

/// n for integer m >= 1 and p <= 1/2; z = -Phi^-1(xi).
template <int Gates, real_number Real>
MICA_HOST_DEVICE constexpr Real smooth_quantile(Real m, Real p, Real xi, Real z) {
    using Scalar = scalar_of<Real>;
    constexpr Scalar gates = Gates;
    const Real q = Real(1) - p;
    const Real w = p * q;
    const Real d = q - p;
    const auto reaches_beyond = m > Real(gates);

    const Real exponent = m * log1p_neg(p);
    const Real odds = p / q;
    Real above = -expm1(exponent); // S_k
    Real mass = exp(exponent);     // pmf_k
    Real passed = Real(0);
    for (int gate = 0; gate < Gates; ++gate) {
        const auto k = static_cast<Scalar>(gate);
        const Real next = mass * (maximum(m - Real(k), Real(0)) * odds * Real(1 / (k + 1)));
        Real centre = above;
        if (gate == Gates - 1) {
            const Real shift = next * minimum(Real(1), m * p * Real(0.5)) * Real(Scalar(1) / 12);
            centre = select(reaches_beyond, above - shift, above);
        }
        passed = passed + ramp_of_width(centre - xi, ramp_width(mass, next));
        mass = next;
        above = above - next;
    }

    const Real s = sqrt(maximum(m * w, Real(1e-8F)));
    const Real x = clamp(z, Real(-3) * s, (Real(4) + Real(5) * d) * s);
    const Real x2 = x * x;
    const Real skewness = d * (x2 - Real(1)) * Real(Scalar(1) / 6);
    const Real kurtosis = x * (Real(1) + Real(14) * w - (Real(1) + Real(2) * w) * x2) / (Real(72) * s);
    const Real expansion = minimum(m, m * p + s * x + (skewness + kurtosis));

    const Real gated = passed + maximum(Real(0), expansion - Real(gates));
    const Real blend = clamp((p - Real(0.45F)) * Real(20), Real(0), Real(1));
    const Real blended = gated + blend * (clamp(expansion, Real(0), m) - gated);
    return select(reaches_beyond, blended, gated);
}

} // namespace detail

/// Gates in 1..16: how many small counts have steps (ramps) of their exact probability.
template <int Gates>
struct smooth_quantile_binomial {
    static_assert(Gates >= 1 && Gates <= 16, "a quantile law has 1 to 16 gates");
    static constexpr bool integer_counts = false;

    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        const auto [n, p] = detail::in_domain(trials, probability);
        const Real q = Real(1) - p;
        const Real u = xi();
        const auto mirrored = p > Real(0.5);
        const Real rarer = select(mirrored, q, p);
        const Real tail = select(mirrored, Real(1) - u, u);
        const Real quantile = normal_quantile(u);
        const Real z = select(mirrored, quantile, -quantile);

        const Real whole = maximum(floor(n), Real(1));
        const Real part = clamp(n - whole, Real(0), Real(1));
        const Real at_whole = detail::smooth_quantile<Gates>(whole, rarer, tail, z);
        const Real at_next = detail::smooth_quantile<Gates>(whole + Real(1), rarer, tail, z);
        const Real drawn = minimum(at_whole + part * (at_next - at_whole), n);

        // N < 1: success, nothing, failure, with probabilities N p, 1 - N, N q.
        const auto below_one = n < Real(1);
        const Real success = n * p, failure = n * q, nothing = Real(1) - n;
        const Real lone_success = detail::ramp_of_width(success - u, detail::ramp_width(success, Real(1) - success));
        const Real lone_failure =
            detail::ramp_of_width(u - (nothing + success), detail::ramp_width(failure, Real(1) - failure));
        const Real some = select(mirrored, n - drawn, drawn);
        return {select(below_one, lone_success, some), select(below_one, lone_failure, n - some)};
    }
};

} // namespace mica
