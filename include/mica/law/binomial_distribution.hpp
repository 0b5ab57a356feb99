// mica/law/binomial_distribution.hpp: a law in the clothes of std::binomial_distribution.
//
//     std::mt19937_64 generator(2026);
//     mica::binomial_distribution<> flashes(1'000'000, 1e-6);
//     int n = flashes(generator);
//
// For code written for the standard library. It meets the requirements of a random number distribution
// ([rand.req.dist]), with the std's names: t trials, p the probability of success. Law is any law of integer counts, in
// double; by default the exact one.
//
// Draws: those of the law, 64 bits each. Nothing is kept between calls, so reset() has nothing to do, and a generator
//   alone decides what comes.
// Errors: t < 0, t > 2^53 (beyond which a double does not count), p outside [0,1] or NaN call MICA_FAIL, which throws
//   std::invalid_argument naming the parameter and the value. A stream that holds no such parameters sets failbit and
//   leaves the distribution as it was.
// Host only.
#pragma once

#include <iosfwd>
#include <limits>

#include "../random/generator_uniforms.hpp"
#include "distribution_stream.hpp"
#include "exact.hpp"

namespace mica {

/// The number of successes in t trials of probability p, as the standard's std::binomial_distribution, by any law of integer counts.
template <std::integral Int = int, integer_binomial_law<double> Law = exact_binomial>
class binomial_distribution {
  public:
    /// What a call returns.
    using result_type = Int;

    /// t and p.
    class param_type {
      public:
        /// The distribution that these are the parameters of.
        using distribution_type = binomial_distribution;

        /// t in [0, 2^53], p in [0, 1]; fails otherwise.
        explicit param_type(Int t = 1, double p = 0.5) : t_(t), p_(p) {
            if (!detail::countable(t)) MICA_FAIL("t", t, "in [0, 2^53]");
            if (!detail::is_probability(p)) MICA_FAIL("p", p, "in [0,1]");
        }

        Int t() const { return t_; }    ///< trials
        double p() const { return p_; } ///< probability of a success

        /// Whether t and p are equal.
        friend bool operator==(const param_type&, const param_type&) = default;

      private:
        Int t_;
        double p_;
    };

    /// One trial of probability 1/2.
    binomial_distribution() : binomial_distribution(1) {}
    /// t in [0, 2^53], p in [0, 1]; fails otherwise.
    explicit binomial_distribution(Int t, double p = 0.5) : param_(t, p) {}
    /// The distribution with these parameters.
    explicit binomial_distribution(const param_type& param) : param_(param) {}

    /// Does nothing: nothing is kept between calls.
    void reset() {}

    /// The number of successes, in [0, t].
    template <std::uniform_random_bit_generator Generator>
    result_type operator()(Generator& generator) const {
        return (*this)(generator, param_);
    }

    /// The same with other parameters than the distribution's own.
    template <std::uniform_random_bit_generator Generator>
    result_type operator()(Generator& generator, const param_type& param) const {
        generator_uniforms<double, Generator> xi(generator);
        return static_cast<Int>(Law{}(static_cast<double>(param.t()), param.p(), xi).successes);
    }

    Int t() const { return param_.t(); }        ///< trials
    double p() const { return param_.p(); }     ///< probability of a success
    param_type param() const { return param_; } ///< t and p
    /// Takes other parameters.
    void param(const param_type& param) { param_ = param; }
    result_type(min)() const { return 0; }          ///< 0
    result_type(max)() const { return param_.t(); } ///< t

    /// Whether the parameters are equal, and with them what equal generators give.
    friend bool operator==(const binomial_distribution&, const binomial_distribution&) = default;

    /// "t p", p with all its digits.
    template <class Character, class Traits>
    friend std::basic_ostream<Character, Traits>& operator<<(std::basic_ostream<Character, Traits>& out,
                                                             const binomial_distribution& distribution) {
        const detail::distribution_format format(out);
        return out << +distribution.t() << ' ' << distribution.p();
    }

    /// Reads what << wrote; sets failbit, and changes nothing, where that is not what is there.
    template <class Character, class Traits>
    friend std::basic_istream<Character, Traits>& operator>>(std::basic_istream<Character, Traits>& in,
                                                             binomial_distribution& distribution) {
        const detail::distribution_format format(in);
        long long t = 0;
        double p = 0;
        if (!(in >> t >> p)) return in;
        if (!detail::is_count_of<Int>(t) || !detail::is_probability(p)) {
            in.setstate(std::basic_istream<Character, Traits>::failbit);
            return in;
        }
        distribution = binomial_distribution(static_cast<Int>(t), p);
        return in;
    }

  private:
    param_type param_;
};

} // namespace mica
