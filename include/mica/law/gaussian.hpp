// mica/law/gaussian.hpp: the plain Gaussian approximation of a binomial.
//
//     successes = clamp(N p + sqrt(N p q) z, 0, N),   z standard normal
//
// Source: classical (de Moivre). The baseline that the gated laws improve on.
// Draws: one uniform.
// Output: real counts, successes + failures = N (to one rounding) for every real N.
// Error: what falls below 0 is cut off there, so the mean is too large, at N = 1000 and N p = 1 by 8 %, at 0.1 by 82 %
//   (tests/published_laws_test.cpp). Good from N p q of some hundreds.
#pragma once

#include "../numeric/normal.hpp"
#include "binomial_law.hpp"

namespace mica {

/// The Gaussian approximation, clamped to [0, N].
struct gaussian_binomial {
    static constexpr bool integer_counts = false; ///< successes and failures are real numbers

    /// The counts; arguments as in binomial_law.hpp. Draws one uniform.
    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        const auto [n, p] = detail::in_domain(trials, probability);
        const Real deviation = mica::sqrt(n * p * (Real(1) - p));
        const Real successes = clamp(n * p + deviation * normal_quantile(xi()), Real(0), n);
        return {successes, n - successes};
    }
};

} // namespace mica
