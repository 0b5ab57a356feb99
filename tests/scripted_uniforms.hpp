// tests/scripted_uniforms.hpp: uniforms chosen by the test, and the extremes of those that a stream gives.
#pragma once

#include <array>
#include <cstddef>

/// Uniforms read from a list, which starts again at its end, and how many were read.
template <class Real, std::size_t Size>
struct scripted_uniforms {
    std::array<Real, Size> values;
    std::size_t drawn = 0;

    Real operator()() { return values[drawn++ % Size]; }
};

template <class Real>
constexpr Real smallest_uniform = sizeof(Real) == 4 ? Real(0x1p-32) : Real(0x1p-53);
template <class Real>
constexpr Real largest_uniform = sizeof(Real) == 4 ? Real(1 - 0x1p-24) : Real(1 - 0x1p-53);

/// Calls visit(a, b) with both extremes of both uniforms, and the middle.
template <class Real, class Visit>
void each_extreme_pair(Visit visit) {
    for (const Real a : {smallest_uniform<Real>, Real(0.25), Real(0.5), Real(0.75), largest_uniform<Real>})
        for (const Real b : {smallest_uniform<Real>, Real(0.25), Real(0.5), Real(0.75), largest_uniform<Real>})
            visit(a, b);
}
