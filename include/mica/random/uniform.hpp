// mica/random/uniform.hpp: from random bits to a real in the open interval (0,1).
#pragma once

#include <cstdint>

#include "../numeric/number.hpp"

namespace mica {

/// float: (b + 1/2) 2^-31 rounded, b the upper 31 bits, at most 1 - 2^-24. Never 0, never 1, smallest 2^-32.
///
/// Fine near 0 on purpose: a law whose rare events sit at small xi resolves them to 2^-31. With the usual 24 bits,
/// (b + 1/2) 2^-24, the mean of a law at N p = 1e-6 is off by 3 %.
template <real_number Real>
    requires(std::same_as<scalar_of<Real>, float>)
MICA_HOST_DEVICE constexpr Real uniform_from_bits(index_of<Real> bits) {
    const Real whole = convert<Real>(reinterpret<integer_of<Real>>(bits >> 1));
    return minimum((whole + Real(0.5F)) * Real(0x1p-31F), Real(1 - 0x1p-24F));
}

/// double: (high 2^20 + low / 2^12 + 1/2) 2^-52: the 52 upper bits, never 0, never 1, smallest 2^-53.
template <real_number Real>
    requires(std::same_as<scalar_of<Real>, double>)
MICA_HOST_DEVICE constexpr Real uniform_from_bits(index_of<Real> high, index_of<Real> low) {
    return (convert<Real>(high) * Real(0x1p20) + (convert<Real>(low >> 12) + Real(0.5))) * Real(0x1p-52);
}

} // namespace mica
