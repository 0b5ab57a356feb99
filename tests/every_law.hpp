// tests/every_law.hpp: the laws, for tests that hold whatever a law computes.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include <mica/law/bernoulli_sum.hpp>
#include <mica/law/dual_gated.hpp>
#include <mica/law/exact.hpp>
#include <mica/law/floored_gated.hpp>
#include <mica/law/gated.hpp>
#include <mica/law/gaussian.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>

using every_law =
    testing::Types<mica::gaussian_binomial, mica::bernoulli_sum_binomial, mica::floored_gated_binomial,
                   mica::gated_binomial, mica::dual_gated_binomial, mica::basic_dual_gated_binomial<mica::naive_gate>,
                   mica::basic_dual_gated_binomial<mica::scaled_gate>, mica::quantile_binomial<1>,
                   mica::quantile_binomial<4>, mica::quantile_binomial<8>, mica::smooth_quantile_binomial<4>,
                   mica::exact_binomial>;

inline std::string law_name(mica::gaussian_binomial) { return "gaussian"; }
inline std::string law_name(mica::bernoulli_sum_binomial) { return "bernoulli_sum"; }
inline std::string law_name(mica::exact_binomial) { return "exact"; }

template <int Gates>
std::string law_name(mica::quantile_binomial<Gates>) {
    return "quantile_" + std::to_string(Gates);
}
template <int Gates>
std::string law_name(mica::smooth_quantile_binomial<Gates>) {
    return "smooth_quantile_" + std::to_string(Gates);
}

inline std::string gate_name(mica::log1p_gate) { return ""; }
inline std::string gate_name(mica::scaled_gate) { return "_scaled"; }
inline std::string gate_name(mica::naive_gate) { return "_naive"; }

template <class Gate>
std::string law_name(mica::basic_floored_gated_binomial<Gate>) {
    return "floored_gated" + gate_name(Gate{});
}
template <class Gate>
std::string law_name(mica::basic_gated_binomial<Gate>) {
    return "gated" + gate_name(Gate{});
}
template <class Gate>
std::string law_name(mica::basic_dual_gated_binomial<Gate>) {
    return "dual_gated" + gate_name(Gate{});
}

/// The names of typed tests.
struct by_law_name {
    template <class Law>
    static std::string GetName(int) {
        return law_name(Law{});
    }
};
