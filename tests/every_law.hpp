// tests/every_law.hpp: the laws, for tests that hold whatever a law computes.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "law_names.hpp"

using every_law =
    testing::Types<mica::gaussian_binomial, mica::bernoulli_sum_binomial, mica::floored_gated_binomial,
                   mica::gated_binomial, mica::dual_gated_binomial, mica::basic_dual_gated_binomial<mica::naive_gate>,
                   mica::basic_dual_gated_binomial<mica::scaled_gate>, mica::quantile_binomial<1>,
                   mica::quantile_binomial<4>, mica::quantile_binomial<8>, mica::smooth_quantile_binomial<4>,
                   mica::exact_binomial>;

/// The names of typed tests.
struct by_law_name {
    template <class Law>
    static std::string GetName(int) {
        return law_name(Law{});
    }
};
