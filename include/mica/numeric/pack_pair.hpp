// mica/numeric/pack_pair.hpp: two packs computed side by side, one number type.
//
// A law is one long chain of dependent operations, longer than what a processor looks ahead, so with one pack at a time
// most of its units wait. Two packs in step keep them busy. Wider packs would do the same, but g++ 12 takes vectors
// wider than the registers apart lane by lane.
#pragma once

#include "pack.hpp"

namespace mica {

/// The masks of two packs.
template <class Mask>
struct mask_pair {
    Mask low;  ///< of the first lanes
    Mask high; ///< of the others

    /// Lane by lane.
    MICA_HOST_DEVICE friend mask_pair operator&&(const mask_pair& a, const mask_pair& b) {
        return {a.low && b.low, a.high && b.high};
    }
    /// Lane by lane.
    MICA_HOST_DEVICE friend mask_pair operator||(const mask_pair& a, const mask_pair& b) {
        return {a.low || b.low, a.high || b.high};
    }
    /// Lane by lane.
    MICA_HOST_DEVICE friend mask_pair operator!(const mask_pair& a) { return {!a.low, !a.high}; }
};

/// The lanes of `low`, then those of `high`.
template <class Pack>
struct pack_pair {
    /// One lane.
    using value_type = typename Pack::value_type;
    /// What a comparison gives.
    using mask = mask_pair<typename Pack::mask>;
    Pack low;  ///< the first lanes
    Pack high; ///< the others

    /// Lanes of any value.
    pack_pair() = default;
    /// The lanes of both.
    MICA_HOST_DEVICE pack_pair(const Pack& l, const Pack& h) : low(l), high(h) {}

    /// The same value in every lane.
    template <arithmetic Scalar>
    MICA_HOST_DEVICE pack_pair(Scalar value) : low(value), high(value) {}

    /// Lanes of each pack.
    static constexpr int half = lanes_of<Pack>;
    /// Lane i.
    MICA_HOST_DEVICE value_type operator[](int i) const { return i < half ? low[i] : high[i - half]; }
    /// Sets lane i.
    MICA_HOST_DEVICE void set(int i, value_type value) { i < half ? low.set(i, value) : high.set(i - half, value); }

    /// Consecutive elements in memory.
    MICA_HOST_DEVICE static pack_pair load(const value_type* from) {
        return {Pack::load(from), Pack::load(from + half)};
    }
    /// To consecutive elements in memory.
    MICA_HOST_DEVICE void store(value_type* to) const {
        low.store(to);
        high.store(to + half);
    }
    /// start, start + 1, ...
    MICA_HOST_DEVICE static pack_pair iota(value_type start) {
        return {Pack::iota(start), Pack::iota(static_cast<value_type>(start + value_type{half}))};
    }

#define MICA_PAIR_OPERATOR(op, result)                                                                                 \
    MICA_HOST_DEVICE friend result operator op(const pack_pair& a, const pack_pair& b) {                               \
        return {a.low op b.low, a.high op b.high};                                                                     \
    }
    MICA_PAIR_OPERATOR(+, pack_pair)
    MICA_PAIR_OPERATOR(-, pack_pair)
    MICA_PAIR_OPERATOR(*, pack_pair)
    MICA_PAIR_OPERATOR(/, pack_pair)
    MICA_PAIR_OPERATOR(&, pack_pair)
    MICA_PAIR_OPERATOR(|, pack_pair)
    MICA_PAIR_OPERATOR(^, pack_pair)
    MICA_PAIR_OPERATOR(<, mask)
    MICA_PAIR_OPERATOR(<=, mask)
    MICA_PAIR_OPERATOR(>, mask)
    MICA_PAIR_OPERATOR(>=, mask)
    MICA_PAIR_OPERATOR(==, mask)
#undef MICA_PAIR_OPERATOR
    /// Lane by lane.
    MICA_HOST_DEVICE friend pack_pair operator-(const pack_pair& a) { return {-a.low, -a.high}; }
    /// Lane by lane.
    MICA_HOST_DEVICE friend pack_pair operator<<(const pack_pair& a, int places) {
        return {a.low << places, a.high << places};
    }
    /// Lane by lane.
    MICA_HOST_DEVICE friend pack_pair operator>>(const pack_pair& a, int places) {
        return {a.low >> places, a.high >> places};
    }
};

template <class Pack>
struct number_traits<pack_pair<Pack>> {
    using scalar = scalar_of<Pack>;
    using integer = pack_pair<integer_of<Pack>>;
    using bits = pack_pair<bits_of<Pack>>;
    using index = pack_pair<index_of<Pack>>;
    using mask = mask_pair<mask_of<Pack>>;
    static constexpr int lanes = 2 * lanes_of<Pack>;
};

/// if_true where the mask holds, if_false elsewhere. Both are evaluated.
template <class Pack>
MICA_HOST_DEVICE pack_pair<Pack> select(const mask_pair<mask_of<Pack>>& mask, const pack_pair<Pack>& if_true,
                                        const std::type_identity_t<pack_pair<Pack>>& if_false) {
    return {select(mask.low, if_true.low, if_false.low), select(mask.high, if_true.high, if_false.high)};
}

/// Whether the mask holds in any lane.
template <class Mask>
MICA_HOST_DEVICE bool any(const mask_pair<Mask>& mask) {
    return any(mask.low) || any(mask.high);
}

/// Whether the mask holds in every lane.
template <class Mask>
MICA_HOST_DEVICE bool all(const mask_pair<Mask>& mask) {
    return all(mask.low) && all(mask.high);
}

/// The smaller; b where a is NaN.
template <class Pack>
MICA_HOST_DEVICE pack_pair<Pack> minimum(const pack_pair<Pack>& a, const std::type_identity_t<pack_pair<Pack>>& b) {
    return {minimum(a.low, b.low), minimum(a.high, b.high)};
}

/// The larger; b where a is NaN.
template <class Pack>
MICA_HOST_DEVICE pack_pair<Pack> maximum(const pack_pair<Pack>& a, const std::type_identity_t<pack_pair<Pack>>& b) {
    return {maximum(a.low, b.low), maximum(a.high, b.high)};
}

/// Lane by lane, truncating towards zero. A real must lie within the range of the integer.
template <class To, class Pack>
MICA_HOST_DEVICE To convert(const pack_pair<Pack>& value) {
    using Half = decltype(To::low);
    return {convert<Half>(value.low), convert<Half>(value.high)};
}

/// The same bits under another type of the same size.
template <class To, class Pack>
MICA_HOST_DEVICE To reinterpret(const pack_pair<Pack>& value) {
    using Half = decltype(To::low);
    return {reinterpret<Half>(value.low), reinterpret<Half>(value.high)};
}

/// Lane `i`.
template <class Pack>
MICA_HOST_DEVICE scalar_of<Pack> lane(const pack_pair<Pack>& value, int i) {
    return value[i];
}

/// Sets lane `i`.
template <class Pack>
MICA_HOST_DEVICE void set_lane(pack_pair<Pack>& number, int i, scalar_of<Pack> value) {
    number.set(i, value);
}

} // namespace mica
