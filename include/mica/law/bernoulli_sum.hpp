// mica/law/bernoulli_sum.hpp: Bernoulli trials while they are few, the floored Gaussian beyond.
//
//     N <= 16 and N p <= 5:  the number of xi_k < p among N
//     otherwise:             clamp(floor(N p + sqrt(N p q) z), 0, N)
//
// Source: Zirr & Kaplanyan 2016 as restated by DB23 Eq. 15; the 16 is their implementation's. Exact on the first
// branch.
// Draws: always 18 uniforms: 16 trials, the Gaussian, the rounding of real N. No branch, so a constant price; no loop
//   on N.
// Output: integers that sum to the trials, for real N to floor(N) or floor(N) + 1.
// Error: on the second branch the floor takes half a count off the mean: at N = 1000 and N p = 1 it is 32 % too small
//   (tests/published_laws_test.cpp).
#pragma once

#include <array>

#include "../numeric/normal.hpp"
#include "binomial_law.hpp"

namespace mica {

/// Bernoulli trials while they are few, the floored Gaussian beyond.
struct bernoulli_sum_binomial {
    static constexpr bool integer_counts = true; ///< successes and failures are integers

    /// The counts; arguments as in binomial_law.hpp. Draws 18 uniforms.
    template <real_number Real, class Uniform>
    MICA_HOST_DEVICE constexpr counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        const auto [real_trials, p] = detail::in_domain(trials, probability);
        std::array<Real, most_trials> trial_xi{};
        for (auto& uniform : trial_xi) uniform = xi();
        const Real z = normal_quantile(xi());
        const Real n = detail::dithered(real_trials, xi());

        Real sum = Real(0);
        for (std::size_t k = 0; k < most_trials; ++k) {
            const auto succeeds = (trial_xi[k] < p) && (n > Real(static_cast<scalar_of<Real>>(k)));
            sum = sum + select(succeeds, Real(1), Real(0));
        }
        const Real gaussian = clamp(mica::floor(n * p + mica::sqrt(n * p * (Real(1) - p)) * z), Real(0), n);
        const auto few = n <= Real(static_cast<scalar_of<Real>>(most_trials)) && n * p <= Real(5);
        const Real successes = select(few, sum, gaussian);
        return {successes, n - successes};
    }

  private:
    static constexpr std::size_t most_trials = 16;
};

} // namespace mica
