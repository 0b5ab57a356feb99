// tests/enumeration.hpp: the distribution of a law's outcome, computed and not sampled.
//
// A law is a function of its uniforms, and a uniform_stream<float> can give 2^31 of them. Where the outcome moves one
// way in a uniform, bisection finds how many of the 2^31 give each count: no noise, no seed. A second uniform takes
// few decisions (a gate, the rounding of real trials); its pieces are found in the same way.
//
// Of successes and failures the rarer are counted: beyond p = 1/2 the failures, of which Real keeps the digits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <mica/law/bernoulli_sum.hpp>
#include <mica/law/dual_gated.hpp>
#include <mica/law/exact.hpp>
#include <mica/law/floored_gated.hpp>
#include <mica/law/gated.hpp>
#include <mica/law/gaussian.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>
#include <mica/random/uniform.hpp>

#include "statistics.hpp"

namespace enumeration {

/// The number of a float uniform, 0 to 2^31 - 1, in increasing order.
using uniform_number = std::uint32_t;
inline constexpr uniform_number last_uniform = 0x7fffffffU;
inline constexpr double uniforms = 0x1p31;

inline float uniform_of(uniform_number number) { return mica::uniform_from_bits<float>(number << 1); }

/// Which of a law's uniforms decides among few cases, and in which the count does not change direction; -1: none.
struct uniform_roles {
    int choice;
    int count;
};

template <class Law>
inline constexpr uniform_roles roles_of{-1, 0};
template <class Gate>
inline constexpr uniform_roles roles_of<mica::basic_gated_binomial<Gate>>{0, 1};
template <class Gate>
inline constexpr uniform_roles roles_of<mica::basic_floored_gated_binomial<Gate>>{0, 1};
template <class Gate>
inline constexpr uniform_roles roles_of<mica::basic_dual_gated_binomial<Gate>>{0, 1};
template <int Gates>
inline constexpr uniform_roles roles_of<mica::quantile_binomial<Gates>>{1, 0};

inline double rarer_probability(float probability) {
    const auto p = static_cast<double>(probability);
    return p > 0.5 ? 1 - p : p;
}

template <class Real>
double rarer_count(const mica::counts<Real>& outcome, float probability) {
    return static_cast<double>(probability > 0.5F ? outcome.failures : outcome.successes);
}

/// A law's outcome at given uniforms.
template <class Law>
mica::counts<float> outcome_at(float trials, float probability, uniform_number choice, uniform_number count) {
    int drawn = 0;
    return Law{}(trials, probability, [&] { return uniform_of(drawn++ == roles_of<Law>.choice ? choice : count); });
}

/// Calls visit(first, last, key) for the stretches of uniforms in which key(number) is constant. Between two uniforms
/// of equal key the key must not change: so for every monotone one.
template <class Key, class Visit>
void each_stretch(const Key& key, const Visit& visit, uniform_number first = 0, uniform_number last = last_uniform) {
    using value = decltype(key(first));
    const auto split = [&](const auto& self, uniform_number low, const value& at_low, uniform_number high,
                           const value& at_high) -> void {
        if (at_low == at_high) {
            visit(low, high, at_low);
        } else if (high - low == 1) {
            visit(low, low, at_low);
            visit(high, high, at_high);
        } else {
            const uniform_number middle = low + (high - low) / 2;
            const value at_middle = key(middle);
            self(self, low, at_low, middle, at_middle);
            if (middle + 1 <= high) self(self, middle + 1, key(middle + 1), high, at_high);
        }
    };
    split(split, first, key(first), last, key(last));
}

/// Counts of the rarer outcome in cells of equal width, wide ones where the spread is large, and the moments of the
/// unrounded counts.
class outcome_table {
  public:
    /// Cells nine standard deviations to each side of the mean and 40 counts more, no wider than a sixteenth of one.
    outcome_table(float trials, float probability)
        : trials_(static_cast<double>(trials)), probability_(rarer_probability(probability)),
          mean_(trials_ * probability_) {
        const double deviation = std::sqrt(mean_ * (1 - probability_));
        width_ = std::max(1., std::floor(deviation / 16));
        first_ = std::max(0., std::floor(mean_ - 9 * deviation) - 1);
        const double last = std::min(std::ceil(trials_), std::ceil(mean_ + 9 * deviation) + 40);
        mass_.assign(static_cast<std::size_t>(std::floor((last - first_) / width_)) + 1, 0.);
    }

    /// The cell of a count, rounded to the nearest integer; counts beyond the ends belong to the end cells.
    std::size_t cell_of(double count) const {
        const double cell = std::floor((std::floor(count + 0.5) - first_) / width_);
        return static_cast<std::size_t>(std::clamp(cell, 0., static_cast<double>(mass_.size() - 1)));
    }

    /// `mass` of outcomes at a count.
    void add(double count, double mass) {
        mass_[cell_of(count)] += mass;
        add_moments(count, mass);
        if (count < 0.5) none_ += mass;
    }

    double first() const { return first_; }
    double width() const { return width_; }
    const std::vector<double>& mass() const { return mass_; }
    double none() const { return none_; } ///< P(count rounds to 0)
    double mean() const { return mean_ + first_moment_; }
    double variance() const { return second_moment_ - first_moment_ * first_moment_; }
    double total() const { return total_; }

    /// Masses of the binomial in the same cells; real trials are floor(trials) or one more.
    std::vector<double> binomial() const {
        const double whole = std::floor(trials_), part = trials_ - whole;
        std::vector<double> result(mass_.size());
        for (std::size_t i = 0; i < result.size(); ++i) {
            const double low = i == 0 ? 0 : first_ + static_cast<double>(i) * width_;
            const double high = i + 1 == result.size() ? trials_ + 2 : first_ + static_cast<double>(i + 1) * width_;
            result[i] = interval(whole, low, high, i);
            if (part > 0) result[i] = (1 - part) * result[i] + part * interval(whole + 1, low, high, i);
        }
        return result;
    }

  private:
    double interval(double n, double low, double high, std::size_t cell) const {
        if (cell == 0 || cell + 1 == mass_.size() || width_ > 1 || n < 1)
            return statistics::binomial_interval(n, probability_, low, high);
        return statistics::binomial_probability(n, probability_, low);
    }

    void add_moments(double count, double mass) {
        total_ += mass;
        first_moment_ += mass * (count - mean_);
        second_moment_ += mass * (count - mean_) * (count - mean_);
    }

    double trials_, probability_, mean_;
    double width_ = 1, first_ = 0;
    std::vector<double> mass_;
    double none_ = 0, total_ = 0, first_moment_ = 0, second_moment_ = 0; // moments about the binomial's mean
};

/// Adds a law's outcomes, `mass` of them, along its count uniform at one choice.
template <class Law>
void add_along_count(outcome_table& table, float trials, float probability, uniform_number choice, double mass) {
    const auto count_at = [&](uniform_number number) {
        return rarer_count(outcome_at<Law>(trials, probability, choice, number), probability);
    };
    // A stretch of one cell is one count, or many where counts are real or cells wide: those are integrated.
    const bool one_count = Law::integer_counts && table.width() == 1;
    each_stretch([&](uniform_number number) { return table.cell_of(count_at(number)); },
                 [&](uniform_number low, uniform_number high, std::size_t) {
                     const double size = static_cast<double>(high - low) + 1;
                     const int points = one_count ? 1 : static_cast<int>(std::min(64., size));
                     for (int i = 0; i < points; ++i) {
                         const auto at = low + static_cast<uniform_number>(size * (i + 0.5) / points);
                         table.add(count_at(at), mass * size / uniforms / points);
                     }
                 });
}

/// The distribution of a law's rarer outcome.
template <class Law>
struct enumerate {
    static outcome_table of(float trials, float probability) {
        outcome_table table(trials, probability);
        if constexpr (roles_of<Law>.choice < 0) {
            add_along_count<Law>(table, trials, probability, 0, 1);
        } else {
            constexpr uniform_number middle = last_uniform / 2;
            each_stretch(
                [&](uniform_number number) {
                    const auto outcome = outcome_at<Law>(trials, probability, number, middle);
                    return std::pair(outcome.successes, outcome.failures);
                },
                [&](uniform_number low, uniform_number high, const auto&) {
                    const double mass = (static_cast<double>(high - low) + 1) / uniforms;
                    add_along_count<Law>(table, trials, probability, low, mass);
                });
        }
        return table;
    }
};

/// Sixteen trials, the Gaussian and the rounding: 18 uniforms. Which of the trials succeed is enumerated pattern by
/// pattern, each with the probability that the law's own comparison gives one trial.
template <>
struct enumerate<mica::bernoulli_sum_binomial> {
    static outcome_table of(float trials, float probability) {
        outcome_table table(trials, probability);
        const float whole = std::floor(trials);
        const auto trials_drawn = [&](uniform_number number) {
            return at(trials, 0, 0, last_uniform, number).failures;
        };
        each_stretch(trials_drawn, [&](uniform_number low, uniform_number high, float) {
            const double mass = (static_cast<double>(high - low) + 1) / uniforms;
            const float n = whole + (uniform_of(low) < trials - whole ? 1.F : 0.F);
            sums_by_trials(n, probability) ? add_patterns(table, n, probability, mass)
                                           : add_gaussian(table, n, probability, mass);
        });
        return table;
    }

  private:
    static constexpr unsigned patterns = 1U << 16;

    static mica::counts<float> at(float trials, float probability, unsigned pattern, uniform_number gaussian,
                                  uniform_number rounding) {
        unsigned drawn = 0;
        return mica::bernoulli_sum_binomial{}(trials, probability, [&] {
            const unsigned k = drawn++;
            if (k < 16) return uniform_of((pattern >> k) & 1U ? 0 : last_uniform);
            return uniform_of(k == 16 ? gaussian : rounding);
        });
    }

    /// Whether the trials' uniforms matter and the Gaussian's does not.
    static bool sums_by_trials(float n, float p) { return n <= 16 && n * p <= 5; }

    /// P(xi < p) over the uniforms that there are.
    static double success_probability(float p) {
        double result = 0;
        each_stretch([&](uniform_number number) { return uniform_of(number) < p; },
                     [&](uniform_number low, uniform_number high, bool succeeds) {
                         if (succeeds) result += (static_cast<double>(high - low) + 1) / uniforms;
                     });
        return result;
    }

    static void add_patterns(outcome_table& table, float n, float p, double mass) {
        const double success = success_probability(p);
        std::array<double, 17> probability_of_ones{}; // of one pattern with that many ones
        for (int ones = 0; ones <= 16; ++ones)
            probability_of_ones[static_cast<std::size_t>(ones)] =
                std::pow(success, ones) * std::pow(1 - success, 16 - ones);
        for (unsigned pattern = 0; pattern < patterns; ++pattern) {
            const auto ones = static_cast<std::size_t>(__builtin_popcount(pattern));
            table.add(rarer_count(at(n, p, pattern, last_uniform / 2, last_uniform), p),
                      mass * probability_of_ones[ones]);
        }
    }

    static void add_gaussian(outcome_table& table, float n, float p, double mass) {
        const auto count_at = [&](uniform_number number) { return rarer_count(at(n, p, 0, number, last_uniform), p); };
        each_stretch([&](uniform_number number) { return table.cell_of(count_at(number)); },
                     [&](uniform_number low, uniform_number high, std::size_t) {
                         const double size = static_cast<double>(high - low) + 1;
                         for (int i = 0; i < 16; ++i)
                             table.add(count_at(low + static_cast<uniform_number>(size * (i + 0.5) / 16)),
                                       mass * size / uniforms / 16);
                     });
    }
};

/// Rejection draws pairs (u, v) until one is accepted. u alone fixes the count, v whether it is accepted, so a count
/// has the share of the square in which it is drawn and accepted: v by bisection, u by Gauss's rule over the stretch
/// of each count. Inversion draws one uniform. The law is fed doubles; integer trials only.
template <>
struct enumerate<mica::exact_binomial> {
    static outcome_table of(float trials, float probability) {
        const auto n = static_cast<double>(trials), p = static_cast<double>(probability);
        outcome_table table(trials, probability);
        if (draws_one(n, p)) {
            each_stretch([&](uniform_number number) { return at(n, p, uniform_at(number), 0.5).count; },
                         [&](uniform_number low, uniform_number high, double count) {
                             table.add(count, (static_cast<double>(high - low) + 1) / uniforms);
                         });
            return table;
        }
        std::vector<std::pair<double, double>> shares; // count, accepted share of the square
        double accepted = 0;
        each_stretch(
            [&](uniform_number number) {
                const auto first = at(n, p, uniform_at(number), 0x1p-60);
                // Far out nothing is accepted: beyond either end of the support, so that counts go one way in u.
                const double beyond = number < last_uniform / 2 ? -1 : n + 1;
                return first.drawn == 2 ? first.count : beyond;
            },
            [&](uniform_number low, uniform_number high, double count) {
                if (!(count >= 0 && count <= n)) return;
                const double from = static_cast<double>(low) / uniforms;
                const double to = (static_cast<double>(high) + 1) / uniforms;
                const double share = accepted_share(n, p, from, to);
                shares.emplace_back(count, share);
                accepted += share;
            });
        for (const auto& [count, share] : shares) table.add(count, share / accepted);
        return table;
    }

  private:
    static double uniform_at(uniform_number number) { return (static_cast<double>(number) + 0.5) / uniforms; }

    struct try_result {
        double count;
        int drawn;
    };

    /// The rarer outcome's count if the first pair of uniforms is (u, v), and how many uniforms were drawn: 2 if it was accepted. The
    /// next pair is accepted at the mode.
    static try_result at(double n, double p, double u, double v) {
        int drawn = 0;
        const auto counts = mica::exact_binomial{}(n, p, [&] {
            ++drawn;
            return drawn == 1 ? u : drawn == 2 ? v : 0.5;
        });
        return {p > 0.5 ? counts.failures : counts.successes, drawn};
    }

    /// Whether the law inverts, which takes one uniform.
    static bool draws_one(double n, double p) { return at(n, p, 0.5, 0.5).drawn == 1; }

    /// Integral over u from `from` to `to` of the probability of acceptance.
    static double accepted_share(double n, double p, double from, double to) {
        constexpr double kinks[] = {0.07, 0.93}; // the squeeze accepts between them
        for (const double kink : kinks)
            if (from < kink && kink < to) return accepted_share(n, p, from, kink) + accepted_share(n, p, kink, to);
        constexpr double node[] = {-0.9602898564975363, -0.7966664774136267, -0.5255324099163290, -0.1834346424956498,
                                   0.1834346424956498,  0.5255324099163290,  0.7966664774136267,  0.9602898564975363};
        constexpr double weight[] = {0.1012285362903763, 0.2223810344533745, 0.3137066458778873, 0.3626837833783620,
                                     0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
        double sum = 0;
        for (int i = 0; i < 8; ++i) {
            const double u = (from + to) / 2 + (to - from) / 2 * node[i];
            double low = 0, high = 1; // accepted below low, rejected above high
            for (int step = 0; step < 40; ++step) {
                const double middle = (low + high) / 2;
                (at(n, p, u, middle).drawn == 2 ? low : high) = middle;
            }
            sum += weight[i] * low;
        }
        return sum * (to - from) / 2;
    }
};

/// How far a law is from the binomial, all of the rarer outcome's count. N p is its mean.
struct deviation {
    double total_variation; ///< after rounding to the nearest integer
    double kolmogorov;      ///< largest difference of the distribution functions, likewise
    double mean;            ///< E / N p
    double variance;        ///< V / V_binomial
    double none;            ///< P(0)
    double binomial_none;   ///< (1-p)^N
    double tail_3, tail_6;  ///< P(X >= k) over the binomial's, the first k where that is at most 1e-3, 1e-6; else NaN
};

template <class Law>
deviation deviation_of(float trials, float probability) {
    const double n = static_cast<double>(trials), p = rarer_probability(probability);
    const auto table = enumerate<Law>::of(trials, probability);
    const auto binomial = table.binomial();
    deviation result{};
    double below = 0, exact_below = 0;
    for (std::size_t i = 0; i < binomial.size(); ++i) {
        const double difference = table.mass()[i] - binomial[i];
        result.total_variation += std::abs(difference) / 2;
        below += table.mass()[i];
        exact_below += binomial[i];
        result.kolmogorov = std::max(result.kolmogorov, std::abs(below - exact_below));
    }
    result.tail_3 = result.tail_6 = std::numeric_limits<double>::quiet_NaN();
    double above = 0, exact_above = 0;
    for (std::size_t i = binomial.size(); i-- > 0;) {
        above += table.mass()[i];
        exact_above += binomial[i];
        if (exact_above > 0 && exact_above <= 1e-3) result.tail_3 = above / exact_above;
        if (exact_above > 0 && exact_above <= 1e-6) result.tail_6 = above / exact_above;
    }
    const double part = n - std::floor(n);
    result.mean = table.mean() / (n * p);
    result.variance = table.variance() / (n * p * (1 - p) + part * (1 - part) * p * p);
    result.none = table.none();
    result.binomial_none = (1 - part * p) * std::exp(std::floor(n) * std::log1p(-p));
    return result;
}

} // namespace enumeration
