// mica/numeric/gate.hpp: the gate (1-p)^N, the probability that none of N trials succeeds, and its complement.
//
// A gate is a policy of the gated laws. `none` alone cannot serve rare events, since 1 - none has no digits left
// where N p is small, so `any` is computed beside it with relative accuracy.
#pragma once

#include "elementary.hpp"

namespace mica {

/// The gate as exp(N log1p(-p)): the default.
///
/// trials N >= 0 and finite, probability p in [0,1]; N = 0 gives none = 1, p = 1 gives none = 0 for every N > 0.
/// Largest absolute error of none in float: 1e-7 on [1,1e16] x [1e-16,1] (tests/numeric_test.cpp; published: 1.0 for
/// pow(1-p, N), 8.3e-5 for KK25 Eq. 25). Largest relative error of any: 3e-7.
struct log1p_gate {
    /// (1-p)^N
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real none(Real trials, Real probability) {
        const Real power = exp(trials * log1p_neg(probability));
        return select(certain(trials, probability), Real(0), power);
    }

    /// 1 - (1-p)^N
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr Real any(Real trials, Real probability) {
        const Real complement = -expm1(trials * log1p_neg(probability));
        return select(certain(trials, probability), Real(1), complement);
    }

  private:
    /// p = 1, where log(1-p) is not finite.
    template <real_number Real>
    MICA_HOST_DEVICE static constexpr mask_of<Real> certain(Real trials, Real probability) {
        return probability >= Real(1) && trials > Real(0);
    }
};

} // namespace mica
