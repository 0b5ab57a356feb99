// The white furnace: under a constant environment the mean over realisations of glint / smooth is 1.
//
// A sphere is rendered with many seeds. The mean over all pixels is taken per seed; the seeds are independent, so
// their spread gives the standard error, which neighbouring pixels, sharing glints, would not. Seeds are added until
// the standard error is small enough, also over the grazing pixels (n.wo < 0.25), which are counted by themselves.
// Every setting has seeds of its own.
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "render.hpp"

namespace glint {

namespace {

struct running_mean {
    double sum = 0, sum_of_squares = 0;
    std::size_t count = 0;

    void add(double x) {
        sum += x;
        sum_of_squares += x * x;
        ++count;
    }
    double mean() const { return sum / static_cast<double>(count); }
    double standard_error() const {
        const auto n = static_cast<double>(count);
        return std::sqrt(std::max(0., sum_of_squares / n - mean() * mean()) / (n - 1));
    }
};

struct furnace_row {
    std::size_t levels;
    double facets_per_pixel, log_density, roughness;
    const char* pixels;
    double ratio, standard_error, wanted_error;
    std::size_t realisations;

    /// The demand: within max(0.005, 4 standard errors) of 1, and known that well.
    bool passes() const {
        return standard_error <= wanted_error && std::abs(ratio - 1) <= std::max(0.005, 4 * standard_error);
    }
};

constexpr std::size_t size = 48;
constexpr float grazing_below = 0.25F;

template <class Law, std::size_t K>
std::array<furnace_row, 2> furnace_rows(double facets, double roughness, double precision,
                                        const mica::microfacet_table& table, std::uint32_t first_seed) {
    const auto map = white_environment();
    const auto alpha = static_cast<float>(roughness);
    const mica::prefiltered_environment<K> environment(map, mica::environment_levels<K>(map), {&alpha, 1});
    const scene seen(shape::sphere, size, size);
    std::vector<mica::shading_point<float>> points;
    double area = 0;
    for (std::size_t i = 0; i < size * size; ++i)
        if (const auto point = seen.surface(i % size, i / size)) {
            points.push_back(*point);
            area += static_cast<double>(mica::make_footprint(point->derivatives).area);
        }
    mica::glint_material material;
    material.roughness = alpha;
    const double log_density = std::log(facets * static_cast<double>(points.size()) / area);
    material.log_density = static_cast<float>(log_density);

    running_mean all, grazing;
    constexpr std::size_t batch = 64, most = 16384;
    // Below one facet per pixel the variance has no bound; the demand there grows with the standard error.
    const double wanted = facets >= 1 ? precision : 3 * precision;
    const auto precise = [&] { return all.standard_error() <= wanted && grazing.standard_error() <= wanted; };
    while (all.count < most && (all.count < batch || !precise())) {
        std::array<std::array<double, 2>, batch> means{};
        tbb::parallel_for(std::size_t{0}, batch, [&](std::size_t i) {
            const std::uint32_t seed = mica::hash(first_seed, static_cast<std::uint32_t>(all.count + i));
            double sum = 0, grazing_sum = 0;
            std::size_t grazing_count = 0;
            for (const auto& point : points) {
                const auto radiance = mica::shade<Law>(point, material, environment, table, seed);
                const auto ratio = static_cast<double>(luminance(radiance.glint) / luminance(radiance.smooth));
                sum += ratio;
                if (dot(point.normal, point.wo) < grazing_below) {
                    grazing_sum += ratio;
                    ++grazing_count;
                }
            }
            means[i] = {sum / static_cast<double>(points.size()), grazing_sum / static_cast<double>(grazing_count)};
        });
        for (const auto& [mean, grazing_mean] : means) {
            all.add(mean);
            grazing.add(grazing_mean);
        }
    }
    const auto row = [&](const char* pixels, const running_mean& measured) {
        return furnace_row{
            K,      facets,        log_density, roughness, pixels, measured.mean(), measured.standard_error(),
            wanted, measured.count};
    };
    return {row("all", all), row("grazing", grazing)};
}

} // namespace

void furnace(const furnace_options& options) {
    for (const double roughness : options.roughness)
        if (!(roughness >= 0 && roughness <= 1)) throw std::invalid_argument("--roughness is not in [0, 1]");
    for (const double facets : options.facets)
        if (!(facets > 0 && facets <= 1e12)) throw std::invalid_argument("--facets is not in (0, 1e12]");
    if (!(options.precision > 0)) throw std::invalid_argument("--precision is not positive");

    const mica::microfacet_table table;
    progress reporter("white furnace", options.levels.size() * options.roughness.size() * options.facets.size());
    std::vector<furnace_row> rows;
    for (const int levels : options.levels)
        for (const double facets : options.facets)
            for (const double roughness : options.roughness) {
                with_law(options.law, [&](auto law) {
                    with_levels(levels, [&](auto k) {
                        for (const auto& row : furnace_rows<decltype(law), decltype(k)::value>(
                                 facets, roughness, options.precision, table, static_cast<std::uint32_t>(rows.size())))
                            rows.push_back(row);
                    });
                });
                reporter.advance();
            }

    if (options.json) {
        std::printf("{\"rows\": [");
        const char* separator = "\n";
        for (const auto& row : rows) {
            std::printf("%s  {\"law\": \"%s\", \"levels\": %zu, \"log_density\": %.4f, \"facets_per_pixel\": %g, "
                        "\"roughness\": %g, \"pixels\": \"%s\", \"ratio\": %.6f, \"standard_error\": %.6f, "
                        "\"realisations\": %zu, \"passes\": %s}",
                        separator, options.law.c_str(), row.levels, row.log_density, row.facets_per_pixel,
                        row.roughness, row.pixels, row.ratio, row.standard_error, row.realisations,
                        row.passes() ? "true" : "false");
            separator = ",\n";
        }
        std::printf("\n]}\n");
        return;
    }
    std::printf("white furnace, law %s: mean of glint / smooth\n\n"
                "levels  facets/pixel  log density  roughness  pixels    ratio   std. error\n",
                options.law.c_str());
    for (const auto& row : rows)
        std::printf("%6zu  %12g  %11.2f  %9g  %-7s  %7.4f  %9.4f  %s\n", row.levels, row.facets_per_pixel,
                    row.log_density, row.roughness, row.pixels, row.ratio, row.standard_error,
                    row.passes() ? "" : "beyond max(0.005, 4 std. errors), or not known well enough");
}

} // namespace glint
