// tests/accuracy.cpp: how far each law is from the binomial, computed without drawing a sample.
//
//     accuracy tables           the tables of docs/accuracy.md, as Markdown
//     accuracy figures FOLDER   the numbers behind its pictures, as text files that tools/draw_accuracy reads
//     accuracy worst            a line for each law: name, largest TV, errors of mean and variance over the stated grid
//
// tools/accuracy runs the first two, tools/ladder the third.
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "enumeration.hpp"
#include "law_names.hpp"
#include "stated_grid.hpp"

namespace {

using enumeration::deviation;

struct place {
    float trials, probability;
};

/// From few trials to many, few successes to many, both sides of 1/2, integer trials and real ones.
constexpr place places[] = {{4, 0.25F},    {16, 0.0625F}, {64, 0.015625F}, {1000, 1e-4F},  {1000, 1e-3F}, {1000, 3e-3F},
                            {1000, 0.01F}, {1000, 0.05F}, {1000, 0.5F},    {1000, 0.997F}, {1e5F, 3e-5F}, {1e7F, 1e-7F},
                            {1e7F, 1e-5F}, {0.5F, 0.3F},  {1.5F, 0.5F},    {7.3F, 0.3F}};

bool is_integer(float trials) { return trials == std::floor(trials); }

/// Of a tail: 0 if the law cannot reach it, a dash if the binomial has no count in it.
std::string ratio(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return std::isnan(value) ? "-" : text;
}

template <class Law>
void print_law(Law) {
    std::printf("\n### %s\n\n", law_name(Law{}).c_str());
    std::printf("| N | p | TV | KS | mean / N p | variance / N p q | P(0) | binomial P(0) | tail at 1e-3 | at 1e-6 |\n"
                "|---|---|---|---|---|---|---|---|---|---|\n");
    for (const auto& [n, p] : places) {
        if (std::is_same_v<Law, mica::exact_binomial> && !is_integer(n)) continue;
        const deviation d = enumeration::deviation_of<Law>(n, p);
        std::printf("| %.6g | %.6g | %.2g | %.2g | %.5f | %.5f | %.5f | %.5f | %s | %s |\n", static_cast<double>(n),
                    static_cast<double>(p), d.total_variation, d.kolmogorov, d.mean, d.variance, d.none,
                    d.binomial_none, ratio(d.tail_3).c_str(), ratio(d.tail_6).c_str());
    }
}

template <class Law>
void print_worst_case(Law) {
    const auto worst = stated_grid::worst_of<Law>();
    std::printf("| %s | %.2g | %.2g | %.2g |\n", law_name(Law{}).c_str(), worst.total_variation, worst.mean,
                worst.variance);
}

/// Every law on the ladder. The exact law takes seconds a place, so it is judged at a few.
void worst() {
    const auto print = [](auto law, double factor = 1.25) {
        const auto worst = stated_grid::worst_of<decltype(law)>(factor);
        std::printf("%s %.3g %.3g %.3g\n", law_name(law).c_str(), worst.total_variation, worst.mean, worst.variance);
        std::fflush(stdout);
    };
    print(mica::gaussian_binomial{});
    print(mica::bernoulli_sum_binomial{});
    print(mica::floored_gated_binomial{});
    print(mica::gated_binomial{});
    print(mica::dual_gated_binomial{});
    print(mica::quantile_binomial<1>{});
    print(mica::quantile_binomial<2>{});
    print(mica::quantile_binomial<4>{});
    print(mica::quantile_binomial<8>{});
    print(mica::quantile_binomial<16>{});
    print(mica::smooth_quantile_binomial<4>{});
    print(mica::exact_binomial{}, 30);
}

double exact_gate(float n, float p) { return std::exp(static_cast<double>(n) * std::log1p(-static_cast<double>(p))); }
double exact_any(float n, float p) { return -std::expm1(static_cast<double>(n) * std::log1p(-static_cast<double>(p))); }

/// Calls visit(N, p) over [1, 1e16] x [1e-16, 1], `steps` to a side.
template <class Visit>
void each_gate_place(int steps, const Visit& visit) {
    for (int i = 0; i <= steps; ++i)
        for (int j = 0; j <= steps; ++j)
            visit(static_cast<float>(std::pow(10., 16. * i / steps)),
                  static_cast<float>(std::pow(10., 16. * j / steps - 16)));
}

template <class Gate>
void print_gate(const char* name) {
    struct {
        double error, n, p;
    } none{0, 0, 0}, any{0, 0, 0};
    each_gate_place(800, [&](float n, float p) {
        const double of_none = std::abs(static_cast<double>(Gate::none(n, p)) - exact_gate(n, p));
        const double of_any = std::abs(static_cast<double>(Gate::any(n, p)) / exact_any(n, p) - 1);
        if (of_none > none.error) none = {of_none, static_cast<double>(n), static_cast<double>(p)};
        if (of_any > any.error) any = {of_any, static_cast<double>(n), static_cast<double>(p)};
    });
    std::printf("| %s | %.2g | N = %.3g, p = %.3g | %.2g | N = %.3g, p = %.3g |\n", name, none.error, none.n, none.p,
                any.error, any.n, any.p);
}

/// Calls visit(law) with every law that the document shows.
template <class Visit>
void each_law(const Visit& visit) {
    visit(mica::gaussian_binomial{});
    visit(mica::bernoulli_sum_binomial{});
    visit(mica::floored_gated_binomial{});
    visit(mica::gated_binomial{});
    visit(mica::dual_gated_binomial{});
    visit(mica::quantile_binomial<2>{});
    visit(mica::quantile_binomial<4>{});
    visit(mica::quantile_binomial<8>{});
    visit(mica::smooth_quantile_binomial<4>{});
}

void tables() {
    std::printf("## Worst cases\n\n| law | TV | relative mean error | relative variance error |\n|---|---|---|---|\n");
    each_law([](auto law) { print_worst_case(law); });
    std::printf("\n## The gate\n\n| gate | largest error of none | where | largest relative error of any | where |\n"
                "|---|---|---|---|---|\n");
    print_gate<mica::naive_gate>("naive");
    print_gate<mica::scaled_gate>("scaled");
    print_gate<mica::log1p_gate>("log1p");
    std::printf("\n## Law by law\n");
    each_law([](auto law) { print_law(law); });
    print_law(mica::exact_binomial{});
}

std::ofstream opened(const std::string& folder, const std::string& name) {
    std::ofstream out(folder + "/" + name);
    if (!out) throw std::runtime_error("cannot write " + folder + "/" + name);
    out.precision(6);
    return out;
}

/// Total variation and relative mean error over N = 1 .. 1e8, p = 1e-8 .. 1, six to a decade.
template <class Law>
void write_map(const std::string& folder, Law law) {
    auto out = opened(folder, "map_" + law_name(law) + ".txt");
    constexpr int decades = 8, per_decade = 6;
    for (int i = 0; i <= decades * per_decade; ++i)
        for (int j = 0; j <= decades * per_decade; ++j) {
            const auto n = static_cast<float>(std::floor(std::pow(10., static_cast<double>(i) / per_decade) + 1e-6));
            const auto p = static_cast<float>(std::pow(10., static_cast<double>(j) / per_decade - decades));
            const deviation d = p < 1 ? enumeration::deviation_of<Law>(n, p) : deviation{0, 0, 1, 1, 0, 0, 1, 1};
            out << static_cast<double>(i) / per_decade << ' ' << static_cast<double>(j) / per_decade - decades << ' '
                << d.total_variation << ' ' << std::abs(d.mean - 1) << '\n';
        }
}

void write_gates(const std::string& folder) {
    auto out = opened(folder, "gates.txt");
    each_gate_place(256, [&](float n, float p) {
        const double truth = exact_gate(n, p);
        out << std::log10(n) << ' ' << std::log10(p) << ' ' << truth << ' '
            << std::abs(static_cast<double>(mica::naive_gate::none(n, p)) - truth) << ' '
            << std::abs(static_cast<double>(mica::scaled_gate::none(n, p)) - truth) << ' '
            << std::abs(static_cast<double>(mica::log1p_gate::none(n, p)) - truth) << '\n';
    });
}

/// Masses of a law's rounded successes 0, 1, 2, ..., for integer n.
template <class Law>
std::vector<double> masses(float n, float p) {
    const auto table = enumeration::enumerate<Law>::of(n, p); // of the rarer outcome
    std::vector<double> result(static_cast<std::size_t>(table.first()), 0.);
    result.insert(result.end(), table.mass().begin(), table.mass().end());
    if (p > 0.5F) {
        result.resize(static_cast<std::size_t>(n) + 1);
        std::reverse(result.begin(), result.end());
    }
    return result;
}

std::vector<double> binomial_masses(double n, double p) {
    std::vector<double> result;
    for (double k = 0; k <= n; ++k) result.push_back(statistics::binomial_probability(n, p, k));
    return result;
}

/// The sum of two independent counts.
std::vector<double> convolved(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> result(a.size() + b.size() - 1, 0.);
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
    return result;
}

void write_masses(const std::string& folder, const std::string& name, const std::vector<std::vector<double>>& columns,
                  std::size_t counts) {
    auto out = opened(folder, name);
    for (std::size_t k = 0; k < counts; ++k) {
        out << k;
        for (const auto& column : columns) out << ' ' << (k < column.size() ? column[k] : 0);
        out << '\n';
    }
}

/// Binomial, single gated, dual gated, quantile, at N from low to high: KK25 Fig. 12.
void write_histograms(const std::string& folder) {
    for (const auto& [n, p] : {place{4, 0.3F}, {12, 0.3F}, {60, 0.3F}, {1000, 0.003F}, {12, 0.9F}, {60, 0.97F}})
        write_masses(folder, "histogram_" + std::to_string(static_cast<int>(n)) + "_" + std::to_string(p) + ".txt",
                     {binomial_masses(static_cast<double>(n), static_cast<double>(p)),
                      masses<mica::gated_binomial>(n, p), masses<mica::dual_gated_binomial>(n, p),
                      masses<mica::quantile_binomial<4>>(n, p)},
                     static_cast<std::size_t>(std::min(n + 1, 100.F)));
}

/// DB23 Fig. 9: the gated Gaussian with integer counts, by itself and as the sum over two levels of detail that share
/// the trials 3 to 1 (DB23 Eq. 10), beside the binomial.
void write_gated(const std::string& folder) {
    using law = mica::floored_gated_binomial;
    for (const auto& [n, p] : {place{16, 0.1F}, {100, 0.1F}, {400, 0.1F}})
        write_masses(folder, "gated_" + std::to_string(static_cast<int>(n)) + ".txt",
                     {binomial_masses(static_cast<double>(n), static_cast<double>(p)), masses<law>(n, p),
                      convolved(masses<law>(n * 0.75F, p), masses<law>(n * 0.25F, p)),
                      convolved(masses<mica::quantile_binomial<4>>(n * 0.75F, p),
                                masses<mica::quantile_binomial<4>>(n * 0.25F, p))},
                     static_cast<std::size_t>(n * p * 3 + 8));
}

void figures(const std::string& folder) {
    each_law([&](auto law) { write_map(folder, law); });
    write_gates(folder);
    write_histograms(folder);
    write_gated(folder);
}

} // namespace

int main(int argc, char** argv) {
    const std::string what = argc > 1 ? argv[1] : "";
    try {
        if (what == "tables" && argc == 2) return tables(), 0;
        if (what == "worst" && argc == 2) return worst(), 0;
        if (what == "figures" && argc == 3) return figures(argv[2]), 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "accuracy: %s\n", error.what());
        return 2;
    }
    std::fprintf(stderr, "accuracy: say 'tables', 'figures FOLDER' or 'worst'\n");
    return 2;
}
