// mica/numeric/gate.hpp: the gate (1-p)^N, the probability that none of N trials succeeds, and its complement.
//
// A gate is a policy of the gated laws. `none` alone cannot serve rare events, since 1 - none has no digits left
// where N p is small, so `any` is computed beside it with relative accuracy.
#pragma once

#include "elementary.hpp"

namespace mica {

/// A way to compute (1-p)^N and its complement.
template <class Gate>
concept binomial_gate = requires(float trials, float probability) {
    { Gate::none(trials, probability) } -> std::same_as<float>;
    { Gate::any(trials, probability) } -> std::same_as<float>;
};

namespace detail {

/// p = 1, where log(1-p) is not finite and (1-p)^N is 0 for every N > 0.
template <real_number Real>
MICA_HOST_DEVICE constexpr mask_of<Real> certain(Real trials, Real probability) {
    return probability >= Real(1) && trials > Real(0);
}

} // namespace detail

/// The gate as exp(N log1p(-p)): the default.
///
/// trials N >= 0 and finite, probability p in [0,1], for every gate; N = 0 gives none = 1, p = 1 gives none = 0 for
/// every N > 0. Largest absolute error of none in float: 1e-7 on [1,1e16] x [1e-16,1] (tests/numeric_test.cpp). Largest
/// relative error of any: 3e-7.
struct log1p_gate {
    /// (1-p)^N
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real none(Real trials, Real probability) {
        const Real power = mica::exp(trials * log1p_neg(probability));
        return select(detail::certain(trials, probability), Real(0), power);
    }

    /// 1 - (1-p)^N
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real any(Real trials, Real probability) {
        const Real complement = -mica::expm1(trials * log1p_neg(probability));
        return select(detail::certain(trials, probability), Real(1), complement);
    }
};

/// The gate as KK25 Eq. 25 has it: (1 - c p)^(N/c), c = max(1, 10^-3.54 / p).
///
/// The published remedy for binary32. Largest absolute error of none in float 8.5e-5, near p = 2e-12, N = 5e11: it
/// evaluates another number than (1-p)^N (tests/numeric_test.cpp). any has the relative error 2e-4.
struct scaled_gate {
    /// (1-p)^N
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real none(Real trials, Real probability) {
        return select(detail::certain(trials, probability), Real(0), mica::exp(exponent(trials, probability)));
    }

    /// 1 - (1-p)^N
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real any(Real trials, Real probability) {
        return select(detail::certain(trials, probability), Real(1), -mica::expm1(exponent(trials, probability)));
    }

  private:
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real exponent(Real trials, Real probability) {
        constexpr auto epsilon = scalar_of<Real>(2.8840315031266057e-4); // 10^-3.54
        const Real p = maximum(probability, Real(std::numeric_limits<scalar_of<Real>>::min()));
        const Real c = maximum(Real(1), Real(epsilon) / p);
        return trials / c * mica::log(Real(1) - c * probability);
    }
};

/// The gate as first published (DB23 Eq. 16), (1-p)^N from the rounded 1-p: there to show the failure.
///
/// In float, 1 - p is 1 for p < 3e-8, so none is 1 where the truth is 0: absolute error 1. any is 1 - none and has no
/// digits where N p is small.
struct naive_gate {
    /// (1-p)^N
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real none(Real trials, Real probability) {
        const Real power = mica::exp(trials * mica::log(Real(1) - probability));
        return select(detail::certain(trials, probability), Real(0), power);
    }

    /// 1 - (1-p)^N
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real any(Real trials, Real probability) {
        return Real(1) - none(trials, probability);
    }
};

} // namespace mica
