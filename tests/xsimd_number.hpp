// tests/xsimd_number.hpp: what it takes to make another library's vector a number that the laws accept. xsimd has
// comparisons of its own type for every element type, where a law knows one mask for one size.
#pragma once

#include <array>
#include <cstdint>

#include <xsimd/xsimd.hpp>

#include <mica/numeric/number.hpp>

namespace xsimd {

// Found by argument-dependent lookup, as mica's own functions for packs are. xsimd has select, any and all itself.

template <class To, class From, class Arch>
To convert(const batch<From, Arch>& value) {
    if constexpr (std::is_floating_point_v<From>)
        return to_int(value); // truncates
    else
        return to_float(value);
}

template <class To, class From, class Arch>
To reinterpret(const batch<From, Arch>& value) {
    return bitwise_cast<To>(value);
}

template <class T, class Arch>
T lane(const batch<T, Arch>& value, int i) {
    return value.get(static_cast<std::size_t>(i));
}

template <class T, class Arch>
void set_lane(batch<T, Arch>& value, int i, T to) {
    std::array<T, batch<T, Arch>::size> lanes;
    value.store_unaligned(lanes.data());
    lanes[static_cast<std::size_t>(i)] = to;
    value = batch<T, Arch>::load_unaligned(lanes.data());
}

template <class Arch>
batch_bool<float, Arch> is_nan(const batch<float, Arch>& value) {
    return isnan(value);
}

} // namespace xsimd

template <class T, class Arch>
struct mica::number_traits<xsimd::batch<T, Arch>> {
    using scalar = T;
    using integer = xsimd::batch<std::int32_t, Arch>;
    using bits = xsimd::batch<std::uint32_t, Arch>;
    using index = bits;
    using mask = xsimd::batch_bool<T, Arch>;
    static constexpr int lanes = xsimd::batch<T, Arch>::size;
};
