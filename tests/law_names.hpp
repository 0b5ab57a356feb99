// tests/law_names.hpp: what the tests and their documents call each law.
#pragma once

#include <string>

#include <mica/law/bernoulli_sum.hpp>
#include <mica/law/dual_gated.hpp>
#include <mica/law/exact.hpp>
#include <mica/law/floored_gated.hpp>
#include <mica/law/gated.hpp>
#include <mica/law/gaussian.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>

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
