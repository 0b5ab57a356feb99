// glint: the command-line face of mica.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <tbb/global_control.h>

#include "compare.hpp"
#include "render.hpp"

namespace {

/// Errors are one line, whatever names they quote.
std::string one_line(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

int run(int argc, char** argv) {
    CLI::App app("Glints by mica: how many facets flash, in every pixel, at constant cost.", "glint");
    app.require_subcommand(1);
    app.set_version_flag("--version", std::string("glint ") + std::to_string(MICA_VERSION_MAJOR) + "." +
                                          std::to_string(MICA_VERSION_MINOR) + "." +
                                          std::to_string(MICA_VERSION_PATCH));
    int threads = 0;
    const auto add_threads = [&threads](CLI::App* command) {
        command->add_option("--threads", threads, "threads (0: all cores); the picture does not depend on it");
    };

    glint::render_options render;
    CLI::App* const render_command = app.add_subcommand("render", "render a glittering sphere or plane to a PNG");
    render_command->add_option("--env", render.environment, "environment map, Radiance .hdr (none: a procedural one)");
    render_command->add_option("--light", render.light, "environment")->capture_default_str();
    render_command->add_option("--shape", render.shape, "sphere or plane")->capture_default_str();
    render_command->add_option("--size", render.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
    render_command->add_option("--roughness", render.roughness, "GGX alpha, 0 to 1")->capture_default_str();
    render_command->add_option("--density", render.log_density, "natural logarithm of the facets per unit uv^2")
        ->capture_default_str();
    render_command->add_option("--levels", render.levels, "brightness levels K of the environment")
        ->capture_default_str();
    render_command->add_option("--law", render.law, std::string("binomial law: ") + glint::known_laws)
        ->capture_default_str();
    render_command->add_option("--interpolate", render.interpolate, "what a pixel blends: variates or counts")
        ->capture_default_str();
    render_command->add_option("--softness", render.softness, "of glints' edges, in [0, 1); for variates")
        ->capture_default_str();
    render_command->add_option("--seed", render.seed, "which realisation")->capture_default_str();
    render_command->add_option("-o,--output", render.output, "PNG to write")->capture_default_str();
    render_command->add_flag("--json", render.json, "print one JSON object about the picture");
    add_threads(render_command);

    glint::sheet_options sheet;
    CLI::App* const sheet_command =
        app.add_subcommand("sheet", "render a labelled contact sheet of densities, roughnesses and levels");
    sheet_command->add_option("--seed", sheet.seed, "which realisation")->capture_default_str();
    sheet_command->add_option("-o,--output", sheet.output, "PNG to write")->capture_default_str();
    add_threads(sheet_command);

    glint::furnace_options furnace;
    CLI::App* const furnace_command =
        app.add_subcommand("furnace", "white furnace: the mean of glint / smooth over many realisations");
    furnace_command->add_option("--law", furnace.law, std::string("binomial law: ") + glint::known_laws)
        ->capture_default_str();
    furnace_command->add_option("--levels", furnace.levels, "levels K, one or more")->delimiter(',');
    furnace_command->add_option("--roughness", furnace.roughness, "GGX alphas")->delimiter(',');
    furnace_command->add_option("--facets", furnace.facets, "facets per pixel, mean over the sphere")->delimiter(',');
    furnace_command->add_option("--precision", furnace.precision, "standard error to reach from 1 facet per pixel")
        ->capture_default_str();
    furnace_command->add_flag("--json", furnace.json, "print {\"rows\": [...]}");
    add_threads(furnace_command);

    glint::compare_options compare;
    CLI::App* const compare_command = app.add_subcommand(
        "compare",
        "counts, variates and explicit facets side by side: a picture, and how far each is from the binomial");
    compare_command->add_option("--law", compare.law, "binomial law: quantile, quantile:8 or exact")
        ->capture_default_str();
    compare_command->add_option("--mode", compare.modes, "counts, variates, facets, facets_uniform")->delimiter(',');
    compare_command->add_option("--ratio", compare.ratios, "length over width of the footprints")->delimiter(',');
    compare_command->add_option("--trials", compare.trials, "facets in a footprint, real")->delimiter(',');
    compare_command->add_option("--probability", compare.probabilities, "of a flash")->delimiter(',');
    compare_command->add_option("--precision", compare.precision, "standard error of mean_ratio to reach")
        ->capture_default_str();
    compare_command->add_option("--samples", compare.most_samples, "at most so many samples a row")
        ->capture_default_str();
    compare_command->add_option("--scale", compare.footprint_scale, "size of a glint, in pixels")
        ->capture_default_str();
    compare_command->add_option("--seed", compare.seed, "which realisation")->capture_default_str();
    compare_command->add_option("-o,--output", compare.output, "PNG to write")->capture_default_str();
    compare_command->add_flag("--json", compare.json, "print {\"rows\": [...]}");
    add_threads(compare_command);

    glint::strips_options strips;
    CLI::App* const strips_command =
        app.add_subcommand("strips", "frames of a zoom, a rotation and a pan, by counts and by variates");
    strips_command->add_option("--seed", strips.seed, "which realisation")->capture_default_str();
    strips_command->add_option("-o,--output", strips.output, "PNG to write")->capture_default_str();

    glint::cells_options cells;
    CLI::App* const cells_command =
        app.add_subcommand("cells", "the variates of 512 x 512 neighbouring cells, as grey");
    cells_command->add_option("--seed", cells.seed, "which realisation")->capture_default_str();
    cells_command->add_option("-o,--output", cells.output, "PNG to write")->capture_default_str();

    glint::between_options between;
    CLI::App* const between_command =
        app.add_subcommand("between", "distributions of counts on and between two levels of the grids");
    between_command->add_option("--seed", between.seed, "which realisation")->capture_default_str();
    between_command->add_flag("--json", between.json, "print {\"rows\": [...]}");

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& asked) { // --help, --version
        return app.exit(asked);
    } catch (const CLI::ParseError& error) {
        throw std::invalid_argument(one_line(error.what()) + " (see glint --help)");
    }

    if (threads < 0 || threads > 1024)
        throw std::invalid_argument("--threads " + std::to_string(threads) + " is not in [0, 1024]");
    if (render_command->count("--env") > 0 && render.environment.empty()) throw std::invalid_argument("--env is empty");
    std::optional<tbb::global_control> limit;
    if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));

    if (*render_command) glint::render(render);
    if (*sheet_command) glint::sheet(sheet);
    if (*furnace_command) glint::furnace(furnace);
    if (*compare_command) glint::compare(compare);
    if (*strips_command) glint::strips(strips);
    if (*cells_command) glint::cells(cells);
    if (*between_command) glint::between(between);
    if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "glint: %s\n", one_line(error.what()).c_str());
        return 2;
    }
}
