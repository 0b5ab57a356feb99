// Every effect and light by itself, and those that go together: binomials, time and instructions of a pixel.
//
// One thread shades the pixels of a sphere. Time is the median over repetitions of all rows one after the other, so that a
// busy machine slows all alike; the ratio is to the smooth shading of the same scene. Instructions are counted by callgrind,
// where there is one: the program runs itself under it, and every row is one call of glint_shade_pixels.
#include "costs.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>

#include "render.hpp"

namespace glint {

namespace {

struct lit_point {
    mica::shading_point<float> point;
    const surface_description* surface;
};

struct cost_row {
    std::string name;
    scene_description scene;
    std::size_t smooth = 0; ///< the row of the same scene without glints
    double ns = 0;
    long instructions = -1;
};

} // namespace

/// One pass over the pixels. By a name that callgrind can be told.
extern "C" [[gnu::noinline]] float glint_shade_pixels(const shader* shade, const lit_point* points, std::size_t count) {
    float sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto radiance = (*shade)(points[i].point, *points[i].surface, 1);
        sum += radiance.glint.r + radiance.glint.g + radiance.glint.b;
    }
    return sum;
}

namespace {

light_description light_of(const char* type) {
    light_description light;
    light.type = type;
    return light;
}

/// All rows; those without glints come first of their scene.
std::vector<cost_row> all_rows(double log_density) {
    std::vector<cost_row> rows;
    scene_description scene;
    scene.surfaces.front().material.roughness = 0.3F;
    scene.surfaces.front().material.log_density = static_cast<float>(log_density);
    std::size_t smooth = 0;
    const auto add = [&](const std::string& name, const auto& change) {
        cost_row row{name, scene, smooth, 0, -1};
        change(row.scene);
        rows.push_back(row);
    };
    const auto with_smooth = [&](const std::string& name) {
        smooth = rows.size();
        add(name + ", smooth", [](auto& s) { s.counting.law = "none"; });
    };
    const auto nothing = [](scene_description&) {};

    with_smooth("environment, 4 classes");
    add("environment, 4 classes", nothing);
    add("  published levels", [](auto& s) { s.lights[0].classes = "published"; });
    add("  classes by colour", [](auto& s) { s.lights[0].classes = "colour"; });
    add("  occluder", [](auto& s) { s.occluder = vector{1, 0, 0}; });
    add("  softness 0.2", [](auto& s) { s.counting.softness = 0.2; });
    add("  angular_grid", [](auto& s) { s.counting.effects.angular_grid = 0.02F; });
    add("  varied_density", [](auto& s) { s.counting.effects.varied_density = 0.5F; });
    add("  tint", [](auto& s) { s.counting.effects.tint = 0.5F; });
    add("  smooth_where_dense, 0.02", [](auto& s) { s.counting.effects.smooth_tolerance = 0.02F; });
    add("  smooth_where_dense, 0.02, log density 22", [](auto& s) {
        s.counting.effects.smooth_tolerance = 0.02F;
        s.surfaces[0].material.log_density = 22;
    });
    add("  varied_density, tint", [](auto& s) {
        s.counting.effects.varied_density = 0.5F;
        s.counting.effects.tint = 0.5F;
    });
    add("  angular_grid, varied_density, tint, smooth_where_dense", [](auto& s) {
        s.counting.effects = {0.02F, 0.5F, 0.5F, 0.02F, false};
    });
    add("  counts", [](auto& s) { s.counting.interpolate = "counts"; });
    add("  counts, published law and levels", [](auto& s) {
        s.counting.interpolate = "counts";
        s.counting.law = "dual_gated";
        s.lights[0].classes = "published";
    });
    add("  counts, one_grid", [](auto& s) {
        s.counting.interpolate = "counts";
        s.counting.effects.one_grid = true;
    });
    add("  exact law", [](auto& s) { s.counting.law = "exact"; });

    scene.lights[0].levels = 8;
    with_smooth("environment, 8 classes");
    add("environment, 8 classes", nothing);
    add("  counts", [](auto& s) { s.counting.interpolate = "counts"; });

    scene.lights = {light_of("wdh20")};
    with_smooth("environment, one probability (WDH20)");
    add("environment, one probability (WDH20)", nothing);

    for (const char* type : {"directional", "sun", "rectangle", "disk"}) {
        scene.lights = {light_of(type)};
        with_smooth(type);
        add(type, nothing);
        add("  angular_grid", [](auto& s) { s.counting.effects.angular_grid = 0.02F; });
        if (scene.lights[0].type == "directional")
            add("  counts, angular_grid", [](auto& s) {
                s.counting.interpolate = "counts";
                s.counting.effects.angular_grid = 0.02F;
            });
        if (scene.lights[0].type == "sun")
            add("  Beckmann, anisotropic", [](auto& s) {
                s.surfaces[0].distribution = "beckmann";
                s.surfaces[0].roughness_across = 0.1F;
            });
    }
    for (const std::size_t count : {4U, 8U}) {
        scene.lights.assign(count, light_of("sun"));
        for (std::size_t i = 0; i < count; ++i) scene.lights[i].direction = {static_cast<float>(i) - 1.5F, 1, 2};
        with_smooth(std::to_string(count) + " suns");
        add(std::to_string(count) + " suns, one multinomial", nothing);
    }
    scene.lights = {light_of("environment"), light_of("sun"), light_of("rectangle")};
    with_smooth("environment, sun and rectangle");
    add("environment, sun and rectangle", nothing);
    return rows;
}

/// Runs this program under callgrind with the same rows. Instructions of every row, or nothing where there is no callgrind.
std::vector<long> counted_instructions(const costs_options& options, std::size_t rows) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (error) return {};
    const fs::path folder = fs::temp_directory_path() / ("glint-costs-" + std::to_string(getpid()));
    const std::string output = (folder / "out").string();
    if ((output + program.string()).find('\'') != std::string::npos) return {}; // would end the quotes
    if (!fs::create_directory(folder, error)) return {};                        // somebody else's
    const std::string command =
        "valgrind --tool=callgrind --callgrind-out-file='" + output +
        "' --collect-atstart=no --toggle-collect=glint_shade_pixels --dump-after=glint_shade_pixels '" +
        program.string() + "' costs --counting --size " + std::to_string(options.size) + " --density " +
        std::to_string(options.log_density) + " >/dev/null 2>&1";
    std::vector<long> counted;
    if (std::system(command.c_str()) == 0) {
        for (std::size_t i = 1; i <= rows; ++i) {
            std::ifstream dump(folder / ("out." + std::to_string(i)));
            long total = -1;
            for (std::string line; std::getline(dump, line);)
                if (line.rfind("totals: ", 0) == 0 || line.rfind("summary: ", 0) == 0)
                    total = std::strtol(line.c_str() + line.find(' '), nullptr, 10);
            counted.push_back(total);
        }
    }
    fs::remove_all(folder, error);
    return counted;
}

} // namespace

void costs(const costs_options& options) {
    if (options.size < 4 || options.size > 1024) throw std::invalid_argument("--size is not in [4, 1024]");
    if (options.repetitions < 1) throw std::invalid_argument("--repetitions is not positive");
    auto rows = all_rows(options.log_density);
    progress reporter("costs", rows.size() + static_cast<std::size_t>(options.repetitions));

    std::vector<shader> shaders;
    for (const auto& row : rows) {
        shaders.emplace_back(row.scene);
        reporter.advance();
    }
    const scene seen(rows.front().scene.camera, rows.front().scene.surfaces, options.size, options.size);
    std::vector<mica::shading_point<float>> visible;
    for (std::size_t i = 0; i < options.size * options.size; ++i)
        if (const auto hit = seen.surface(i % options.size, i / options.size)) visible.push_back(hit->point);

    std::vector<std::vector<double>> seconds(rows.size());
    volatile float sink = 0;
    std::vector<lit_point> points(visible.size());
    const auto pass = [&](std::size_t row) {
        for (std::size_t i = 0; i < visible.size(); ++i) points[i] = {visible[i], &rows[row].scene.surfaces.front()};
        const stopwatch watch;
        sink = sink + glint_shade_pixels(&shaders[row], points.data(), points.size());
        return watch.seconds();
    };
    // What is built at the first call is no cost of a pixel.
    for (std::size_t row = 0; row < rows.size(); ++row)
        sink = sink + shaders[row].illuminate(visible.front(), rows[row].scene.surfaces.front()).smooth().g;
    if (options.counting) {
        for (std::size_t row = 0; row < rows.size(); ++row) pass(row);
        return;
    }
    for (int repetition = 0; repetition < options.repetitions; ++repetition) {
        for (std::size_t row = 0; row < rows.size(); ++row) seconds[row].push_back(pass(row));
        reporter.advance();
    }
    const auto pixels = static_cast<double>(points.size());
    for (std::size_t row = 0; row < rows.size(); ++row) {
        std::sort(seconds[row].begin(), seconds[row].end());
        rows[row].ns = seconds[row][seconds[row].size() / 2] * 1e9 / pixels;
    }
    if (!options.no_callgrind) {
        const auto counted = counted_instructions(options, rows.size());
        for (std::size_t row = 0; row < counted.size(); ++row) rows[row].instructions = counted[row];
    }

    if (options.json)
        std::printf("{\"rows\": [");
    else
        std::printf("binomials  ns/pixel  / smooth  instructions/pixel\n");
    const char* separator = "\n";
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& row = rows[i];
        const std::size_t binomials = shaders[i].binomials_per_pixel();
        const double ratio = row.ns / rows[row.smooth].ns;
        const std::string instructions =
            row.instructions < 0 ? "null" : std::to_string(static_cast<double>(row.instructions) / pixels);
        if (options.json) {
            std::printf("%s  {\"effects\": \"%s\", \"light\": \"%s\", \"lights\": %zu, \"binomials_per_pixel\": %zu, "
                        "\"ns_per_pixel\": %.1f, \"instructions_per_pixel\": %s, \"ratio_to_smooth\": %.3f}",
                        separator, row.name.c_str(), row.scene.lights.front().type.c_str(), row.scene.lights.size(),
                        binomials, row.ns, instructions.c_str(), ratio);
            separator = ",\n";
        } else {
            std::printf("%9zu  %8.1f  %8.2f  %18s  %s\n", binomials, row.ns, ratio, instructions.c_str(),
                        row.name.c_str());
        }
    }
    if (options.json) std::printf("\n]}\n");
}

} // namespace glint
