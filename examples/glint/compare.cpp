// The same patch by interpolated counts, by blended variates and by facets that really exist.
//
// Every row is one way to count, one footprint, one N and one p; its samples are pixels far apart, on surfaces of many
// seeds. Samples are added until the figures are known well enough, or there are --samples of them.
#include "compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <stdexcept>

#include <mica/law/exact.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>

#include "patch.hpp"
#include "render.hpp"

namespace glint {

namespace {

using number = mica::pack<float, mica::native_lanes<float>>;
constexpr std::size_t lanes = mica::lanes_of<number>;
using place = mica::uv_point<number>;

/// floor(N + xi') trials, each a success with probability p.
struct binomial_reference {
    double trials, p;

    double mean() const { return trials * p; }
    double fraction() const { return trials - std::floor(trials); }
    double variance() const { return trials * p * (1 - p) + fraction() * (1 - fraction()) * p * p; }
    double probability(double k) const {
        const double whole = std::floor(trials);
        return (1 - fraction()) * of_whole(whole, k) + (fraction() > 0 ? fraction() * of_whole(whole + 1, k) : 0);
    }

  private:
    double of_whole(double n, double k) const {
        if (k < 0 || k > n) return 0;
        return std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) + k * std::log(p) +
                        (n - k) * std::log1p(-p));
    }
};

/// Sums of many counts about their mean, and their histogram.
class count_sums {
  public:
    explicit count_sums(const binomial_reference& law) : mean_(law.mean()) {
        const double reach = 12 * std::sqrt(law.variance()) + 12;
        first_ = std::max(0., std::floor(mean_ - reach));
        histogram_.resize(static_cast<std::size_t>(mean_ + reach - first_) + 1, 0.);
    }

    void add(double count) {
        const double x = count - mean_;
        ++samples_;
        sum_ += x;
        squares_ += x * x;
        fourths_ += x * x * x * x;
        dark_ += count == 0;
        const double cell = std::clamp(std::round(count) - first_, 0., static_cast<double>(histogram_.size() - 1));
        ++histogram_[static_cast<std::size_t>(cell)];
    }

    void add(const count_sums& other) {
        samples_ += other.samples_;
        sum_ += other.sum_;
        squares_ += other.squares_;
        fourths_ += other.fourths_;
        dark_ += other.dark_;
        for (std::size_t i = 0; i < histogram_.size(); ++i) histogram_[i] += other.histogram_[i];
    }

    double samples() const { return samples_; }
    double mean() const { return mean_ + sum_ / samples_; }
    double variance() const { return squares_ / samples_ - sum_ / samples_ * (sum_ / samples_); }
    double mean_error() const { return std::sqrt(variance() / samples_); }
    double variance_error() const {
        return std::sqrt(std::max(0., fourths_ / samples_ - variance() * variance()) / samples_);
    }
    double dark() const { return dark_ / samples_; }

    /// Total variation from a law, and what it would be by chance alone if the samples had that law.
    std::pair<double, double> total_variation(const binomial_reference& law) const {
        double distance = 0, chance = 0;
        for (std::size_t i = 0; i < histogram_.size(); ++i) {
            const double p = law.probability(first_ + static_cast<double>(i));
            distance += std::abs(histogram_[i] / samples_ - p) / 2;
            chance += std::sqrt(p * (1 - p) / (2 * std::numbers::pi * samples_));
        }
        return {distance, chance};
    }

  private:
    double mean_, first_ = 0, samples_ = 0, sum_ = 0, squares_ = 0, fourths_ = 0, dark_ = 0;
    std::vector<double> histogram_;
};

struct compare_row {
    std::string mode;
    patch_footprint shape;
    double level_fraction;
    binomial_reference law;
    count_sums sums;
    double correlation_length, correlation_length_disc, jumps;
    std::size_t evaluations;
    double ns;
};

/// Where between two levels a footprint lies, to a hundredth.
double level_fraction(const patch_footprint& shape, const compare_options& options) {
    const double level = std::round(100 * (shape.level + std::log2(options.footprint_scale))) / 100;
    return level - std::floor(level);
}

/// Where the autocorrelation, given at multiples of `step`, falls to one half; the last lag if it does not.
double half_width(const std::vector<double>& products, double step) {
    for (std::size_t i = 1; i < products.size(); ++i) {
        const double before = products[i - 1] / products[0], after = products[i] / products[0];
        if (after <= 0.5) return step * (static_cast<double>(i - 1) + (before - 0.5) / (before - after));
    }
    return step * static_cast<double>(products.size() - 1);
}

constexpr double farthest_lag = 4;         // pixels
constexpr std::size_t lags = 64;           // of counts and variates
constexpr std::size_t lags_of_facets = 16; // which take longer

// --- counts and variates ----------------------------------------------------------------------------------------

/// Somewhere in the patch, a place of its own for every lane.
place random_place(mica::uniform_stream<number>& xi) {
    const number u = xi();
    return {u, xi()};
}

mica::uniform_stream<number> place_stream(std::uint32_t seed) {
    return mica::uniform_stream<number>(mica::index_of<number>(seed), mica::index_of<number>::iota(0U));
}

template <class Patch>
count_sums sampled(const Patch& patch, const binomial_reference& law, std::uint32_t first_seed, std::size_t samples) {
    count_sums sums(law);
    const number trials(static_cast<float>(law.trials)), p(static_cast<float>(law.p));
    for (std::size_t i = 0; i < samples / lanes; ++i) {
        const std::uint32_t seed = mica::hash(first_seed, static_cast<std::uint32_t>(i));
        auto xi = place_stream(seed);
        const number counts = patch(random_place(xi), trials, p, seed);
        for (int lane = 0; lane < static_cast<int>(lanes); ++lane) sums.add(static_cast<double>(counts[lane]));
    }
    return sums;
}

template <class Patch>
double correlation_length(const Patch& patch, const binomial_reference& law, std::uint32_t first_seed) {
    constexpr double lag_step = farthest_lag / lags;
    std::vector<double> products(lags + 1, 0.);
    const number trials(static_cast<float>(law.trials)), p(static_cast<float>(law.p));
    const auto step = patch.shape.template derivatives<number>();
    for (std::uint32_t i = 0; i < 1024; ++i) {
        const std::uint32_t seed = mica::hash(first_seed, 77U, i);
        auto xi = place_stream(seed);
        const place start = random_place(xi);
        number first;
        for (std::size_t lag = 0; lag <= lags; ++lag) {
            const number t(static_cast<float>(lag_step * static_cast<double>(lag)));
            const place at = i % 2 ? place{start.u + t * step.du_dx, start.v + t * step.dv_dx}
                                   : place{start.u + t * step.du_dy, start.v + t * step.dv_dy};
            const number count = patch(at, trials, p, seed);
            if (lag == 0) first = count;
            for (int lane = 0; lane < static_cast<int>(lanes); ++lane)
                products[lag] +=
                    (static_cast<double>(first[lane]) - law.mean()) * (static_cast<double>(count[lane]) - law.mean());
        }
    }
    return half_width(products, lag_step);
}

/// Largest change of the smooth law's count between neighbours of fine walks, in 4096 steps each: over four pixels, half a
/// level, and two orientations of the grids.
template <class Interpolation>
double largest_jump(const patch_footprint& shape, const binomial_reference& law, float scale, std::uint32_t seed) {
    const auto count = [&](const patch_footprint& footprint, mica::uv_point<float> at) {
        const distributed_patch<mica::smooth_quantile_binomial<4>, Interpolation> patch{footprint, scale, {}};
        return static_cast<double>(patch(at, static_cast<float>(law.trials), static_cast<float>(law.p), seed));
    };
    constexpr int steps = 4096;
    const auto m = shape.derivatives<float>();
    const mica::uv_point<float> home{0.3F, 0.4F};
    double largest = 0;
    std::array<double, 3> before{};
    for (int i = 0; i <= steps; ++i) {
        const double t = static_cast<double>(i) / steps;
        const float pixels = static_cast<float>(4 * t);
        const std::array<double, 3> after{count(shape, {home.u + pixels * m.du_dx, home.v + pixels * m.dv_dx}),
                                          count({shape.ratio, shape.turn, shape.level + t / 2}, home),
                                          count({shape.ratio, shape.turn + t / (2 * shape.ratio), shape.level}, home)};
        for (std::size_t k = 0; k < 3 && i > 0; ++k) largest = std::max(largest, std::abs(after[k] - before[k]));
        before = after;
    }
    return largest;
}

template <class Law, class Interpolation>
compare_row distributed_row(const std::string& mode, const patch_footprint& shape, const binomial_reference& law,
                            const compare_options& options, std::uint32_t seed) {
    const auto scale = static_cast<float>(options.footprint_scale);
    const distributed_patch<Law, Interpolation> patch{shape, scale, {}};
    constexpr std::size_t block = 8192, blocks = 32;
    count_sums sums(law);
    const auto known = [&] {
        return sums.samples() > 0 && sums.mean_error() <= options.precision * law.mean() &&
               sums.variance_error() <= 4 * options.precision * law.variance() &&
               sums.total_variation(law).second <= 2 * options.precision;
    };
    for (std::uint32_t round = 0; sums.samples() < options.most_samples && !known(); ++round) {
        std::vector<count_sums> parts(blocks, count_sums(law));
        tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t i) {
            parts[i] = sampled(patch, law, mica::hash(seed, round, static_cast<std::uint32_t>(i)), block);
        });
        for (const auto& part : parts) sums.add(part);
    }
    std::array<double, 5> seconds;
    for (std::size_t i = 0; i < seconds.size(); ++i) {
        const stopwatch watch;
        sums.add(sampled(patch, law, mica::hash(seed, 0xffffU, static_cast<std::uint32_t>(i)), block));
        seconds[i] = watch.seconds();
    }
    std::sort(seconds.begin(), seconds.end());
    return {mode,
            shape,
            level_fraction(shape, options),
            law,
            sums,
            correlation_length(patch, law, seed),
            std::numeric_limits<double>::quiet_NaN(),
            largest_jump<Interpolation>(shape, law, scale, seed),
            patch.evaluations,
            seconds[2] * 1e9 / block};
}

// --- facets -----------------------------------------------------------------------------------------------------

compare_row facets_row(const std::string& mode, const patch_footprint& shape, const binomial_reference& law,
                       const compare_options& options, std::uint32_t seed) {
    using namespace mica::reference;
    const auto positions = mode == "facets" ? facet_positions::jittered : facet_positions::uniform;
    const std::size_t per_side = law.trials > 500 ? 1000 : 400;
    const auto flashes = flash::with_probability(law.p);
    // The shape at the size that holds N facets.
    const double density = static_cast<double>(per_side * per_side);
    const patch_footprint sized{shape.ratio, shape.turn, std::log2(law.trials / density / shape.ratio) / 2};
    const auto m = sized.derivatives<float>();
    const auto seen_at = [&](double u, double v, double radius) {
        return ellipse{u,
                       v,
                       static_cast<double>(m.du_dx),
                       static_cast<double>(m.dv_dx),
                       static_cast<double>(m.du_dy),
                       static_cast<double>(m.dv_dy),
                       radius};
    };
    const double pixel_radius = 1 / std::sqrt(std::numbers::pi);
    constexpr double lag_step = farthest_lag / lags_of_facets;

    // So many footprints of one set that they hardly share facets; so many that it takes a second or so.
    const auto per_set = static_cast<std::size_t>(std::clamp(density / law.trials / 2, 32., 16384.));
    const double wanted = std::min(options.most_samples, std::max(4096., 3e7 / law.trials));
    const double most_sets = per_side > 400 ? 8 : 32; // making a large set takes most of the time
    const auto sets = static_cast<std::size_t>(std::clamp(wanted / static_cast<double>(per_set), 2., most_sets));
    struct part {
        count_sums sums;
        std::vector<double> sigma, disc;
        double seconds;
    };
    std::vector<part> parts(sets, {count_sums(law), std::vector<double>(lags_of_facets + 1, 0.),
                                   std::vector<double>(lags_of_facets + 1, 0.), 0});
    tbb::parallel_for(std::size_t{0}, sets, [&](std::size_t i) {
        const facet_set set(per_side, positions, mica::hash(seed, static_cast<std::uint32_t>(i)));
        std::mt19937 random(mica::hash(seed, static_cast<std::uint32_t>(i), 1U));
        std::uniform_real_distribution<double> unit(0, 1);
        const auto lit = [&](double u, double v, double radius) {
            return static_cast<double>(set.count(seen_at(u, v, radius), flashes).flashes);
        };
        const stopwatch watch;
        for (std::size_t k = 0; k < per_set; ++k) {
            const double u = unit(random), v = unit(random);
            parts[i].sums.add(lit(u, v, pixel_radius));
        }
        parts[i].seconds = watch.seconds();
        const auto walks = static_cast<std::size_t>(std::clamp(4e4 / law.trials, 4., 256.));
        for (std::size_t k = 0; k < walks; ++k) {
            const double u = unit(random), v = unit(random);
            const auto products = [&](std::vector<double>& sum, double radius) {
                const double mean = law.mean() * std::numbers::pi * radius * radius;
                double first = 0;
                for (std::size_t lag = 0; lag <= lags_of_facets; ++lag) {
                    const double t = lag_step * static_cast<double>(lag);
                    const double x =
                        lit(u + t * static_cast<double>(m.du_dy), v + t * static_cast<double>(m.dv_dy), radius) - mean;
                    if (lag == 0) first = x;
                    sum[lag] += first * x;
                }
            };
            products(parts[i].sigma, 1);
            products(parts[i].disc, pixel_radius);
        }
    });
    compare_row row{mode, shape, level_fraction(shape, options),           law, count_sums(law),
                    0,    0,     std::numeric_limits<double>::quiet_NaN(), 0,   0};
    std::vector<double> sigma(lags_of_facets + 1, 0.), disc(lags_of_facets + 1, 0.);
    for (const auto& one : parts) {
        row.sums.add(one.sums);
        row.ns += one.seconds * 1e9;
        for (std::size_t lag = 0; lag < sigma.size(); ++lag) {
            sigma[lag] += one.sigma[lag];
            disc[lag] += one.disc[lag];
        }
    }
    row.ns /= row.sums.samples();
    row.correlation_length = half_width(sigma, lag_step);
    row.correlation_length_disc = half_width(disc, lag_step);
    return row;
}

// --- rows -------------------------------------------------------------------------------------------------------

std::string json_number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, std::isfinite(x) ? "%.6g" : "null", x);
    return text;
}

void print_json(const compare_row& row, const char* separator) {
    const auto [tv, chance] = row.sums.total_variation(row.law);
    std::printf(
        "%s  {\"mode\": \"%s\", \"footprint_ratio\": %g, \"footprint_turn\": %g, \"level_fraction\": %g, \"trials\": "
        "%g, "
        "\"probability\": %g, \"samples\": %.0f, \"mean_ratio\": %.6f, \"mean_error\": %.6f, \"variance_ratio\": %.6f, "
        "\"variance_error\": %.6f, \"p0\": %.6f, \"p0_exact\": %.6f, \"tv\": %.6f, \"tv_by_chance\": %.6f, "
        "\"correlation_length\": %s, \"correlation_length_disc\": %s, \"jumps\": %s, \"evaluations_per_pixel\": %zu, "
        "\"ns_per_pixel\": %.1f}",
        separator, row.mode.c_str(), row.shape.ratio, row.shape.turn, row.level_fraction, row.law.trials, row.law.p,
        row.sums.samples(), row.sums.mean() / row.law.mean(), row.sums.mean_error() / row.law.mean(),
        row.sums.variance() / row.law.variance(), row.sums.variance_error() / row.law.variance(), row.sums.dark(),
        row.law.probability(0), tv, chance, json_number(row.correlation_length).c_str(),
        json_number(row.correlation_length_disc).c_str(), json_number(row.jumps).c_str(), row.evaluations, row.ns);
}

void print_table(const std::vector<compare_row>& rows) {
    std::printf(
        "mode            ratio  turn  level       N      p     mean  variance      P(0)     exact      TV   chance  "
        "half-width  evals  ns/pixel\n");
    for (const auto& row : rows) {
        const auto [tv, chance] = row.sums.total_variation(row.law);
        std::printf("%-14s  %5g  %4g  %5.2g  %6g  %5g  %7.4f  %8.4f  %8.4f  %8.4f  %6.4f  %7.4f  %10.2f  %5zu  %8.0f\n",
                    row.mode.c_str(), row.shape.ratio, row.shape.turn, row.level_fraction, row.law.trials, row.law.p,
                    row.sums.mean() / row.law.mean(), row.sums.variance() / row.law.variance(), row.sums.dark(),
                    row.law.probability(0), tv, chance, row.correlation_length, row.evaluations, row.ns);
    }
}

// --- the picture ------------------------------------------------------------------------------------------------

constexpr std::size_t panel = 192, gap = 8, header = 24, enlarged = 2;

/// Grey by count / mean, so that the modes compare.
template <class Count>
void draw_panel(srgb_picture& picture, std::size_t left, std::size_t top, double mean, const Count& count) {
    draw_patch(picture, left, top, panel, enlarged, 0.4F,
               [&](double x, double y) { return static_cast<float>(count(x, y) / mean); });
}

template <class Law>
void draw_picture(const compare_options& options, const png_file& output) {
    const binomial_reference law{50, 0.02};
    const auto scale = static_cast<float>(options.footprint_scale);
    srgb_picture picture(3 * (panel * enlarged + gap) + gap, 2 * (panel * enlarged + gap) + header, 0);
    const char* const titles[] = {"interpolated counts", "blended variates", "explicit facets"};
    for (std::size_t column = 0; column < 3; ++column)
        draw_text(picture, titles[column], gap + column * (panel * enlarged + gap), 5, 2, 220);
    std::size_t top = header;
    for (const patch_footprint shape : {patch_footprint{1, 0, -9.6}, patch_footprint{16, 0.2, -11.6}}) {
        const auto m = shape.derivatives<float>();
        const auto uv = [&](double x, double y) {
            return mica::uv_point<float>{static_cast<float>(x) * m.du_dx + static_cast<float>(y) * m.du_dy,
                                         static_cast<float>(x) * m.dv_dx + static_cast<float>(y) * m.dv_dy};
        };
        const auto distributed = [&](auto interpolation, std::size_t column) {
            const distributed_patch<Law, decltype(interpolation)> patch{shape, scale, interpolation};
            draw_panel(picture, gap + column * (panel * enlarged + gap), top, law.mean(), [&](double x, double y) {
                return static_cast<double>(
                    patch(uv(x, y), static_cast<float>(law.trials), static_cast<float>(law.p), options.seed));
            });
        };
        distributed(mica::interpolated_counts{}, 0);
        distributed(mica::blended_variates{}, 1);
        // In pixels: facets lie in the stretched pixel as they lie in the surface.
        const double density = law.trials / shape.area();
        const auto per_side = static_cast<std::size_t>(std::sqrt(density));
        const mica::reference::facet_set facets(std::min<std::size_t>(per_side, 8192),
                                                mica::reference::facet_positions::jittered, options.seed);
        const double wider = std::sqrt(density / facets.density()); // where the whole would be too many facets
        draw_panel(picture, gap + 2 * (panel * enlarged + gap), top, law.mean(), [&](double x, double y) {
            const auto at = uv(x, y);
            return static_cast<double>(
                facets
                    .count({wider * static_cast<double>(at.u), wider * static_cast<double>(at.v),
                            wider * static_cast<double>(m.du_dx), wider * static_cast<double>(m.dv_dx),
                            wider * static_cast<double>(m.du_dy), wider * static_cast<double>(m.dv_dy)},
                           mica::reference::flash::with_probability(law.p))
                    .flashes);
        });
        top += panel * enlarged + gap;
    }
    output.save(picture);
}

void require_all(const std::vector<double>& values, const char* option, double low, double high) {
    for (const double x : values)
        if (!(x >= low && x <= high))
            throw std::invalid_argument(std::string(option) + " " + std::to_string(x) + " is not in [" +
                                        json_number(low) + ", " + json_number(high) + "]");
}

} // namespace

void compare(const compare_options& options) {
    require_all(options.ratios, "--ratio", 1, 1024);
    require_all(options.trials, "--trials", 0.01, 1e5);
    require_all(options.probabilities, "--probability", 1e-4, 0.999);
    require_all({options.precision}, "--precision", 1e-6, 1);
    require_all({options.most_samples}, "--samples", 1, 1e10);
    require_all({options.footprint_scale}, "--scale", 0.1, 16);
    for (const auto& mode : options.modes)
        if (mode != "counts" && mode != "variates" && mode != "facets" && mode != "facets_uniform")
            throw std::invalid_argument("unknown mode '" + mode +
                                        "' (known: counts, variates, facets, facets_uniform)");
    if (options.law != "quantile" && options.law != "quantile:8" && options.law != "exact")
        throw std::invalid_argument("unknown law '" + options.law + "' (known: quantile, quantile:8, exact)");
    const png_file output(options.output);

    // On a level, and turned and between two.
    std::vector<patch_footprint> shapes;
    for (const double ratio : options.ratios)
        for (const auto& [turn, level] : {std::pair{0., 0.}, {0.37, 0.5}})
            shapes.push_back({ratio, turn, -10 + level - std::log2(options.footprint_scale)});

    std::vector<compare_row> rows;
    progress reporter("compare",
                      shapes.size() * options.trials.size() * options.probabilities.size() * options.modes.size());
    const auto with_compared_law = [&](const auto& body) {
        if (options.law == "exact") return body(mica::exact_binomial{});
        if (options.law == "quantile:8") return body(mica::quantile_binomial<8>{});
        return body(mica::quantile_binomial<4>{});
    };
    with_compared_law([&](auto law) {
        using Law = decltype(law);
        draw_picture<Law>(options, output);
        for (const auto& mode : options.modes)
            for (const auto& shape : shapes)
                for (const double trials : options.trials)
                    for (const double p : options.probabilities) {
                        const binomial_reference reference{trials, p};
                        const std::uint32_t seed = mica::hash(options.seed, static_cast<std::uint32_t>(rows.size()));
                        rows.push_back(
                            mode == "counts"
                                ? distributed_row<Law, mica::interpolated_counts>(mode, shape, reference, options, seed)
                            : mode == "variates"
                                ? distributed_row<Law, mica::blended_variates>(mode, shape, reference, options, seed)
                                : facets_row(mode, shape, reference, options, seed));
                        reporter.advance();
                    }
    });
    if (options.json) {
        std::printf("{\"rows\": [");
        const char* separator = "\n";
        for (const auto& row : rows) {
            print_json(row, separator);
            separator = ",\n";
        }
        std::printf("\n]}\n");
    } else {
        print_table(rows);
    }
}

} // namespace glint
