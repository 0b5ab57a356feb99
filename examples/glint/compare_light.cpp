// The kernels under a light against facets that really exist, pixel by pixel.
//
// Pixels of a sphere; each is compared with what its facets would do one by one. Means and variances of the facets are by
// quadrature over all directions of the light, because under a small sun no number of samples says anything; dark pixels and
// the histogram are sampled, and so is all that the kernel gives. The variances of the kernel are also given by quadrature
// over its classes, for the same reason.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <stdexcept>

#include <mica/shade/microfacet.hpp>
#include <tbb/parallel_for.h>

#include "compare.hpp"
#include "explicit_light.hpp"
#include "render.hpp"

namespace glint {

namespace {

constexpr std::size_t across = 16, realisations = 512;

/// log2 of radiance / smooth from below -4 (dark pixels among them) to above 6, in half steps.
constexpr std::size_t bins = 21;
std::size_t bin_of(double relative) {
    if (!(relative > 0)) return 0;
    return static_cast<std::size_t>(std::clamp(2 * (std::log2(relative) + 4) + 1, 0., bins - 1.));
}

/// Radiance of one way to count, over the sphere.
struct pixel_sums {
    double mean = 0;   ///< by quadrature, summed over pixels
    double square = 0; ///< E[X^2], by quadrature, summed over pixels
    double sampled = 0, sampled_square = 0;
    double dark = 0; ///< samples below a tenth of smooth
    std::array<double, bins> histogram{};
    double samples = 0;

    void add_sample(double x, double smooth) {
        sampled += x;
        sampled_square += x * x;
        dark += x < 0.1 * smooth;
        ++histogram[bin_of(x / smooth)];
        ++samples;
    }
    void add(const pixel_sums& other) {
        mean += other.mean;
        square += other.square;
        sampled += other.sampled;
        sampled_square += other.sampled_square;
        dark += other.dark;
        samples += other.samples;
        for (std::size_t i = 0; i < bins; ++i) histogram[i] += other.histogram[i];
    }
    double deviation(double pixels) const {
        return std::sqrt(std::max(0., square / pixels - mean / pixels * (mean / pixels)));
    }
    double sampled_deviation() const {
        const double m = sampled / samples;
        return std::sqrt(std::max(0., sampled_square / samples - m * m));
    }
};

double histogram_distance(const pixel_sums& a, const pixel_sums& b) {
    double distance = 0;
    for (std::size_t i = 0; i < bins; ++i)
        distance += std::abs(a.histogram[i] / a.samples - b.histogram[i] / b.samples);
    return distance / 2;
}

/// E[X^2] of a pixel of floor(N + xi') facets, X = sum Y / N; of a Poisson number of them where `uniform`.
double mean_square(double trials, double y, double y_square, bool uniform) {
    const double fraction = trials - std::floor(trials);
    const double variance =
        uniform ? trials * y_square : trials * (y_square - y * y) + fraction * (1 - fraction) * y * y;
    return variance / (trials * trials) + y * y;
}

/// The kernel, the facets of the same lobe, those of the true lobe, and those of the same lobe at uniform positions.
struct light_row {
    double roughness, facets, trials;
    pixel_sums kernel, same, true_lobe, uniform;
    double pixels = 0;
};

struct prepared_pixel {
    mica::shading_point<float> point;
    facet_outcomes same, true_lobe;
    double area;
};

template <class Sample>
void add_samples(pixel_sums& sums, double smooth, const Sample& sample) {
    for (std::size_t i = 0; i < realisations; ++i) sums.add_sample(sample(i), smooth);
}

light_row compared(const std::vector<prepared_pixel>& pixels, const shader& shade, const scene_description& description,
                   double facets, std::uint32_t seed) {
    surface_description surface = description.surfaces.front();
    // So many that `facets` of a pixel flash, in the mean.
    double area = 0, flashes = 0, weight = 0;
    for (const auto& pixel : pixels) {
        const double p = pixel.same.flash_probability(), lit = pixel.same.mean();
        flashes += lit * pixel.area * p;
        weight += lit;
        area += pixel.area;
    }
    const double density = facets * weight / flashes;
    surface.material.log_density = static_cast<float>(std::log(density));

    std::vector<light_row> parts(pixels.size());
    tbb::parallel_for(std::size_t{0}, pixels.size(), [&](std::size_t i) {
        const auto& pixel = pixels[i];
        auto& part = parts[i];
        const double trials = density * pixel.area;
        std::mt19937_64 random(mica::hash(seed, static_cast<std::uint32_t>(i)));
        std::uniform_real_distribution<double> unit(0, 1);

        // The classes in luminance: E[Y^2] = sum S^2 / p.
        double y = 0, y_square = 0;
        const auto light = shade.illuminate(pixel.point, surface);
        for (const auto& one : light.classes) {
            const auto s = static_cast<double>(luminance(one.smooth)), p = static_cast<double>(one.probability);
            y += s;
            if (s > 0 && p > 0) y_square += s * s / p;
        }
        part.kernel.mean = y;
        part.kernel.square = mean_square(trials, y, y_square, false);
        add_samples(part.kernel, y, [&](std::size_t k) {
            const auto s = mica::hash(seed, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k));
            return static_cast<double>(luminance(shade(pixel.point, surface, light, s).glint));
        });
        const auto add_facets = [&](pixel_sums& sums, const facet_outcomes& outcomes, bool uniform) {
            sums.mean = outcomes.mean();
            sums.square = mean_square(trials, outcomes.mean(), outcomes.mean_square(), uniform);
            std::poisson_distribution<std::uint64_t> poisson(trials);
            add_samples(sums, outcomes.mean(), [&](std::size_t) {
                const auto n = uniform ? poisson(random) : static_cast<std::uint64_t>(trials + unit(random));
                return outcomes.sample(n, trials, random);
            });
        };
        add_facets(part.same, pixel.same, false);
        add_facets(part.true_lobe, pixel.true_lobe, false);
        add_facets(part.uniform, pixel.same, true);
    });
    const auto count = static_cast<double>(pixels.size());
    light_row row{
        static_cast<double>(surface.material.roughness), facets, density * area / count, {}, {}, {}, {}, count};
    for (const auto& part : parts) {
        row.kernel.add(part.kernel);
        row.same.add(part.same);
        row.true_lobe.add(part.true_lobe);
        row.uniform.add(part.uniform);
    }
    return row;
}

std::vector<prepared_pixel> prepare(const explicit_light& light, const scene_description& description,
                                    const mica::microfacet_table& table) {
    const auto& material = description.surfaces.front().material;
    const auto& type = description.lights.front().type;
    const bool environment = type == "environment", narrow = type == "sun" || type == "directional";
    const scene seen(description.camera, description.surfaces, across, across);
    std::vector<mica::shading_point<float>> points;
    for (std::size_t i = 0; i < across * across; ++i)
        if (const auto hit = seen.surface(i % across, i / across)) points.push_back(hit->point);
    const facet_normals normals(static_cast<double>(material.roughness));
    std::vector<std::optional<prepared_pixel>> all(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        const auto& point = points[i];
        const auto beams = light.beams(point);
        auto true_lobe = facets_under(beams, point, material, normals);
        const auto reflectance = table.albedo(dot(point.normal, point.wo), material.roughness)(material.f0);
        auto same = narrow ? true_lobe
                           : facets_of_split_sum(beams, point, material, normals,
                                                 static_cast<double>(luminance(reflectance)), environment);
        if (!(same.mean() > 0)) return; // no light comes here
        all[i] = prepared_pixel{point, std::move(same), std::move(true_lobe),
                                static_cast<double>(mica::make_footprint(point.derivatives).area)};
    });
    std::vector<prepared_pixel> pixels;
    for (auto& one : all)
        if (one) pixels.push_back(std::move(*one));
    return pixels;
}

// --- the picture ------------------------------------------------------------------------------------------------

constexpr std::size_t panel = 288, gap = 8, header = 24;

void draw_picture(const scene_description& described, const explicit_light& light, double log_density,
                  const png_file& output) {
    scene_description description = described;
    auto& surface = description.surfaces.front();
    // No more facets than fit; the picture says how many.
    surface.material.log_density = static_cast<float>(std::min(log_density, 15.));
    const scene seen(description.camera, description.surfaces, panel, panel);
    const frame counted = render_frame(seen, shader(description), description.seed);
    srgb_picture picture(3 * (panel + gap) + gap, panel + gap + header, 0);
    const auto left = [](std::size_t column) { return gap + column * (panel + gap); };
    const char* const titles[] = {"kernel", "explicit facets", "smooth limit"};
    for (std::size_t column = 0; column < 3; ++column) draw_text(picture, titles[column], left(column), 5, 2, 220);
    const float exposure = exposure_of(counted);
    tone_map(counted.glint, exposure, picture, left(0), header);
    tone_map(picture_of_facets(seen, light, surface, description.seed), exposure, picture, left(1), header);
    tone_map(counted.smooth, exposure, picture, left(2), header);
    output.save(picture);
}

} // namespace

void compare_light(const compare_light_options& options) {
    scene_description description = describe(options.scene);
    check(description);
    if (description.lights.size() != 1 || description.lights.front().type == "wdh20")
        throw std::invalid_argument("compare knows one light: environment, directional, sun, area, rectangle or disk");
    if (description.surfaces.front().shape != "sphere") throw std::invalid_argument("compare knows the sphere");
    for (const double facets : options.facets)
        if (!(facets > 0 && facets <= 1e5)) throw std::invalid_argument("--facets is not in (0, 1e5]");
    for (const double roughness : options.roughness)
        if (!(roughness >= 0.02 && roughness <= 1)) throw std::invalid_argument("--roughness is not in [0.02, 1]");
    const png_file output(options.scene.output);
    // The normals that flash lie in a cone of R times the size of the lobe, across which D should not change.
    if (description.lights.front().type == "directional") description.lights.front().glint_fraction = 0.02F;
    const auto explicit_of = [&](float roughness) {
        return make_explicit_light(description.lights.front(), description.occluder, roughness);
    };
    const mica::microfacet_table table;

    progress reporter("compare", options.roughness.size() * (options.facets.size() + 1));
    std::vector<light_row> rows;
    for (const double roughness : options.roughness) {
        description.surfaces.front().material.roughness = static_cast<float>(roughness);
        const shader shade(description);
        const auto pixels = prepare(*explicit_of(static_cast<float>(roughness)), description, table);
        reporter.advance();
        if (pixels.empty()) throw std::invalid_argument("the light reaches no pixel of the sphere");
        for (const double facets : options.facets) {
            rows.push_back(compared(pixels, shade, description, facets,
                                    mica::hash(description.seed, static_cast<std::uint32_t>(rows.size()))));
            reporter.advance();
        }
    }
    description.surfaces.front().material.roughness = static_cast<float>(options.roughness.front());
    draw_picture(description, *explicit_of(static_cast<float>(options.roughness.front())), options.scene.log_density,
                 output);

    const auto& lit = description.lights.front();
    if (options.scene.json) {
        std::printf("{\"rows\": [");
        const char* separator = "\n";
        for (const auto& row : rows) {
            const auto& [roughness, facets, trials, kernel, same, true_lobe, uniform, pixels] = row;
            std::printf(
                "%s  {\"light\": \"%s\", \"classes\": \"%s\", \"levels\": %d, \"law\": \"%s\", \"roughness\": %g, "
                "\"flashing_facets\": %g, \"facets_per_pixel\": %g, \"mean_ratio\": %.5f, \"sampled_mean_ratio\": "
                "%.5f, "
                "\"std_ratio\": %.4f, \"sampled_std_ratio\": %.4f, \"dark\": %.4f, \"dark_facets\": %.4f, "
                "\"histogram_tv\": %.4f, \"true_mean_ratio\": %.4f, \"true_std_ratio\": %.4f, \"true_dark\": %.4f, "
                "\"uniform_std_ratio\": %.4f, \"uniform_dark\": %.4f}",
                separator, lit.type.c_str(), lit.classes.c_str(), lit.levels, description.counting.law.c_str(),
                roughness, facets, trials, kernel.mean / same.mean,
                kernel.sampled / kernel.samples / (kernel.mean / pixels),
                kernel.deviation(pixels) / same.deviation(pixels),
                kernel.sampled_deviation() / kernel.deviation(pixels), kernel.dark / kernel.samples,
                same.dark / same.samples, histogram_distance(kernel, same), kernel.mean / true_lobe.mean,
                kernel.deviation(pixels) / true_lobe.deviation(pixels), true_lobe.dark / true_lobe.samples,
                kernel.deviation(pixels) / uniform.deviation(pixels), uniform.dark / uniform.samples);
            separator = ",\n";
        }
        std::printf("\n]}\n");
        return;
    }
    std::printf(
        "%s light against explicit facets, over the pixels of a sphere: kernel / facets\n\n"
        "                           same lobe                                  true lobe               uniform\n"
        "roughness  flashing    mean     std    dark  (facets)  histogram     mean     std    dark      std    dark\n",
        lit.type.c_str());
    for (const auto& row : rows) {
        const auto& [roughness, facets, trials, kernel, same, true_lobe, uniform, pixels] = row;
        std::printf("%9g  %8g  %6.4f  %6.3f  %6.3f  %8.3f  %9.3f  %7.4f  %6.3f  %6.3f  %7.3f  %6.3f\n", roughness,
                    facets, kernel.mean / same.mean, kernel.deviation(pixels) / same.deviation(pixels),
                    kernel.dark / kernel.samples, same.dark / same.samples, histogram_distance(kernel, same),
                    kernel.mean / true_lobe.mean, kernel.deviation(pixels) / true_lobe.deviation(pixels),
                    true_lobe.dark / true_lobe.samples, kernel.deviation(pixels) / uniform.deviation(pixels),
                    uniform.dark / uniform.samples);
    }
}

} // namespace glint
