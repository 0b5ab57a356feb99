// tests/statistics.cpp: what takes Boost.Math, which is slow to compile: once for all tests.
#include "statistics.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

#include <unistd.h>

// g++ 12 cannot see that Boost assigns its error results wherever it reads them.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

namespace statistics {

bool passes(double p_value) {
    static std::FILE* const notes = [] {
        const char* const folder = std::getenv("MICA_P_VALUES");
        return folder ? std::fopen((folder + ("/" + std::to_string(getpid()))).c_str(), "a") : nullptr;
    }();
    if (notes) {
        std::fprintf(notes, "%.17g\n", p_value);
        std::fflush(notes);
    }
    return p_value >= significance();
}

double normal_cdf(double z) { return cdf(boost::math::normal(), z); }

double normal_quantile(double probability) { return quantile(boost::math::normal(), probability); }

long double normal_quantile(long double probability) {
    return quantile(boost::math::normal_distribution<long double>(), probability);
}

double normal_p_value(double z) {
    if (!std::isfinite(z)) return 0;
    return 2 * cdf(complement(boost::math::normal(), std::abs(z)));
}

law_moments binomial_moments(double trials, double p) {
    struct central {
        double mean, second, third, fourth;
    };
    const auto of_integer = [p](double n) {
        const double pq = p * (1 - p), v = n * pq;
        return central{n * p, v, v * (1 - 2 * p), v * (1 + 3 * (n - 2) * pq)};
    };
    const double part = trials - std::floor(trials);
    law_moments result{trials * p, 0, 0};
    for (const auto& [weight, of] :
         {std::pair{1 - part, of_integer(std::floor(trials))}, std::pair{part, of_integer(std::floor(trials) + 1)}}) {
        const double d = of.mean - result.mean;
        result.variance += weight * (of.second + d * d);
        result.fourth += weight * (of.fourth + 4 * d * of.third + 6 * d * d * of.second + d * d * d * d);
    }
    return result;
}

double variance_p_value(const running_moments& sample, const law_moments& law) {
    const double spread = law.fourth - law.variance * law.variance;
    // A fair coin: every draw is as far from the mean as every other, and the sample's mean says it all.
    if (spread <= 1e-6 * law.variance * law.variance) return 1;
    return normal_p_value((sample.variance() - law.variance) / std::sqrt(spread / sample.count()));
}

double kolmogorov_p_value(double largest_difference, double draws) {
    const double t = largest_difference * std::sqrt(draws);
    if (!std::isfinite(t)) return 0;
    if (t < 0.3) return 1; // 1 - 1e-5 there
    double sum = 0;
    for (int j = 1; j <= 20; ++j) sum += (j % 2 ? 2 : -2) * std::exp(-2 * j * j * t * t);
    return std::clamp(sum, 0., 1.);
}

double binomial_p_value(double observed, double draws, double probability) {
    if (!(probability > 0)) return observed > 0 ? 0 : 1;
    if (!(probability < 1)) return observed < draws ? 0 : 1;
    const boost::math::binomial law(draws, probability);
    const double at_most = cdf(law, observed);
    const double at_least = observed > 0 ? cdf(complement(law, observed - 1)) : 1;
    return (std::min)(1., 2 * (std::min)(at_most, at_least));
}

std::vector<pool> pooled(std::span<const double> probabilities, double draws, double least) {
    const std::size_t size = probabilities.size();
    std::size_t lower = 0;
    for (double expected = 0; lower < size && expected < least;) expected += draws * probabilities[lower++];
    std::size_t upper = size;
    for (double expected = 0; upper > lower && expected < least;) expected += draws * probabilities[--upper];

    std::vector<pool> pools{{0, lower}};
    std::size_t first = lower;
    double expected = 0;
    for (std::size_t i = lower; i < upper; ++i) {
        expected += draws * probabilities[i];
        if (expected < least) continue;
        pools.push_back({first, i + 1});
        first = i + 1;
        expected = 0;
    }
    pools.back().last = upper; // what is left of the inner cells joins the last pool
    if (upper < size) pools.push_back({upper, size});
    return pools;
}

double chi_square_p_value(double chi_square, int degrees) {
    return degrees < 1 ? 1 : cdf(complement(boost::math::chi_squared(degrees), chi_square));
}

fit goodness_of_fit(std::span<const double> probabilities, std::span<const double> observed) {
    const pool everything{0, probabilities.size()};
    const double draws = sum(observed, everything);
    const bool normalised = std::abs(sum(probabilities, everything) - 1) <= 1e-8;
    if (!normalised || !(draws > 0) || observed.size() != probabilities.size()) return {0, 0, 0, 0};
    for (std::size_t i = 0; i < observed.size(); ++i)
        if (observed[i] > 0 && !(probabilities[i] > 0)) return {0, 0, 0, i};

    const auto pools = pooled(probabilities, draws, least_expected);
    fit result{1, 0, static_cast<int>(pools.size()) - 1, 0};
    double worst = 0;
    for (const pool range : pools) {
        const double expected = draws * sum(probabilities, range);
        const double from_expected = sum(observed, range) - expected;
        const double term = from_expected * from_expected / expected;
        result.chi_square += term;
        if (term > worst) result.worst_cell = range.first;
        worst = (std::max)(worst, term);
    }

    std::size_t lowest = 0;
    while (!(observed[lowest] > 0)) ++lowest;
    std::size_t highest = observed.size();
    while (!(observed[highest - 1] > 0)) --highest;
    const auto tail = [&](pool range) {
        return binomial_p_value(sum(observed, range), draws, (std::min)(1., sum(probabilities, range)));
    };
    const auto reached = [&](pool range) {
        return sidak_smallest((std::min)(1., sum(probabilities, range)), static_cast<int>(draws));
    };
    double difference = 0, largest_difference = 0;
    for (std::size_t i = 0; i < observed.size(); ++i) {
        difference += observed[i] / draws - probabilities[i];
        largest_difference = (std::max)(largest_difference, std::abs(difference));
    }
    const double smallest =
        (std::min)({chi_square_p_value(result.chi_square, result.degrees), tail(pools.front()), tail(pools.back()),
                    tail({0, 1}), tail({observed.size() - 1, observed.size()}), reached({0, lowest + 1}),
                    reached({highest - 1, observed.size()}), kolmogorov_p_value(largest_difference, draws)});
    result.p_value = sidak_smallest(smallest, lenses);
    return result;
}

double chance_of_missing(std::span<const double> stated, std::span<const double> actual, double draws,
                         double significance) {
    const auto pools = pooled(stated, draws, least_expected);
    const int degrees = static_cast<int>(pools.size()) - 1;
    if (degrees < 1) return 1;
    double noncentrality = 0;
    for (const pool range : pools) {
        const double difference = sum(actual, range) - sum(stated, range);
        noncentrality += draws * difference * difference / sum(stated, range);
    }
    if (!(noncentrality > 0)) return 1;
    const double critical = quantile(complement(boost::math::chi_squared(degrees), sidak_share(significance, lenses)));
    return cdf(boost::math::non_central_chi_squared(degrees, noncentrality), critical);
}

double binomial_probability(double trials, double probability, double k) {
    return k < 0 || k > trials ? 0 : pdf(boost::math::binomial(trials, probability), k);
}

double binomial_cdf(double trials, double probability, double k) {
    if (k < 0) return 0;
    return k >= trials ? 1 : cdf(boost::math::binomial(trials, probability), k);
}

double binomial_survival(double trials, double probability, double k) {
    if (k < 0) return 1;
    return k >= trials ? 0 : cdf(complement(boost::math::binomial(trials, probability), k));
}

double binomial_interval(double trials, double probability, double low, double high) {
    if (low <= 0 && high > trials) return 1;
    if (low < trials * probability)
        return binomial_cdf(trials, probability, high - 1) - binomial_cdf(trials, probability, low - 1);
    return binomial_survival(trials, probability, low - 1) - binomial_survival(trials, probability, high - 1);
}

} // namespace statistics
