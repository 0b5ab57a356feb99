// tests/stated_grid.hpp: the trials and probabilities over which the quantile laws state their errors.
#pragma once

#include <algorithm>
#include <cmath>

#include "enumeration.hpp"

namespace stated_grid {

inline constexpr float trials[] = {3, 4, 5, 8, 12, 16, 32, 64, 256, 1024, 1e5F, 1e7F};

/// Calls visit(N, p) for N p from 1e-3 to 300 in steps of `factor`, on both sides of p = 1/2 and at it. Beyond, the
/// failures have that mean, as far as 1 - p has the digits.
template <class Visit>
void each(const Visit& visit, double factor = 1.25) {
    for (const float n : trials) {
        for (double mean = 1e-3; mean <= 300; mean *= factor) {
            const auto p = static_cast<float>(mean / static_cast<double>(n));
            if (p > 0.5F) break;
            visit(n, p);
            const auto mirrored = static_cast<float>(1 - static_cast<double>(p));
            if (mirrored <= 1 - 0x1p-24F) visit(n, mirrored); // not 1, also with -ffast-math
        }
        if (n <= 600) visit(n, 0.5F);
    }
}

/// The largest of each error.
struct worst_case {
    double total_variation = 0, mean = 0, variance = 0;

    void see(const worst_case& one) {
        total_variation = std::max(total_variation, one.total_variation);
        mean = std::max(mean, one.mean);
        variance = std::max(variance, one.variance);
    }
};

/// A law's distances from the binomial, those of mean and variance relative to the rarer outcome's.
template <class Law>
worst_case deviation_of(float n, float probability) {
    const auto found = enumeration::deviation_of<Law>(n, probability);
    return {found.total_variation, std::abs(found.mean - 1), std::abs(found.variance - 1)};
}

/// The worst of a law over the grid.
template <class Law>
worst_case worst_of(double factor = 1.25) {
    worst_case worst;
    each([&](float n, float p) { worst.see(deviation_of<Law>(n, p)); }, factor);
    return worst;
}

} // namespace stated_grid
