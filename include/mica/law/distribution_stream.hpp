// mica/law/distribution_stream.hpp: what the std-style distributions share: valid parameters, and how they are written.
#pragma once

#include <concepts>
#include <limits>

#include "../numeric/number.hpp"

namespace mica::detail {

/// As many trials as a double counts one by one.
inline constexpr long long most_trials = 1LL << 53;

template <std::integral Int>
constexpr bool countable(Int t) {
    if constexpr (std::signed_integral<Int>)
        if (t < 0) return false;
    return static_cast<unsigned long long>(t) <= static_cast<unsigned long long>(most_trials);
}

/// Whether a number read is a number of trials that Int holds.
template <std::integral Int>
constexpr bool is_count_of(long long t) {
    return countable(t) &&
           static_cast<unsigned long long>(t) <= static_cast<unsigned long long>((std::numeric_limits<Int>::max)());
}

inline bool is_probability(double p) { return !is_nan(p) && p >= 0 && p <= 1; }

/// While it lives a stream writes and reads parameters in one way, whatever its user has set: decimal, all digits of a
/// double, white space between numbers. Afterwards it is as it was.
template <class Stream>
class distribution_format {
  public:
    explicit distribution_format(Stream& stream)
        : stream_(stream), flags_(stream.flags(Stream::dec | Stream::skipws)), precision_(stream.precision(17)) {}
    ~distribution_format() {
        stream_.flags(flags_);
        stream_.precision(precision_);
    }
    distribution_format(const distribution_format&) = delete;
    distribution_format& operator=(const distribution_format&) = delete;

  private:
    Stream& stream_;
    typename Stream::fmtflags flags_;
    decltype(stream_.precision()) precision_;
};

} // namespace mica::detail
