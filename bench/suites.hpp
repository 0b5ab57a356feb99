// bench/suites.hpp: what the benchmark measures, and where.
#pragma once

#include <array>
#include <memory>
#include <utility>

#include "streams.hpp"

namespace suites {

/// Fixed parameters along which the cost of a law without branches stays what it is: N from 1 to 1e12 with N p = 1/2, and
/// N p from 1e-3 to 1e5 with N = 1e6. Names begin with "trials/N/" and "mean/N p/".
inline const std::vector<std::pair<std::string, streams::binomial>>& curve_points() {
    static const auto points = [] {
        std::vector<std::pair<std::string, streams::binomial>> result;
        for (const char* const n : {"1", "1e2", "1e4", "1e6", "1e9", "1e12"})
            result.emplace_back("trials/" + std::string(n) + "/", streams::fixed(std::stof(n), 0.5F / std::stof(n)));
        for (const char* const mean : {"1e-6", "1e-3", "1e-1", "1", "1e1", "1e2", "1e3", "1e5", "5e5"})
            result.emplace_back("mean/" + std::string(mean) + "/", streams::fixed(1e6F, std::stof(mean) / 1e6F));
        return result;
    }();
    return points;
}

void register_laws();
void register_peers();
void register_grids();
void register_shade();

} // namespace suites
