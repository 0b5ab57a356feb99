// mica/config.hpp: the version, and every macro of the library.
//
// A macro that is a switch is always defined, to 0 or 1, and may be set before the first include of any mica
// header. All translation units of a program should agree on them.
#pragma once

#define MICA_VERSION_MAJOR 0 ///< of a release; until 1.0 every minor version may break
#define MICA_VERSION_MINOR 1 ///< of a release
#define MICA_VERSION_PATCH 0 ///< of a release

/// Marks the functions that a GPU may call. For float they use 32-bit integers and floats only, no allocation and no
/// library but <cmath>. nvcc needs --expt-relaxed-constexpr, for the constexpr members of std::array.
#ifndef MICA_HOST_DEVICE
#if defined(__CUDACC__) || defined(__HIPCC__)
#define MICA_HOST_DEVICE __host__ __device__
#else
#define MICA_HOST_DEVICE
#endif
#endif

/// 1: arguments outside a function's domain fail loudly, naming the parameter and the value.
/// 0: they are mapped into the domain as each function documents. Never a hang, never a NaN, either way.
#ifndef MICA_CHECKED
#define MICA_CHECKED 0
#endif

/// 1: pack<Real, W> holds a vector of the compiler's (g++, clang). 0: it holds an array; same results, slower.
#ifndef MICA_VECTOR_EXTENSIONS
#if defined(__GNUC__) && !defined(__CUDACC__)
#define MICA_VECTOR_EXTENSIONS 1
#else
#define MICA_VECTOR_EXTENSIONS 0
#endif
#endif

/// Before a loop of a few steps, known at compile time, over packs: g++ -O2 leaves loops that would grow, clang does not.
#ifndef MICA_UNROLL
#if defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__)
#define MICA_UNROLL _Pragma("GCC unroll 16")
#else
#define MICA_UNROLL
#endif
#endif

/// 1: a product and a sum of packs may be fused into one instruction with one rounding. g++ does so by itself, as
/// -ffp-contract says; clang would only within one expression, which the operators of a pack never are, and lose a
/// quarter of the speed. 0: clang leaves them as they are; for equal bits in packs and scalars, with -ffp-contract=off.
#ifndef MICA_FP_CONTRACT
#define MICA_FP_CONTRACT 1
#endif
/// The statement that says so to clang, where it has an effect.
#ifndef MICA_CONTRACT
#if MICA_FP_CONTRACT && defined(__clang__)
#define MICA_CONTRACT _Pragma("clang fp contract(fast)")
#else
#define MICA_CONTRACT
#endif
#endif

/// A function that works on registers of 512 bits where the target has them: clang would halve them, to spare the clock of
/// processors from before 2019.
#ifndef MICA_WIDE
#if defined(__clang__) && defined(__AVX512F__)
#define MICA_WIDE __attribute__((min_vector_width(512)))
#else
#define MICA_WIDE
#endif
#endif

/// A function into which all that it calls is inlined: packs that are passed through memory cost a fifth.
#ifndef MICA_FLATTEN
#if MICA_VECTOR_EXTENSIONS
#define MICA_FLATTEN __attribute__((flatten))
#else
#define MICA_FLATTEN
#endif
#endif

/// What happens to a bad argument of a host-side constructor, and under MICA_CHECKED of everything else: by default
/// std::invalid_argument, or a line on standard error and std::abort where exceptions are off.
#ifndef MICA_FAIL
#define MICA_FAIL(parameter, value, requirement)                                                                       \
    ::mica::detail::fail(parameter, static_cast<double>(value), requirement)
#endif

/// An invariant of the caller's that has no value to name, tested under MICA_CHECKED only.
#ifndef MICA_ASSERT
#if MICA_CHECKED
#define MICA_ASSERT(condition)                                                                                         \
    do {                                                                                                               \
        if (!(condition)) MICA_FAIL(#condition, 0, "true");                                                            \
    } while (false)
#else
#define MICA_ASSERT(condition) static_cast<void>(0)
#endif
#endif

#include <cstdio>
#include <cstdlib>
#if defined(__cpp_exceptions)
#include <stdexcept>
#include <string>
#endif

namespace mica::detail {

/// Reports that `parameter` has a `value` that is not `requirement` (an adjective phrase: "positive", "in [0,1]").
[[noreturn]] MICA_HOST_DEVICE inline void fail(const char* parameter, double value, const char* requirement) {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
    printf("mica: %s = %g is not %s\n", parameter, value, requirement);
    __trap();
#else
    char message[256];
    std::snprintf(message, sizeof message, "mica: %s = %.9g is not %s", parameter, value, requirement);
#if defined(__cpp_exceptions)
    throw std::invalid_argument(message);
#else
    std::fprintf(stderr, "%s\n", message);
    std::abort();
#endif
#endif
}

} // namespace mica::detail
