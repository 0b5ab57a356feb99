// tests/hygiene/main.cpp: judges what first.cpp and second.cpp draw with whatever flags they are compiled with
// (tests/hygiene/run says which); returns 0 if all is right. Compiled without those flags. With an argument it has a
// constructor called with a bad one.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include <statistics.hpp>

#include "drawn.hpp"

namespace {

bool all_right = true;

void expect(bool right, const char* what, double found) {
    if (right) return;
    std::printf("wrong: %s: %.9g\n", what, found);
    all_right = false;
}

/// Whether counts have the binomial's distribution, mean and variance.
void expect_binomial(const std::vector<float>& successes, double trials, double probability, const char* name) {
    const statistics::binomial_cells cells(trials, probability);
    auto counts = cells.empty();
    statistics::running_moments moments;
    for (const float n : successes) {
        counts.add(static_cast<double>(n));
        moments.add(static_cast<double>(n));
    }
    const auto law = statistics::binomial_moments(trials, probability);
    const double mean = statistics::mean_p_value(moments, law);
    const double variance = statistics::variance_p_value(moments, law);
    const double fit = statistics::goodness_of_fit(cells, counts).p_value;
    std::printf("%-12s N %-8.3g p %-8.3g p-values: mean %.2g, variance %.2g, fit %.2g\n", name, trials, probability,
                mean, variance, fit);
    expect(statistics::passes(mean), name, mean);
    expect(statistics::passes(variance), name, variance);
    expect(statistics::passes(fit), name, fit);
}

void expect_law(drawn::law which, const char* name) {
    constexpr std::uint32_t draws = 50'000; // too few to tell a distance of 1e-4, as stated for quantile_4, from none
    struct parameters {
        float trials, probability;
    };
    std::uint32_t seed = 1;
    for (const auto& of : {parameters{20, 0.3F}, {1e6F, 3e-6F}, {1e5F, 0.6F}, {1e16F, 3e-16F}}) {
        const auto counts = drawn::binomials(which, of.trials, of.probability, seed++, draws);
        expect_binomial(counts.in_batch, static_cast<double>(of.trials), static_cast<double>(of.probability), name);
        for (std::size_t i = 0; i < counts.alone.size(); ++i) {
            const float apart = std::abs(counts.alone[i] - counts.in_batch[997 * i]);
            expect(apart <= 1, "batch and single draws", static_cast<double>(apart)); // 1: -ffast-math may round apart
        }
    }
    for (const float trials : {0.F, 1.F, 20.F, 1e16F})
        for (const float probability : {0.F, 0.5F, 1.F}) {
            const auto [successes, failures] = drawn::one(which, trials, probability, 7);
            expect(successes >= 0 && failures >= 0, "a count", static_cast<double>(successes));
            expect(successes + failures == trials, "the sum of the counts", static_cast<double>(successes + failures));
            if (probability == 0) expect(successes == 0, "successes at p = 0", static_cast<double>(successes));
            if (probability == 1) expect(failures == 0, "failures at p = 1", static_cast<double>(failures));
        }
}

void expect_surface() {
    std::vector<float> flashes;
    statistics::running_moments glint;
    float smooth = 0;
    for (std::uint32_t seed = 0; seed < 20'000; ++seed) {
        flashes.push_back(drawn::flashes(0.2F, seed));
        const auto here = drawn::under_the_sun(seed), there = drawn::under_the_sun_in_second_unit(seed);
        expect(std::abs(here.glint - there.glint) <= 1e-5F * here.glint, "the other translation unit",
               static_cast<double>(there.glint));
        smooth = here.smooth;
        glint.add(static_cast<double>(here.glint));
    }
    expect_binomial(flashes, static_cast<double>(drawn::facets()), static_cast<double>(0.2F), "grid");
    const double apart = (glint.mean() - static_cast<double>(smooth)) / glint.standard_error();
    std::printf("%-12s glints %.4g +- %.2g, smooth %.4g\n", "sun", glint.mean(), glint.standard_error(),
                static_cast<double>(smooth));
    expect(statistics::passes(statistics::normal_p_value(apart)), "mean of the glints", glint.mean());
}

} // namespace

int main(int arguments, char**) {
    if (arguments > 1) {
        drawn::give_a_bad_argument(); // does not come back
        return 0;
    }
    expect_law(drawn::law::exact, "exact");
    expect_law(drawn::law::quantile_4, "quantile_4");
    expect_surface();
    const auto sky = static_cast<double>(drawn::probability_under_the_sky());
    expect(std::abs(sky - 1) < 1e-4, "probabilities under a white sky", sky);
    return all_right ? 0 : 1;
}
