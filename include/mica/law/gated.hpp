// mica/law/gated.hpp: the gated Gaussian binomial for real N.
//
//     xi1 < min(N p, 1-(1-p)^N):  successes = clamp(1 + (N-1) p + z sqrt((N-1) p q), 1, max(N, 1))
//     otherwise                   0
//
// For N < 1 there is one facet, present with probability N (the minimum is then N p).
//
// Source: KK25 Eq. 22 and 23, the generalisation of DB23 Eq. 16-18 (law/floored_gated.hpp) to real N.
// Draws: two uniforms, the gate first, then the Gaussian.
// Output: real counts. successes + failures = N for N >= 1 (to one rounding); for N < 1 the outcome is (1,0) with
//   probability N p, (0,1) with N q, else (0,0).
// Error: mean up to 32 % and variance up to 48 % too large, where N p is near 1. Its causes: 1 + (N-1) p is not the
//   mean of a binomial known to be positive, N p / (1-q^N), and the clamp at 1 pushes further.
// Departures: the paper gives successes only. Not symmetric in successes and failures: use the dual-gated law in a
//   multinomial.
#pragma once

#include "../numeric/gate.hpp"
#include "../numeric/normal.hpp"
#include "binomial_law.hpp"

namespace mica {

/// The gated Gaussian with a gate of your choice.
template <binomial_gate Gate>
struct basic_gated_binomial {
    static constexpr bool integer_counts = false; ///< successes and failures are real numbers

    /// The counts; arguments as in binomial_law.hpp. Draws two uniforms.
    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        const auto [n, p] = detail::in_domain(trials, probability);
        const Real q = Real(1) - p;
        const Real gate_xi = xi();
        const Real z = normal_quantile(xi());

        const auto below_one = n < Real(1);
        const auto passes = gate_xi < select(below_one, n * p, Gate::any(n, p));
        const Real rest = maximum(n - Real(1), Real(0));
        const Real gaussian = clamp(Real(1) + rest * p + mica::sqrt(rest * p * q) * z, Real(1), maximum(n, Real(1)));
        const Real successes = select(passes, gaussian, Real(0));
        const auto lone_failure = !passes && gate_xi >= Real(1) - n * q && q > Real(0);
        return {successes, select(below_one, select(lone_failure, Real(1), Real(0)), n - successes)};
    }
};

/// The gated law with the default gate, exp(N log1p(-p)).
using gated_binomial = basic_gated_binomial<log1p_gate>;

} // namespace mica
