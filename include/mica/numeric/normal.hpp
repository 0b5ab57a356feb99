// mica/numeric/normal.hpp: the standard normal distribution and its quantile.
#pragma once

#include <cmath>

#include "angle.hpp"
#include "elementary.hpp"

namespace mica {

namespace detail {

/// Algorithm AS 241 (Wichura 1988, Applied Statistics 37, PPND16) for the tail probability u <= 1/2: the size of the
/// quantile, z >= 0.
template <real_number Real>
    requires(std::same_as<scalar_of<Real>, double>)
MICA_HOST_DEVICE constexpr Real quantile_size(Real u) {
    constexpr double a[] = {3.3871328727963666080e0,  1.3314166789178437745e+2, 1.9715909503065514427e+3,
                            1.3731693765509461125e+4, 4.5921953931549871457e+4, 6.7265770927008700853e+4,
                            3.3430575583588128105e+4, 2.5090809287301226727e+3};
    constexpr double b[] = {1.,
                            4.2313330701600911252e+1,
                            6.8718700749205790830e+2,
                            5.3941960214247511077e+3,
                            2.1213794301586595867e+4,
                            3.9307895800092710610e+4,
                            2.8729085735721942674e+4,
                            5.2264952788528545610e+3};
    constexpr double c[] = {1.42343711074968357734e0,  4.63033784615654529590e0, 5.76949722146069140550e0,
                            3.64784832476320460504e0,  1.27045825245236838258e0, 2.41780725177450611770e-1,
                            2.27238449892691845833e-2, 7.74545014278341407640e-4};
    constexpr double d[] = {1.,
                            2.05319162663775882187e0,
                            1.67638483018380384940e0,
                            6.89767334985100004550e-1,
                            1.48103976427480074590e-1,
                            1.51986665636164571966e-2,
                            5.47593808499534494600e-4,
                            1.05075007164441684324e-9};
    constexpr double e[] = {6.65790464350110377720e0,  5.46378491116411436990e0,  1.78482653991729133580e0,
                            2.96560571828504891230e-1, 2.65321895265761230930e-2, 1.24266094738807843860e-3,
                            2.71155556874348757815e-5, 2.01033439929228813265e-7};
    constexpr double f[] = {1.,
                            5.99832206555887937690e-1,
                            1.36929880922735805310e-1,
                            1.48753612908506148525e-2,
                            7.86869131145613259100e-4,
                            1.84631831751005468180e-5,
                            1.42151175831644588870e-7,
                            2.04426310338993978564e-15};
    const Real x = Real(0.5) - u;
    const Real centre_argument = Real(0.180625) - x * x;
    const Real centre = x * polynomial(centre_argument, a) / polynomial(centre_argument, b);
    const Real r = mica::sqrt(-mica::log(u));
    const Real middle = polynomial(r - Real(1.6), c) / polynomial(r - Real(1.6), d);
    const Real tail = polynomial(r - Real(5), e) / polynomial(r - Real(5), f);
    return select(x <= Real(0.425), centre, select(r <= Real(5), middle, tail));
}

/// Two polynomials in w = -ln(4 u (1-u)): z = (1/2 - u) C(w - 2.5) up to w = 5, z = T(sqrt(w) - 3.4) from there to
/// w = 21 (u = 1.9e-10), where it stops. Relative error of z: C (degree 7) 2.7e-7, T (degree 5) 3.6e-7.
template <real_number Real>
    requires(std::same_as<scalar_of<Real>, float>)
MICA_HOST_DEVICE constexpr Real quantile_size(Real u) {
    constexpr float c[] = {4.246626449F,     0.6976072848F,    -0.01181224372F, -0.003548633741F,
                           0.0006147191401F, -1.158013183e-5F, -9.01104118e-6F, 8.9274453e-7F};
    constexpr float t[] = {4.574654741F,     1.423759928F,    0.005152925809F,
                           -0.002828866078F, 0.001049097567F, -0.000239227383F};
    const Real w = minimum(-mica::log(Real(4) * u * (Real(1) - u)), Real(21));
    const Real centre = (Real(0.5) - u) * polynomial(w - Real(2.5F), c);
    const Real tail = polynomial(w * inverse_sqrt(w) - Real(3.4F), t);
    return select(w < Real(5), centre, tail);
}

} // namespace detail

/// z with P(Z <= z) = u, Z standard normal; u in (0,1).
///
/// Largest relative error of z: float 8e-7 (from u = 2^-32 to 1 - 2^-24), double 1e-15 (tests/numeric_test.cpp). Odd
/// about 1/2 to the last bit wherever 1 - u is exact. For float u below 1.9e-10 counts as that.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real normal_quantile(Real u) {
    const auto lower = u < Real(0.5);
    const Real size = detail::quantile_size(select(lower, u, Real(1) - u));
    return select(lower, -size, size);
}

namespace detail {

/// P(Z > z) for z >= 0: t exp(-z^2 / 2) P(t - 1/2), t = 1 / (1 + 0.3 z), P of degree 7 with the relative error 1.1e-7 up
/// to z = 13, where it stops.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real normal_tail(Real z) {
    using Scalar = scalar_of<Real>;
    if constexpr (sizeof(Scalar) == 4) {
        constexpr float c[] = {0.2219705912F, 0.329158689F,    0.3462044562F,   0.2221081766F,
                               0.0288124454F, -0.07799354633F, -0.03269630678F, 0.03619484599F};
        const Real x = minimum(z, Real(13));
        const Real t = Real(1) / (Real(1) + Real(0.3F) * x);
        return t * mica::exp(Real(-0.5) * x * x) * polynomial(t - Real(0.5), c);
    } else {
        return each_lane([](Scalar x) { return std::erfc(x * Scalar(0.70710678118654752440)) / 2; }, z);
    }
}

} // namespace detail

/// P(Z <= z), Z standard normal.
///
/// Relative error 5e-6 for z <= 0 down to -13, where it stops at 6e-39 (double 1e-14, no limit before -37); for z > 0
/// absolute error 3e-7 (2e-16) (tests/numeric_test.cpp).
template <real_number Real>
MICA_HOST_DEVICE constexpr Real normal_cdf(Real z) {
    const Real tail = detail::normal_tail(abs(z));
    return select(z < Real(0), tail, Real(1) - tail);
}

} // namespace mica
