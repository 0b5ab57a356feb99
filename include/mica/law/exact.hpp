// mica/law/exact.hpp: exact binomial sampling, for reference and for whoever can pay for it.
//
// Source: N min(p, 1-p) < 10: inversion by sequential search from the tail of 0, at most 110 steps; otherwise
//   transformed rejection with squeeze, BTRS (Hormann 1993, "The generation of binomial random variates", J. Stat.
//   Comput. Simul. 46), whose expected number of tries is below 1.5 for every N and p. This pair because both are
//   exact, neither has a set-up worth caching, and the cost is bounded whatever the parameters.
// Draws: one of the caller's stream when it can fork (uniform_stream), an unbounded number otherwise.
// Output: integers, successes + failures = trials, exact up to 2^53 (as Real: to one ulp beyond 2^24 for float). More
//   trials are those of the nearest double.
//   Real N: trials = floor(N) + (xi' < N - floor(N)).
// Error: the resolution of the uniforms, 2^-31 at small xi, where many successes lie. Inside it computes in double.
// Departures: BTRS accepts against the saddle-point form of the probability (Loader 2000, "Fast and accurate
//   computation of binomial probabilities") instead of differences of log-factorials, which at N = 1e15 have no
//   correct digit left.
// Not for a GPU: doubles and a loop. On a pack it runs lane by lane.
#pragma once

#include <cmath>

#include "binomial_law.hpp"

namespace mica {

namespace detail {

/// log(n!) - log(sqrt(2 pi n) (n/e)^n), n >= 1, the error of Stirling's formula. Absolute error 1e-12.
inline double stirling_error(double n) {
    constexpr double exactly[] = {0.,
                                  0.0810614667953272582,
                                  0.0413406959554092941,
                                  0.0276779256849983391,
                                  0.0207906721037650931,
                                  0.0166446911898211922,
                                  0.0138761288230707480,
                                  0.0118967099458917701,
                                  0.0104112652619720965,
                                  0.00925546218271273292,
                                  0.00833056343336287126};
    if (n <= 10) return exactly[static_cast<int>(n)];
    const double inverse_square = 1 / (n * n);
    return (1. / 12 - (1. / 360 - (1. / 1260 - inverse_square / 1680) * inverse_square) * inverse_square) / n;
}

/// x log(x / mean) + mean - x >= 0 without cancellation near x = mean (Loader's bd0).
inline double deviance(double x, double mean) {
    const double relative = (x - mean) / mean;
    if (std::abs(relative) < 0.1) {
        // log(1+r) = 2 atanh(v), v = r/(2+r): deviance = mean (r v + 2 (1+r) (v^3/3 + v^5/5 + ...))
        const double v = relative / (2 + relative);
        const double square = v * v;
        double power = v * square;
        double sum = 0;
        for (int k = 3; k < 30; k += 2) {
            const double term = power / k;
            sum += term;
            if (std::abs(term) <= 1e-17 * std::abs(sum)) break;
            power *= square;
        }
        return mean * (relative * v + 2 * (1 + relative) * sum);
    }
    return (x > 0 ? x * std::log(x / mean) : 0) + mean - x;
}

/// The probability of k successes in n trials, n >= 1, 0 <= k <= n, 0 < p < 1.
inline double binomial_probability(double k, double n, double p) {
    const double q = 1 - p;
    if (k <= 0) return std::exp(n * std::log1p(-p));
    if (k >= n) return std::exp(n * std::log(p));
    const double exponent =
        stirling_error(n) - stirling_error(k) - stirling_error(n - k) - deviance(k, n * p) - deviance(n - k, n * q);
    return std::exp(exponent) * std::sqrt(n / (6.283185307179586 * k * (n - k)));
}

/// n p < 10, p <= 1/2: the largest k with xi < P(X >= k), so small xi means many successes.
template <class Uniform>
double binomial_by_inversion(double n, double p, Uniform& xi) {
    double tail = -std::expm1(n * std::log1p(-p)); // P(X > 0)
    double mass = 1 - tail;                        // P(X = 0)
    const double odds = p / (1 - p);
    const double u = static_cast<double>(xi());
    double k = 0;
    // P(X > 110) < 1e-70 here; rounding may leave a tail that never falls below u.
    while (u < tail && k < n && k < 110) {
        mass *= (n - k) / (k + 1) * odds;
        k += 1;
        tail -= mass;
    }
    return k;
}

/// n p >= 10, p <= 1/2: Hormann's algorithm BTRS; names as in the paper.
template <class Uniform>
double binomial_by_rejection(double n, double p, Uniform& xi) {
    const double spq = std::sqrt(n * p * (1 - p));
    const double b = 1.15 + 2.53 * spq;
    const double a = -0.0873 + 0.0248 * b + 0.01 * p;
    const double c = n * p + 0.5;
    const double v_r = 0.92 - 4.2 / b;
    const double alpha = (2.83 + 5.1 / b) * spq;
    const double mode = std::floor((n + 1) * p);
    const double at_mode = binomial_probability(mode, n, p);
    // 128 tries fail with probability below 1e-50; constant uniforms, as a test may give, would try for ever.
    for (int tries = 0; tries < 128; ++tries) {
        const double u = static_cast<double>(xi()) - 0.5;
        const double v = static_cast<double>(xi());
        const double us = 0.5 - std::abs(u);
        const double k = std::floor((2 * a / us + b) * u + c);
        if (us >= 0.07 && v <= v_r) return k;
        if (!(k >= 0 && k <= n)) continue;
        if (v * alpha / (a / (us * us) + b) * at_mode <= binomial_probability(k, n, p)) return k;
    }
    return mode;
}

/// Integer n >= 0 and p in [0,1].
template <class Uniform>
double exact_binomial_successes(double n, double p, Uniform& xi) {
    if (n <= 0 || p <= 0) return 0;
    if (p >= 1) return n;
    if (p > 0.5) return n - exact_binomial_successes(n, 1 - p, xi);
    return n * p < 10 ? binomial_by_inversion(n, p, xi) : binomial_by_rejection(n, p, xi);
}

} // namespace detail

/// Exact binomial counts.
struct exact_binomial {
    static constexpr bool integer_counts = true; ///< successes and failures are integers

    /// The counts; arguments as in binomial_law.hpp. Draws one uniform of a source that can fork, 1 to 3 on average of any other.
    template <real_number Real, class Uniform>
    counts<Real> operator()(Real trials, Real probability, Uniform&& xi) const {
        auto&& stream = detail::forked(xi);
        const auto [n, p] = detail::in_domain(trials, probability);
        if constexpr (scalar_number<Real>) {
            return one_lane(n, p, stream);
        } else {
            counts<Real> result{Real(0), Real(0)};
            for (int i = 0; i < lanes_of<Real>; ++i) {
                const auto drawn = one_lane(lane(n, i), lane(p, i), lane_of(stream, i));
                set_lane(result.successes, i, drawn.successes);
                set_lane(result.failures, i, drawn.failures);
            }
            return result;
        }
    }

  private:
    template <class Scalar, class Uniform>
    static counts<Scalar> one_lane(Scalar trials, Scalar probability, Uniform&& xi) {
        double n = std::floor(static_cast<double>(trials));
        const double fraction = static_cast<double>(trials) - n;
        if (fraction > 0 && static_cast<double>(xi()) < fraction) n += 1;
        const double successes = detail::exact_binomial_successes(n, static_cast<double>(probability), xi);
        return {static_cast<Scalar>(successes), static_cast<Scalar>(n - successes)};
    }

    /// The uniforms of lane i: its own stream, or lane i of every draw where the source has no lanes of its own.
    template <class Uniform>
    static auto lane_of(Uniform& xi, int i) {
        if constexpr (requires { xi.lane(i); })
            return xi.lane(i);
        else
            return [&xi, i] { return lane(xi(), i); };
    }
};

} // namespace mica
