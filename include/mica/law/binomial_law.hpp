// mica/law/binomial_law.hpp: what a binomial law is, and what it does with arguments outside its domain.
//
//     law(trials, probability, xi) -> counts<Real>{successes, failures}
//
// A law is a stateless, default-constructible function object. trials is real, >= 0; probability in [0,1]; xi is any
// callable that returns uniforms of the same number type in the open (0,1). Laws are total: they never hang, never
// loop on the number of trials, never return NaN or infinity. trials < 0 counts as 0, +inf as the largest finite
// Real, a probability outside [0,1] as the nearer end, NaN in either gives (0,0). With MICA_CHECKED each of these
// fails instead, naming the parameter.
#pragma once

#include <concepts>
#include <limits>

#include "../numeric/number.hpp"

namespace mica {

/// The outcome of a binomial experiment. For real trials the two need not sum to them in every outcome; each law says
/// what holds.
template <real_number Real>
struct counts {
    Real successes; ///< >= 0
    Real failures;  ///< >= 0
};

namespace detail {
/// A source of uniforms for stating the concept.
template <class Real>
struct any_uniform {
    Real operator()();
};
} // namespace detail

/// A binomial law over Real. `Law::integer_counts` says whether successes and failures are integers that sum to
/// integer trials in every outcome.
template <class Law, class Real = float>
concept binomial_law = real_number<Real> && std::default_initializable<Law> &&
    requires(const Law law, Real trials, Real probability, detail::any_uniform<Real> xi) {
    { law(trials, probability, xi) } -> std::same_as<counts<Real>>;
    { Law::integer_counts } -> std::convertible_to<bool>;
};

/// A binomial law of integer counts.
template <class Law, class Real = float>
concept integer_binomial_law = binomial_law<Law, Real> && Law::integer_counts;

namespace detail {

template <real_number Real>
struct binomial_parameters {
    Real trials;
    Real probability;
};

#if MICA_CHECKED
template <real_number Real>
MICA_HOST_DEVICE constexpr void require_binomial_parameters(Real trials, Real probability) {
    for (int i = 0; i < lanes_of<Real>; ++i) {
        const auto n = lane(trials, i);
        const auto p = lane(probability, i);
        if (is_nan(n) || !(n >= 0) || n > (std::numeric_limits<scalar_of<Real>>::max)())
            MICA_FAIL("trials", n, "finite and >= 0");
        if (is_nan(p) || !(p >= 0 && p <= 1)) MICA_FAIL("probability", p, "in [0,1]");
    }
}
#endif

/// The parameters brought into the domain, as stated above.
template <real_number Real>
MICA_HOST_DEVICE constexpr binomial_parameters<Real> in_domain(Real trials, Real probability) {
#if MICA_CHECKED
    require_binomial_parameters(trials, probability);
#endif
    using Scalar = scalar_of<Real>;
    const auto undefined = is_nan(trials) || is_nan(probability);
    const Real n = limited_from_0(trials, (std::numeric_limits<Scalar>::max)());
    const Real p = limited_from_0(probability, Scalar(1));
    return {select(undefined, Real(0), n), select(undefined, Real(0), p)};
}

/// Real trials rounded to an integer that has them as its mean: floor(N) + (xi < N - floor(N)). Not floor(N + xi),
/// which in binary32 gives an integer N an extra trial with probability 3 % at N = 1e6.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real dithered(Real trials, Real xi) {
    const Real whole = truncate(trials);
    return whole + select(xi < trials - whole, Real(1), Real(0));
}

/// A stream of its own for work that takes an unknown number of uniforms, so that streams of neighbouring lanes stay
/// in step. A source that cannot fork is drawn from directly.
template <class Uniform>
MICA_HOST_DEVICE constexpr decltype(auto) forked(Uniform& xi) {
    if constexpr (requires { xi.fork(); })
        return xi.fork();
    else
        return static_cast<Uniform&>(xi);
}

} // namespace detail

} // namespace mica
