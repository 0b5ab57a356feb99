// mica/law/dual_gated.hpp: the dual-gated Gaussian binomial.
//
//     all N succeed with p^N, all fail with (1-p)^N, otherwise a Gaussian of mean 1 + (N-2) p and variance
//     (N-2) p q, clamped to [1, N-1]
//
// For N < 2 the outcomes of the neighbouring integers are interpolated: exact for N in {0, 1, 2}. Symmetric: exchanging
// p and 1-p exchanges successes and failures in law. The published law for real-time glints; constant cost, no branch.
//
// Source: KK25 (Kneiphof & Klein 2025) Sec. 6 and Algorithm 1.
// Draws: two uniforms, the gate first, then the Gaussian.
// Output: real counts. successes + failures = N for N >= 2 (to one rounding); below, N is dithered to a neighbouring
//   integer, so the sum is N in expectation only. Where no branch is taken (N < 1) the outcome is (0,0).
// Error (tests/dual_gated_test.cpp): the mean is up to 32 % too large and the variance 48 %,
//   at N p between 0.1 and 10; total variation to the binomial up to 0.23.
// Departures: line 6 of the algorithm, as printed, subtracts c from 1 where c p is meant (compare Eq. 25). Which gate
//   is used is a policy; the order on xi is the paper's (successes at small xi), but "at least one success" is
//   tested as xi < 1-(1-p)^N by Gate::any, because 1 - Gate::none has no digits left for rare events.
#pragma once

#include "../numeric/gate.hpp"
#include "../numeric/normal.hpp"
#include "binomial_law.hpp"

namespace mica {

/// The dual-gated Gaussian with a gate of your choice.
template <binomial_gate Gate>
struct basic_dual_gated_binomial {
    static constexpr bool integer_counts = false; ///< successes and failures are real numbers

    /// The counts; arguments as in binomial_law.hpp. Draws two uniforms.
    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        const auto [n, p] = detail::in_domain(trials, probability);
        const Real q = Real(1) - p;
        const Real gate_xi = xi();
        const Real normal_xi = xi();

        // N < 2 lies between integers: weight `two` of the law for N >= 2, `one` of that for 1, the rest for 0.
        const Real n_from_2 = maximum(n, Real(2));
        const Real two = clamp(n - Real(1), Real(0), Real(1));
        const Real one = maximum(Real(0), Real(1) - mica::abs(Real(1) - n));

        // On xi from 0: N successes, one success, the Gaussian (N < 1: nothing), one failure, N failures.
        const Real all_succeed = two * Gate::none(n_from_2, q);
        const Real one_succeeds = all_succeed + one * p;
        const Real some_succeed = two * Gate::any(n_from_2, p);
        const Real one_fails = select(n < Real(1), Real(1) - n * q, some_succeed + one * p);
        const Real all_fail = (Real(1) - two) + some_succeed;

        const auto success_side = gate_xi < one_succeeds;
        const auto failure_side = !success_side && gate_xi >= one_fails && q > Real(0);
        const auto between = !success_side && !failure_side && n > Real(1);

        const Real mean = Real(1) + (n_from_2 - Real(2)) * p;
        const Real deviation = mica::sqrt((n_from_2 - Real(2)) * p * q);
        const Real gaussian = clamp(mean + deviation * normal_quantile(normal_xi), Real(1), n_from_2 - Real(1));

        const Real succeeded = select(gate_xi < all_succeed, n_from_2, Real(1));
        const Real failed = select(gate_xi >= all_fail, n_from_2, Real(1));
        return {select(success_side, succeeded, select(between, gaussian, Real(0))),
                select(failure_side, failed, select(between, n_from_2 - gaussian, Real(0)))};
    }
};

/// The dual-gated law with the default gate, exp(N log1p(-p)).
using dual_gated_binomial = basic_dual_gated_binomial<log1p_gate>;

} // namespace mica
