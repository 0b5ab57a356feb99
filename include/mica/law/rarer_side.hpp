// mica/law/rarer_side.hpp: the rarer of successes and failures, from which the quantile laws count.
//
// Small counts have their probabilities to full relative accuracy where p <= 1/2, so beyond 1/2 the failures are
// counted, at 1 - xi: successes and failures change places without a seam.
#pragma once

#include "../numeric/normal.hpp"

namespace mica::detail {

/// The rarer outcome and a uniform as its counts see it: many where `tail` is small and z is large.
template <real_number Real>
struct rarer_side {
    mask_of<Real> failures; ///< whether the rarer outcome is the failure
    Real probability;       ///< of it, at most 1/2
    Real tail, head;        ///< xi and 1 - xi, each with the digits that it has near 0
    Real z;                 ///< -Phi^-1(tail)
};

/// probability in [0,1], u in (0,1).
template <real_number Real>
MICA_HOST_DEVICE constexpr rarer_side<Real> make_rarer_side(Real probability, Real u) {
    const auto failures = probability > Real(0.5);
    const Real complement = Real(1) - u;
    const Real quantile = normal_quantile(u);
    return {failures, select(failures, Real(1) - probability, probability), select(failures, complement, u),
            select(failures, u, complement), select(failures, quantile, -quantile)};
}

/// P(X > 0) - tail, given log P(X = 0) and P(X = 0). In the upper half as head - P(X = 0): a tail within a rounding of 1
/// is 1 in floating point, and X would pass every gate that it should fail, with all trials for its count.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real any_less_tail(const rarer_side<Real>& side, Real log_none, Real none) {
    return select(side.tail < Real(0.5), -expm1(log_none) - side.tail, side.head - none);
}

} // namespace mica::detail
