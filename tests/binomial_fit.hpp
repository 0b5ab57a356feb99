// tests/binomial_fit.hpp: whether draws are binomial, seen through every lens there is, and what the test is sure to
// see: an error of 1 % RMS of the probabilities.
#pragma once

#include <ostream>

#include "statistics.hpp"

namespace statistics {

struct binomial_case {
    double trials;
    double probability;
};

inline std::ostream& operator<<(std::ostream& out, const binomial_case& c) {
    return out << "N = " << c.trials << ", p = " << c.probability;
}

/// Enough draws to see the smallest error in up to 150 cells.
inline constexpr int fit_draws = 1 << 22;

/// The root of the mean square of a law's relative error, weighted by its probabilities, that is sure to be seen.
inline constexpr double smallest_error = 0.01;

/// Cells whose probabilities are too large and too small in turn, with that root mean square.
inline std::vector<double> with_error(std::span<const double> probabilities, double root_mean_square) {
    double even = 0, odd = 0;
    for (std::size_t i = 0; i < probabilities.size(); ++i) (i % 2 ? odd : even) += probabilities[i];
    std::vector<double> result(probabilities.begin(), probabilities.end());
    const double above = root_mean_square * std::sqrt(odd / even), below = root_mean_square * std::sqrt(even / odd);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] *= i % 2 ? 1 - below : 1 + above;
    return result;
}

/// Draws in the order in which they came: their cells, moments and the correlation of neighbours.
class binomial_sample {
  public:
    explicit binomial_sample(const binomial_case& c)
        : law_(binomial_moments(c.trials, c.probability)), cells_(c.trials, c.probability), counts_(cells_.empty()) {}

    void add(double x) {
        counts_.add(x);
        const double from_mean = x - law_.mean;
        moments_.add(from_mean);
        neighbours_ += from_mean * before_;
        before_ = from_mean;
    }

    /// Four lenses, one of them goodness_of_fit(). The p-value is 0 where a draw was no integer of the support.
    fit judge() const {
        fit result = goodness_of_fit(cells_, counts_);
        const law_moments centred{0, law_.variance, law_.fourth};
        const double lag = neighbours_ / law_.variance / std::sqrt(moments_.count());
        const double smallest = std::min({result.p_value, mean_p_value(moments_, centred),
                                          variance_p_value(moments_, centred), normal_p_value(lag)});
        result.p_value = sidak_smallest(smallest, moment_lenses);
        return result;
    }

    /// The chance that `draws` draws of a law with that error pass.
    double chance_of_missing_an_error(double root_mean_square, double draws) const {
        return chance_of_missing(cells_.probabilities(), with_error(cells_.probabilities(), root_mean_square), draws,
                                 sidak_share(significance(), moment_lenses));
    }

    const binomial_cells& cells() const { return cells_; }

  private:
    static constexpr int moment_lenses = 4;

    law_moments law_;
    binomial_cells cells_;
    histogram counts_;
    running_moments moments_; // about the mean, because 1e15 and its square leave no digits for a variance
    double neighbours_ = 0, before_ = 0;
};

/// Draws draw(0), draw(1), ... judged.
template <class Draw>
fit fit_of(const binomial_case& c, Draw draw, int draws = fit_draws) {
    binomial_sample sample(c);
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(draws); ++i) sample.add(draw(i));
    return sample.judge();
}

} // namespace statistics
