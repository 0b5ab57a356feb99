// mica/law/multinomial_distribution.hpp: the multinomial as a std-style distribution, for any number of categories.
//
//     std::mt19937_64 generator(2026);
//     mica::multinomial_distribution<> flashes(1'000'000, {1e-6, 3e-6, 2e-7});
//     std::vector<int> counts = flashes(generator);
//
// The requirements of a random number distribution with std::vector<Int> for the result; min() and max() are vectors of
// 0 and of t. The counts sum to t less those of the category "none", which has what the probabilities leave of 1 (law/
// multinomial.hpp); write 1 - the others for the last where there is none.
//
// Draws: those of the law, 64 bits each, in the order of the tree's nodes.
// Errors: no category at all, t outside [0, 2^53], a probability outside [0,1] or NaN, or a sum above 1 + 1e-6 (which
//   forgives probabilities computed in float; such a sum counts as 1) call MICA_FAIL, which throws
//   std::invalid_argument. A stream that holds no such parameters sets failbit and leaves the distribution as it was.
// Host only, and it allocates: multinomial<K, Law> and multinomial<std::dynamic_extent, Law> do not.
#pragma once

#include <initializer_list>
#include <iosfwd>
#include <span>
#include <vector>

#include "../random/generator_uniforms.hpp"
#include "distribution_stream.hpp"
#include "exact.hpp"
#include "multinomial.hpp"

namespace mica {

namespace detail {

/// What probabilities that were computed in float may sum to.
inline constexpr double largest_sum = 1 + 1e-6;

inline double sum_of(std::span<const double> values) {
    double result = 0;
    for (const double value : values) result += value;
    return result;
}

inline bool are_probabilities(std::span<const double> values) {
    for (const double value : values)
        if (!is_probability(value)) return false;
    return !values.empty() && sum_of(values) <= largest_sum;
}

} // namespace detail

/// The counts of the categories among t trials, as a distribution of the standard library would be, by any law of integer counts.
template <std::integral Int = int, integer_binomial_law<double> Law = exact_binomial>
class multinomial_distribution {
  public:
    /// What a call returns: one count for each category.
    using result_type = std::vector<Int>;

    /// t and the probabilities.
    class param_type {
      public:
        /// The distribution that these are the parameters of.
        using distribution_type = multinomial_distribution;

        /// One trial, one category that has it.
        param_type() : param_type(1, {1.}) {}
        /// t in [0, 2^53], probabilities in [0, 1] with a sum of at most 1; fails otherwise.
        param_type(Int t, std::initializer_list<double> probabilities)
            : param_type(t, std::span<const double>(probabilities.begin(), probabilities.size())) {}
        /// t in [0, 2^53], probabilities in [0, 1] with a sum of at most 1; fails otherwise.
        param_type(Int t, std::span<const double> probabilities)
            : t_(t), probabilities_(probabilities.begin(), probabilities.end()) {
            if (!detail::countable(t)) MICA_FAIL("t", t, "in [0, 2^53]");
            if (probabilities.empty()) MICA_FAIL("the number of categories", 0, "positive");
            for (const double p : probabilities)
                if (!detail::is_probability(p)) MICA_FAIL("a probability", p, "in [0,1]");
            if (!detail::are_probabilities(probabilities))
                MICA_FAIL("the sum of the probabilities", detail::sum_of(probabilities), "at most 1");
        }

        Int t() const { return t_; } ///< trials
        /// One for each category.
        const std::vector<double>& probabilities() const { return probabilities_; }

        /// Whether t and the probabilities are equal.
        friend bool operator==(const param_type&, const param_type&) = default;

      private:
        Int t_;
        std::vector<double> probabilities_;
    };

    /// One trial, one category that has it.
    multinomial_distribution() = default;
    /// Parameters as for param_type.
    multinomial_distribution(Int t, std::initializer_list<double> probabilities) : param_(t, probabilities) {}
    /// Parameters as for param_type.
    multinomial_distribution(Int t, std::span<const double> probabilities) : param_(t, probabilities) {}
    /// The distribution with these parameters.
    explicit multinomial_distribution(const param_type& param) : param_(param) {}

    /// Does nothing: nothing is kept between calls.
    void reset() {}

    /// The count of each category.
    template <std::uniform_random_bit_generator Generator>
    result_type operator()(Generator& generator) const {
        return (*this)(generator, param_);
    }

    /// The same with other parameters than the distribution's own.
    template <std::uniform_random_bit_generator Generator>
    result_type operator()(Generator& generator, const param_type& param) const {
        const std::span<const double> probabilities(param.probabilities());
        std::vector<double> counts(probabilities.size());
        multinomial<std::dynamic_extent, Law>{}(static_cast<double>(param.t()), probabilities,
                                                generator_uniforms<double, Generator>(generator),
                                                std::span<double>(counts));
        result_type result;
        result.reserve(counts.size());
        for (const double count : counts) result.push_back(static_cast<Int>(count));
        return result;
    }

    Int t() const { return param_.t(); } ///< trials
    /// One for each category.
    const std::vector<double>& probabilities() const { return param_.probabilities(); }
    param_type param() const { return param_; } ///< t and the probabilities
    /// Takes other parameters.
    void param(const param_type& param) { param_ = param; }
    /// Zeros.
    result_type(min)() const { return result_type(param_.probabilities().size(), 0); }
    /// t for each.
    result_type(max)() const { return result_type(param_.probabilities().size(), param_.t()); }

    /// Whether the parameters are equal, and with them what equal generators give.
    friend bool operator==(const multinomial_distribution&, const multinomial_distribution&) = default;

    /// "t K p_1 ... p_K", probabilities with all their digits.
    template <class Character, class Traits>
    friend std::basic_ostream<Character, Traits>& operator<<(std::basic_ostream<Character, Traits>& out,
                                                             const multinomial_distribution& distribution) {
        const detail::distribution_format format(out);
        out << +distribution.t() << ' ' << distribution.probabilities().size();
        for (const double p : distribution.probabilities()) out << ' ' << p;
        return out;
    }

    /// Reads what << wrote; sets failbit, and changes nothing, where that is not what is there.
    template <class Character, class Traits>
    friend std::basic_istream<Character, Traits>& operator>>(std::basic_istream<Character, Traits>& in,
                                                             multinomial_distribution& distribution) {
        const detail::distribution_format format(in);
        long long t = 0;
        std::size_t size = 0;
        if (!(in >> t >> size)) return in;
        std::vector<double> probabilities; // grows as it is read: a wrong size must not allocate what is not there
        for (double p = 0; probabilities.size() < size && in >> p;) probabilities.push_back(p);
        if (!in) return in;
        if (!detail::is_count_of<Int>(t) || !detail::are_probabilities(probabilities)) {
            in.setstate(std::basic_istream<Character, Traits>::failbit);
            return in;
        }
        distribution = multinomial_distribution(static_cast<Int>(t), std::span<const double>(probabilities));
        return in;
    }

  private:
    param_type param_;
};

} // namespace mica
