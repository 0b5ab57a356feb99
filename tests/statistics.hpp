// tests/statistics.hpp: the statistics that the tests share.
//
// Every statistical test of the suite asks passes() of one p-value: a family error of 1e-6 split by Sidak over at most
// tests_in_family tests, so that the whole suite, run with other seeds, would fail once in a million times. The p-values
// asked for are noted, and tests/family_test.cpp counts them. References come from Boost.Math, never from the code
// under test.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace statistics {

inline constexpr double family_error = 1e-6;

/// No fewer than the p-values that all test files together compare with significance().
inline constexpr int tests_in_family = 2000;

/// The error of each of `tests` independent tests whose family has the error `family`: 1 - (1-family)^(1/tests).
inline double sidak_share(double family, int tests) { return -std::expm1(std::log1p(-family) / tests); }

/// The p-value of the smallest of `tests` independent p-values.
inline double sidak_smallest(double smallest, int tests) {
    return smallest < 1 ? -std::expm1(tests * std::log1p(-smallest)) : 1;
}

/// The smallest p-value that a passing test may have.
inline double significance() { return sidak_share(family_error, tests_in_family); }

/// Whether a test with this p-value passes. Notes the p-value in the folder that MICA_P_VALUES names, if it does.
bool passes(double p_value);

/// Mean and variance of a sample, by Welford's updates. A NaN in the sample makes both NaN.
class running_moments {
  public:
    void add(double x) {
        count_ += 1;
        const double from_mean = x - mean_;
        mean_ += from_mean / count_;
        squares_ += from_mean * (x - mean_);
    }

    double count() const { return count_; }
    double mean() const { return mean_; }
    double variance() const { return squares_ / (count_ - 1); }
    double standard_error() const { return std::sqrt(variance() / count_); }

  private:
    double count_ = 0;
    double mean_ = 0;
    double squares_ = 0;
};

/// The covariance of two variables.
class running_covariance {
  public:
    void add(double x, double y) {
        count_ += 1;
        const double x_from_mean = x - x_mean_;
        x_mean_ += x_from_mean / count_;
        y_mean_ += (y - y_mean_) / count_;
        products_ += x_from_mean * (y - y_mean_);
    }

    double covariance() const { return products_ / (count_ - 1); }

  private:
    double count_ = 0;
    double x_mean_ = 0;
    double y_mean_ = 0;
    double products_ = 0;
};

/// The standard normal distribution, P(Z <= z), and its inverse.
double normal_cdf(double z);
double normal_quantile(double probability);
long double normal_quantile(long double probability);

/// Two-sided p-value of a standard normal statistic; 0 where it is NaN.
double normal_p_value(double z);

/// p-value of a sample mean whose expectation and single-draw standard deviation are known.
inline double mean_p_value(const running_moments& sample, double mean, double deviation) {
    return normal_p_value((sample.mean() - mean) / (deviation / std::sqrt(sample.count())));
}

/// p-value of a sample variance of a law that is nearly normal: the variance of the estimate is 2 sigma^4 / n.
inline double variance_p_value(const running_moments& sample, double variance) {
    return normal_p_value((sample.variance() / variance - 1) / std::sqrt(2 / (sample.count() - 1)));
}

/// Mean, variance and fourth central moment of a law.
struct law_moments {
    double mean, variance, fourth;
};

/// Those of the binomial; real trials are floor(trials) or one more, with that mean.
law_moments binomial_moments(double trials, double p);

/// p-values of a sample's mean and variance, given the law's moments.
inline double mean_p_value(const running_moments& sample, const law_moments& law) {
    return mean_p_value(sample, law.mean, std::sqrt(law.variance));
}
double variance_p_value(const running_moments& sample, const law_moments& law);

/// p-value of the largest difference of two distribution functions, one of `draws` draws: the limit of Kolmogorov's
/// distribution, which is too large, never too small, where the law has steps.
double kolmogorov_p_value(double largest_difference, double draws);

/// Two-sided exact p-value of `observed` successes in `draws` trials of the given probability.
double binomial_p_value(double observed, double draws, double probability);

/// Adjacent cells [first, last) of a histogram that are judged as one.
struct pool {
    std::size_t first;
    std::size_t last;
};

inline double sum(std::span<const double> values, pool range) {
    double total = 0;
    for (std::size_t i = range.first; i < range.last; ++i) total += values[i];
    return total;
}

/// Pools adjacent cells until each pool expects `least` draws. The tails are pooled first, each from its own end
/// inwards: pooling sorted cells would merge the two, and draws moved from one tail to the other would not be seen.
std::vector<pool> pooled(std::span<const double> probabilities, double draws, double least);

/// The smallest expectation of a pool, from which on the chi-square distribution is a good stand-in.
inline constexpr double least_expected = 10;

/// How many p-values goodness_of_fit() takes the smallest of.
inline constexpr int lenses = 8;

struct fit {
    double p_value;
    double chi_square;
    int degrees;
    std::size_t worst_cell; ///< first cell of the pool farthest from its expectation
};

/// Upper tail of the chi-square distribution.
double chi_square_p_value(double chi_square, int degrees);

/// Whether draws follow cells of known probability, adjacent cells being neighbours. Eight lenses: chi-square over the
/// pools; exact tests of the number of draws in either tail's pool, of the farthest cell reached in either tail, and
/// of the first and the last cell (P(0) and P(N) where they are in reach); Kolmogorov-Smirnov. p-value 0 where a cell of
/// probability 0 was hit or the probabilities do not sum to 1.
fit goodness_of_fit(std::span<const double> probabilities, std::span<const double> observed);

/// The chance that goodness_of_fit() passes `draws` draws whose cells have the probabilities `actual` instead of
/// `stated`, if a fit with a p-value below `significance` does not: an upper bound, from its
/// chi-square lens alone.
double chance_of_missing(std::span<const double> stated, std::span<const double> actual, double draws,
                         double significance = statistics::significance());

/// A histogram of whole numbers: cell i holds [first + i width, first + (i+1) width), the first cell also what is
/// below, the last also what is above, down and up to the ends of the support.
class histogram {
  public:
    histogram(double first, double width, std::size_t cells, double largest)
        : first_(first), width_(width), largest_(largest), observed_(cells, 0.) {}

    void add(double x) {
        if (!(x >= 0 && x <= largest_ && x == std::floor(x))) {
            outside_ += 1;
            return;
        }
        const double cell = std::clamp((x - first_) / width_, 0., static_cast<double>(observed_.size() - 1));
        observed_[static_cast<std::size_t>(cell)] += 1;
    }

    /// Draws that were no whole number in [0, largest].
    double outside() const { return outside_; }
    std::span<const double> observed() const { return observed_; }

  private:
    double first_;
    double width_;
    double largest_;
    double outside_ = 0;
    std::vector<double> observed_;
};

/// P(X = k) for integer trials.
double binomial_probability(double trials, double probability, double k);

/// P(X <= k) for integer trials, which may be 0.
double binomial_cdf(double trials, double probability, double k);

/// P(X > k)
double binomial_survival(double trials, double probability, double k);

/// P(low <= X < high), from the tail that it lies in, so that it has digits in both.
double binomial_interval(double trials, double probability, double low, double high);

/// The cells in which binomial counts of `trials` (real: floor(trials) or one more, with that mean) are judged: up to
/// some 150, an eighth of a standard deviation wide where that is more than 1, nine standard deviations to each side.
class binomial_cells {
  public:
    binomial_cells(double trials, double probability) : trials_(trials) {
        const double mean = trials * probability;
        const double deviation = std::sqrt(mean * (1 - probability));
        width_ = (std::max)(1., std::floor(deviation / 8));
        first_ = (std::max)(0., std::floor(mean - 9 * deviation));
        const double last = (std::min)(std::ceil(trials), std::ceil(mean + 9 * deviation) + 20);
        size_ = static_cast<std::size_t>(std::floor((last - first_) / width_)) + 1;
        probabilities_ = of(probability);
    }

    /// The probabilities of the same cells under another success probability.
    std::vector<double> of(double probability) const {
        const double whole = std::floor(trials_);
        const double fraction = trials_ - whole;
        std::vector<double> result(size_);
        for (std::size_t i = 0; i < size_; ++i) {
            const double low = i == 0 ? 0 : first_ + static_cast<double>(i) * width_;
            const double high = i + 1 == size_ ? trials_ + 2 : first_ + static_cast<double>(i + 1) * width_;
            result[i] = (1 - fraction) * binomial_interval(whole, probability, low, high);
            if (fraction > 0) result[i] += fraction * binomial_interval(whole + 1, probability, low, high);
        }
        return result;
    }

    const std::vector<double>& probabilities() const { return probabilities_; }
    histogram empty() const { return histogram(first_, width_, size_, std::ceil(trials_)); }

    /// The first whole number of a cell.
    double start_of(std::size_t cell) const { return first_ + static_cast<double>(cell) * width_; }

  private:
    double trials_;
    double width_;
    double first_;
    std::size_t size_;
    std::vector<double> probabilities_;
};

/// goodness_of_fit() of counts, p-value 0 where one was outside the support.
inline fit goodness_of_fit(const binomial_cells& cells, const histogram& counts) {
    fit result = goodness_of_fit(cells.probabilities(), counts.observed());
    if (counts.outside() > 0) result.p_value = 0;
    return result;
}

} // namespace statistics
