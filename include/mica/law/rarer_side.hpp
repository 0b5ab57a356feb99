// mica/law/rarer_side.hpp: the rarer of successes and failures, from which the quantile laws count.
//
// Small counts have their probabilities to full relative accuracy where p <= 1/2, so beyond 1/2 the failures are
// counted, at 1 - xi: successes and failures change places without a seam.
#pragma once

#include "../numeric/normal.hpp"

namespace mica::detail {

/// The rarer outcome, and a uniform as its counts see it. They are few where xi is near one end of (0,1), many where it is
/// near the other; the distance to the nearer end has digits that xi itself, near 1, has not.
template <real_number Real>
struct rarer_side {
    mask_of<Real> failures; ///< whether the rarer outcome is the failure
    mask_of<Real> many;     ///< whether xi lies in the half of many
    Real probability;       ///< of the rarer outcome, at most 1/2
    Real distance;          ///< of xi to the nearer end, at most 1/2
    Real z;                 ///< the normal variate, large where the counts are
};

/// probability in [0,1], u in (0,1): successes are many where u is small.
template <real_number Real>
MICA_HOST_DEVICE constexpr rarer_side<Real> make_rarer_side(Real probability, Real u) {
    const auto failures = probability > Real(0.5);
    const auto many = (u < Real(0.5)) != failures;
    const Real distance = minimum(u, Real(1) - u);
    const Real size = quantile_size(distance);
    return {failures, many, minimum(probability, Real(1) - probability), distance, select(many, size, -size)};
}

/// P(X > 0) less the tail of xi, given log P(X = 0) and P(X = 0) for the rarer outcome's count X. In the half of few as
/// head - P(X = 0): a tail within a rounding of 1 is 1 in floating point, and X would pass every gate that it should
/// fail, with all trials for its count.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real any_less_tail(const rarer_side<Real>& side, Real log_none, Real none) {
    return select(side.many, -expm1(log_none) - side.distance, side.distance - none);
}

} // namespace mica::detail
