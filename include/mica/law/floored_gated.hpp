// mica/law/floored_gated.hpp: the gated Gaussian binomial as first published, with integer successes.
//
//     xi1 < 1-(1-p)^N:  successes = 1 + floor(clamp((N-1) p + z sqrt((N-1) p q), 0, N))
//     otherwise         0
//
// Source: DB23 Eq. 16-18.
// Draws: two uniforms, the gate first, then the Gaussian.
// Output: integer successes. For integer N successes + failures = N; for real N failures = max(N - successes, 0) is
//   real, and successes are those of the formula, which does not interpolate between integers.
// Error: the gate's 1 adds a count, floor takes half of one off: at N = 1000 the mean is 12 % too large at N p = 3 and
//   5 % too small at 0.3 (tests/published_laws_test.cpp).
// Departures: the Heaviside of Eq. 18 is written with its argument reversed; "at least one success with probability
//   1-q^N" is meant. The literal formula reaches N + 1; it is clamped to ceil(N). For N < 1 the square root is of a
//   negative number; it counts as 0.
#pragma once

#include "../numeric/gate.hpp"
#include "../numeric/normal.hpp"
#include "binomial_law.hpp"

namespace mica {

/// The floored gated Gaussian with a gate of your choice.
template <binomial_gate Gate>
struct basic_floored_gated_binomial {
    static constexpr bool integer_counts = true; ///< successes and failures are integers

    /// The counts; arguments as in binomial_law.hpp. Draws two uniforms.
    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        const auto [n, p] = detail::in_domain(trials, probability);
        const auto passes = xi() < Gate::any(n, p);
        const Real z = normal_quantile(xi());

        const Real rest = maximum(n - Real(1), Real(0));
        const Real gaussian = clamp(rest * p + mica::sqrt(rest * p * (Real(1) - p)) * z, Real(0), n);
        const Real ceiling = -mica::floor(-n);
        const Real successes = select(passes, minimum(Real(1) + mica::floor(gaussian), ceiling), Real(0));
        return {successes, maximum(n - successes, Real(0))};
    }
};

/// The floored gated law with the default gate, exp(N log1p(-p)).
using floored_gated_binomial = basic_floored_gated_binomial<log1p_gate>;

} // namespace mica
