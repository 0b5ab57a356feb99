// mica/law/rarer_side.hpp: the rarer of successes and failures, from which the quantile laws count.
//
// Small counts have their probabilities to full relative accuracy where p <= 1/2, so beyond 1/2 the failures are
// counted, at 1 - xi: successes and failures change places without a seam.
#pragma once

#include "../numeric/normal.hpp"

namespace mica::detail {

/// A uniform as counts see it. They are few where it is near one end of (0,1), many where it is near the other; the
/// distance to the nearer end has digits that the uniform itself, near 1, has not.
template <real_number Real>
struct count_variate {
    mask_of<Real> many; ///< whether it lies in the half of many
    Real distance;      ///< to the nearer end, at most 1/2
    Real z;             ///< the normal variate, large where the counts are
};

/// u in (0,1), and whether it lies in the half of many.
template <real_number Real>
MICA_HOST_DEVICE constexpr count_variate<Real> make_count_variate(Real u, const mask_of<Real>& many) {
    const Real distance = minimum(u, Real(1) - u);
    const Real size = quantile_size(distance);
    return {many, distance, select(many, size, -size)};
}

/// The rarer outcome and the uniform for its counts.
template <real_number Real>
struct rarer_side {
    mask_of<Real> failures; ///< whether the rarer outcome is the failure
    Real probability;       ///< of the rarer outcome, at most 1/2
    count_variate<Real> variate;
};

/// probability in [0,1], u in (0,1): successes are many where u is small.
template <real_number Real>
MICA_HOST_DEVICE constexpr rarer_side<Real> make_rarer_side(Real probability, Real u) {
    const auto failures = probability > Real(0.5);
    const auto many = select(failures, Real(1) - u, u) < Real(0.5);
    return {failures, minimum(probability, Real(1) - probability), make_count_variate(u, many)};
}

/// P(X > 0) less the tail of xi, given log P(X = 0) and P(X = 0) for the rarer outcome's count X. In the half of few as
/// head - P(X = 0): a tail within a rounding of 1 is 1 in floating point, and X would pass every gate that it should
/// fail, with all trials for its count.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real any_less_tail(const count_variate<Real>& xi, Real log_none, Real none) {
    return select(xi.many, -mica::expm1(log_none) - xi.distance, xi.distance - none);
}

} // namespace mica::detail
