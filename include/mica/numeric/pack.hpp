// mica/numeric/pack.hpp: pack<T, W>, W numbers that are computed side by side.
//
// A pack is a number type: every law accepts pack<float, 8> where it accepts float, and gives in each lane what it
// gives for a float (to the last bit when floating contraction is off). It is a thin coat over the compilers' vector
// extensions because plain loops stay scalar under a user's default flags: g++ needs -fno-trapping-math and both
// compilers -fno-math-errno to vectorise them, and a header cannot ask its users for flags. Without the extensions
// (MICA_VECTOR_EXTENSIONS 0) it is an array and a loop.
//
// Packs and masks have copy constructors of their own, which do what the compiler's would, to be passed to functions by
// address: vectors wider than the registers would be passed on the stack otherwise, differently under other -march
// flags (of which compilers warn), and g++ 12 now and then forgets to take them off it again, 32 bytes a call.
#pragma once

#include <cstddef>
#include <cstring>
#include <utility>

#include "number.hpp"

namespace mica {

template <class T, int W>
struct pack;

/// How many lanes of T the widest registers hold for which the including file is compiled; 4 to 16 for float.
template <class T>
#if defined(__AVX512F__)
inline constexpr int native_lanes = 64 / sizeof(T);
#elif defined(__AVX__)
inline constexpr int native_lanes = 32 / sizeof(T);
#else
inline constexpr int native_lanes = 16 / sizeof(T);
#endif

namespace detail {

template <std::size_t Bytes>
struct signed_of_size;
template <>
struct signed_of_size<4> {
    using type = std::int32_t;
};
template <>
struct signed_of_size<8> {
    using type = std::int64_t;
};

#if MICA_VECTOR_EXTENSIONS
template <class T, int W>
struct vector_of {
    typedef T type __attribute__((vector_size(sizeof(T) * W)));
};
#else
template <class T, int W>
struct vector_of {
    struct type {
        T lane[W];
        /// Lane i.
        MICA_HOST_DEVICE constexpr T operator[](int i) const { return lane[i]; }
        MICA_HOST_DEVICE constexpr T& operator[](int i) { return lane[i]; }
    };
};
#endif

} // namespace detail

/// What the comparison of two packs gives: in each lane all bits set (true) or none. `Bytes` is the size of a lane.
template <std::size_t Bytes, int W>
struct pack_mask {
    /// The integer that a lane is.
    using element = typename detail::signed_of_size<Bytes>::type;
    /// What holds the lanes.
    using vector = typename detail::vector_of<element, W>::type;
    vector v; ///< the lanes

    /// Lanes of any value.
    pack_mask() = default;
    /// The mask of these lanes.
    MICA_HOST_DEVICE constexpr pack_mask(const vector& lanes) : v(lanes) {}
    /// The same lanes.
    MICA_HOST_DEVICE constexpr pack_mask(const pack_mask& other) : v(other.v) {}
    /// Takes the lanes of another.
    MICA_HOST_DEVICE constexpr pack_mask& operator=(const pack_mask& other) {
        v = other.v;
        return *this;
    }

    /// Lane i.
    MICA_HOST_DEVICE bool operator[](int i) const { return v[i] != 0; }

#if MICA_VECTOR_EXTENSIONS
    /// Lane by lane.
    friend pack_mask operator&&(pack_mask a, pack_mask b) { return {a.v & b.v}; }
    /// Lane by lane.
    friend pack_mask operator||(pack_mask a, pack_mask b) { return {a.v | b.v}; }
    /// Lane by lane.
    friend pack_mask operator!(pack_mask a) { return {~a.v}; }
#else
    template <class Operation>
    MICA_HOST_DEVICE static pack_mask each(Operation operation) {
        pack_mask result{vector{}};
        for (int i = 0; i < W; ++i) result.v[i] = operation(i) ? element(-1) : element(0);
        return result;
    }
    MICA_HOST_DEVICE friend pack_mask operator&&(pack_mask a, pack_mask b) {
        return each([&](int i) { return a[i] && b[i]; });
    }
    MICA_HOST_DEVICE friend pack_mask operator||(pack_mask a, pack_mask b) {
        return each([&](int i) { return a[i] || b[i]; });
    }
    MICA_HOST_DEVICE friend pack_mask operator!(pack_mask a) {
        return each([&](int i) { return !a[i]; });
    }
#endif
};

/// W numbers of type T (float, double, or a 32- or 64-bit integer), W a power of two. Arithmetic, comparison and
/// integer operators work lane by lane; a plain number converts to a pack of equal lanes.
template <class T, int W>
struct pack {
    static_assert(W >= 1 && (W & (W - 1)) == 0, "the lanes of a pack are a power of two");
    /// One lane.
    using value_type = T;
    /// What a comparison gives.
    using mask = pack_mask<sizeof(T), W>;
    /// What holds the lanes: a vector of the compiler, or an array.
    using vector = typename detail::vector_of<T, W>::type;
    vector v; ///< the lanes

    /// Lanes of any value.
    pack() = default;
    /// The same lanes.
    MICA_HOST_DEVICE constexpr pack(const pack& other) : v(other.v) {}
    /// Takes the lanes of another.
    MICA_HOST_DEVICE constexpr pack& operator=(const pack& other) {
        v = other.v;
        return *this;
    }
    /// The pack of these lanes.
    MICA_HOST_DEVICE explicit constexpr pack(const vector& lanes) : v(lanes) {}

    /// The same value in every lane.
    template <arithmetic Scalar>
    MICA_HOST_DEVICE constexpr pack(Scalar value) : v{} {
#if MICA_VECTOR_EXTENSIONS
        v = static_cast<T>(value) - v; // x - 0 keeps the sign of -0, x + 0 does not
#else
        for (int i = 0; i < W; ++i) v[i] = static_cast<T>(value);
#endif
    }

    /// Lane i.
    MICA_HOST_DEVICE T operator[](int i) const { return v[i]; }
    /// Sets lane i.
    MICA_HOST_DEVICE void set(int i, T value) { v[i] = value; }

    /// W consecutive elements in memory.
    MICA_HOST_DEVICE static pack load(const T* from) {
        pack result;
        std::memcpy(&result.v, from, sizeof(vector)); // lane by lane it would go through memory once more
        return result;
    }
    /// To W consecutive elements in memory.
    MICA_HOST_DEVICE void store(T* to) const { std::memcpy(to, &v, sizeof(vector)); }

    /// start, start + 1, ..., start + W - 1
    MICA_HOST_DEVICE static pack iota(T start) {
        // Written out, not a loop: one constant, which never sees memory lane by lane.
        return [start]<int... Lane>(std::integer_sequence<int, Lane...>) {
            return pack(vector{static_cast<T>(Lane)...}) + pack(start);
        }
        (std::make_integer_sequence<int, W>());
    }

#if MICA_VECTOR_EXTENSIONS
#define MICA_PACK_OPERATOR(op)                                                                                         \
    MICA_WIDE friend pack operator op(pack a, pack b) {                                                                \
        MICA_CONTRACT                                                                                                  \
        return pack(a.v op b.v);                                                                                       \
    }
#define MICA_PACK_COMPARISON(op)                                                                                       \
    friend mask operator op(pack a, pack b) { return {a.v op b.v}; }
#define MICA_PACK_SHIFT(op)                                                                                            \
    friend pack operator op(pack a, int places) { return pack(a.v op static_cast<T>(places)); }
    /// Lane by lane.
    friend pack operator-(pack a) { return pack(-a.v); }
#else
    template <class Operation>
    MICA_HOST_DEVICE static pack each(Operation operation) {
        pack result;
        for (int i = 0; i < W; ++i) result.v[i] = static_cast<T>(operation(i));
        return result;
    }
#define MICA_PACK_OPERATOR(op)                                                                                         \
    MICA_HOST_DEVICE friend pack operator op(pack a, pack b) {                                                         \
        return each([&](int i) { return a[i] op b[i]; });                                                              \
    }
#define MICA_PACK_COMPARISON(op)                                                                                       \
    MICA_HOST_DEVICE friend mask operator op(pack a, pack b) {                                                         \
        return mask::each([&](int i) { return a[i] op b[i]; });                                                        \
    }
#define MICA_PACK_SHIFT(op)                                                                                            \
    MICA_HOST_DEVICE friend pack operator op(pack a, int places) {                                                     \
        return each([&](int i) { return a[i] op places; });                                                            \
    }
    /// Lane by lane.
    MICA_HOST_DEVICE friend pack operator-(pack a) {
        return each([&](int i) { return -a[i]; });
    }
#endif
    MICA_PACK_OPERATOR(+)
    MICA_PACK_OPERATOR(-)
    MICA_PACK_OPERATOR(*)
    MICA_PACK_OPERATOR(/)
    MICA_PACK_OPERATOR(&)
    MICA_PACK_OPERATOR(|)
    MICA_PACK_OPERATOR(^)
    MICA_PACK_SHIFT(<<)
    MICA_PACK_SHIFT(>>)
    MICA_PACK_COMPARISON(<)
    MICA_PACK_COMPARISON(<=)
    MICA_PACK_COMPARISON(>)
    MICA_PACK_COMPARISON(>=)
    MICA_PACK_COMPARISON(==)
#undef MICA_PACK_OPERATOR
#undef MICA_PACK_COMPARISON
#undef MICA_PACK_SHIFT
};

template <class T, int W>
struct number_traits<pack<T, W>> {
    using scalar = T;
    using integer = pack<typename detail::signed_of_size<sizeof(T)>::type, W>;
    using bits = pack<std::make_unsigned_t<typename detail::signed_of_size<sizeof(T)>::type>, W>;
    using index = pack<std::uint32_t, W>;
    using mask = pack_mask<sizeof(T), W>;
    static constexpr int lanes = W;
};

/// if_true where the mask holds, if_false elsewhere. Both are evaluated.
template <class T, int W>
MICA_HOST_DEVICE inline pack<T, W> select(pack_mask<sizeof(T), W> mask, pack<T, W> if_true,
                                          std::type_identity_t<pack<T, W>> if_false) {
#if MICA_VECTOR_EXTENSIONS
    return pack<T, W>(mask.v ? if_true.v : if_false.v);
#else
    return pack<T, W>::each([&](int i) { return mask[i] ? if_true[i] : if_false[i]; });
#endif
}

// The instructions for the smaller and the larger of two numbers say what minimum() and maximum() of number.hpp say, to
// the NaN; clang finds them by itself, g++ 12 makes a comparison and a blend.
#if MICA_VECTOR_EXTENSIONS && !defined(__clang__) && defined(__SSE2__)
#define MICA_PACK_MINMAX(T, W, smaller, larger)                                                                        \
    inline pack<T, W> minimum(const pack<T, W>& a, const pack<T, W>& b) { return pack<T, W>(smaller(a.v, b.v)); }      \
    inline pack<T, W> maximum(const pack<T, W>& a, const pack<T, W>& b) { return pack<T, W>(larger(a.v, b.v)); }
MICA_PACK_MINMAX(float, 4, __builtin_ia32_minps, __builtin_ia32_maxps)
MICA_PACK_MINMAX(double, 2, __builtin_ia32_minpd, __builtin_ia32_maxpd)
#if defined(__SSE4_1__)
MICA_PACK_MINMAX(std::int32_t, 4, __builtin_ia32_pminsd128, __builtin_ia32_pmaxsd128)
#endif
#if defined(__AVX__)
MICA_PACK_MINMAX(float, 8, __builtin_ia32_minps256, __builtin_ia32_maxps256)
MICA_PACK_MINMAX(double, 4, __builtin_ia32_minpd256, __builtin_ia32_maxpd256)
#endif
#if defined(__AVX2__)
MICA_PACK_MINMAX(std::int32_t, 8, __builtin_ia32_pminsd256, __builtin_ia32_pmaxsd256)
#endif
#if defined(__AVX512F__)
// All lanes, rounding as set (4).
#define MICA_SMALLER_512(a, b) __builtin_ia32_minps512_mask(a, b, a, static_cast<short>(-1), 4)
#define MICA_LARGER_512(a, b) __builtin_ia32_maxps512_mask(a, b, a, static_cast<short>(-1), 4)
MICA_PACK_MINMAX(float, 16, MICA_SMALLER_512, MICA_LARGER_512)
#undef MICA_SMALLER_512
#undef MICA_LARGER_512
#define MICA_SMALLER_512(a, b) __builtin_ia32_minpd512_mask(a, b, a, static_cast<signed char>(-1), 4)
#define MICA_LARGER_512(a, b) __builtin_ia32_maxpd512_mask(a, b, a, static_cast<signed char>(-1), 4)
MICA_PACK_MINMAX(double, 8, MICA_SMALLER_512, MICA_LARGER_512)
#undef MICA_SMALLER_512
#undef MICA_LARGER_512
#endif
#undef MICA_PACK_MINMAX
#endif

/// Whether the mask holds in any lane.
template <std::size_t Bytes, int W>
MICA_HOST_DEVICE inline bool any(pack_mask<Bytes, W> mask) {
    bool result = false;
    for (int i = 0; i < W; ++i) result |= mask[i];
    return result;
}

/// Whether the mask holds in every lane.
template <std::size_t Bytes, int W>
MICA_HOST_DEVICE inline bool all(pack_mask<Bytes, W> mask) {
    return !any(!mask);
}

/// Lane by lane, truncating towards zero. A real must lie within the range of the integer.
template <class To, class T, int W>
    requires(lanes_of<To> == W)
MICA_HOST_DEVICE inline To convert(pack<T, W> value) {
#if MICA_VECTOR_EXTENSIONS
    return To(__builtin_convertvector(value.v, typename To::vector));
#else
    return To::each([&](int i) { return value[i]; });
#endif
}

/// The same bits under another type of the same size.
template <class To, class T, int W>
    requires(sizeof(To) == sizeof(pack<T, W>))
MICA_HOST_DEVICE inline To reinterpret(pack<T, W> value) {
    return To(__builtin_bit_cast(typename To::vector, value.v));
}

/// Lane `i`.
template <class T, int W>
MICA_HOST_DEVICE inline T lane(pack<T, W> value, int i) {
    return value[i];
}

/// Sets lane `i`.
template <class T, int W>
MICA_HOST_DEVICE inline void set_lane(pack<T, W>& number, int i, T value) {
    number.set(i, value);
}

} // namespace mica
