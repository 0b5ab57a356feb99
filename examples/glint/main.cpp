// glint: the command-line face of mica.
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <exception>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <tbb/global_control.h>

#include "compare.hpp"
#include "costs.hpp"
#include "figures.hpp"
#include "render.hpp"

namespace {

/// Errors are one line, whatever names they quote: without control characters, and not endless.
std::string one_line(std::string text) {
    constexpr std::size_t longest = 1000;
    while (!text.empty() && text.back() == '\n') text.pop_back();
    if (text.size() > longest) {
        text.resize(longest);
        text += " ...";
    }
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
    return text;
}

/// The options that say how facets are counted.
void add_counting(CLI::App* command, glint::counting_description& counting) {
    command->add_option("--law", counting.law, std::string("binomial law: ") + glint::known_laws)
        ->capture_default_str();
    command->add_option("--interpolate", counting.interpolate, "what a pixel blends: variates or counts")
        ->capture_default_str();
    command->add_option("--softness", counting.softness, "of glints' edges, in [0, 1); for variates")
        ->capture_default_str();
    auto& effects = counting.effects;
    command->add_option("--angular-grid", effects.angular_grid,
                        "glints live and die with the half vector: facet roughness, e.g. 0.02");
    command->add_option("--varied-density", effects.varied_density,
                        "density from place to place: deviation of its logarithm, in [0, 1]");
    command->add_option("--tint", effects.tint, "a colour for every glint: deviation of a band's logarithm, in [0, 1]");
    command->add_option("--smooth-where-dense", effects.smooth_tolerance,
                        "smooth where glints deviate by less, relative");
    command->add_flag("--one-grid", effects.one_grid, "one of the four grids of --interpolate counts, at random");
}

/// The options that say what shines.
void add_light(CLI::App* command, glint::render_options& scene) {
    command->add_option("--light", scene.light, "environment, wdh20, directional, sun, area or disk")
        ->capture_default_str();
    command->add_option("--env", scene.environment, "environment map, .hdr or .exr (none: a procedural one)");
    command->add_option("--levels", scene.levels, "classes K of the environment's light")->capture_default_str();
    command
        ->add_option("--classes", scene.classes,
                     "what parts the environment's light: brightness, colour, or published: as in KK25")
        ->capture_default_str();
    command->add_option("--occluder", scene.occluder,
                        "x,y,z: a wall; nothing shines from directions on its side (area lights: by their centre)");
}

/// Whether an option decides what is in the picture, not where it goes or how it is made.
bool is_of_the_picture(const CLI::Option& option) {
    return !option.check_lname("output") && !option.check_lname("tile") && !option.check_lname("json") &&
           !option.check_lname("threads");
}

/// The options of a command that decide what is in its picture, name=value.
std::string origin_of(const CLI::App& command) {
    std::string text;
    for (const CLI::Option* const option : command.get_options())
        if (option->count() > 0 && is_of_the_picture(*option))
            for (const auto& value : option->results()) text += option->get_name() + "=" + value + " ";
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
    render_command->add_option(
        "--scene", render.scene_file,
        "scene file, JSON: lights, surfaces, effects (docs/effects.md); instead of all options but "
        "--tile, --output and --json");
    add_light(render_command, render);
    render_command->add_option("--lights", render.lights, "so many of that light, in an arc, coloured")
        ->capture_default_str();
    render_command->add_option("--shape", render.shape, "sphere or plane")->capture_default_str();
    render_command->add_option("--size", render.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
    render_command->add_option("--roughness", render.roughness, "GGX alpha, 0 to 1")->capture_default_str();
    render_command->add_option("--density", render.log_density, "natural logarithm of the facets per unit uv^2")
        ->capture_default_str();
    add_counting(render_command, render.counting);
    render_command->add_option("--seed", render.seed, "which realisation")->capture_default_str();
    render_command->add_option("--tile", render.tile, "x,y,w,h: only these pixels, to an .exr for glint merge");
    render_command->add_option("-o,--output", render.output, "PNG, or .exr: linear radiance")->capture_default_str();
    render_command->add_flag("--json", render.json, "print one JSON object about the picture");
    add_threads(render_command);

    glint::merge_options merge;
    CLI::App* const merge_command =
        app.add_subcommand("merge", "put the tiles of glint render --tile together, the same bytes as without tiles");
    merge_command->add_option("tiles", merge.tiles, ".exr files that cover the picture")->required();
    merge_command->add_option("-o,--output", merge.output, "PNG, or .exr: linear radiance")->capture_default_str();
    merge_command->add_flag("--json", merge.json, "print one JSON object about the picture");

    glint::sheet_options sheet;
    CLI::App* const sheet_command =
        app.add_subcommand("sheet", "render a labelled contact sheet of densities, roughnesses and levels");
    sheet_command->add_option("--seed", sheet.seed, "which realisation")->capture_default_str();
    sheet_command->add_option("-o,--output", sheet.output, "PNG to write")->capture_default_str();
    add_threads(sheet_command);

    glint::furnace_options furnace;
    CLI::App* const furnace_command =
        app.add_subcommand("furnace", "white furnace: the mean of glint / smooth over many realisations");
    add_counting(furnace_command, furnace.counting);
    furnace_command
        ->add_option("--light", furnace.lights, "environment, wdh20, directional, sun, area, disk; one or more")
        ->delimiter(',');
    furnace_command->add_option("--levels", furnace.levels, "classes K of the environment, one or more")
        ->delimiter(',');
    furnace_command->add_option("--roughness", furnace.roughness, "GGX alphas")->delimiter(',');
    furnace_command->add_option("--facets", furnace.facets, "facets per pixel that flash, mean over the sphere")
        ->delimiter(',');
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
    glint::compare_light_options compare_light;
    compare_light.scene.light.clear();
    compare_light.scene.levels = 8;
    add_light(compare_command, compare_light.scene);
    compare_command->get_option("--light")->description(
        "with it: the kernel under that light against explicit facets, over a sphere");
    compare_command->add_option("--roughness", compare_light.roughness, "GGX alphas, with --light")->delimiter(',');
    compare_command->add_option("--facets", compare_light.facets, "facets per pixel that flash, with --light")
        ->delimiter(',');
    compare_command->add_option("--density", compare_light.scene.log_density, "of the picture, with --light")
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

    glint::costs_options costs;
    CLI::App* const costs_command =
        app.add_subcommand("costs", "what every light and effect costs: binomials, time and instructions of a pixel");
    costs_command->add_option("--size", costs.size, "of the square picture whose pixels are shaded")
        ->capture_default_str();
    costs_command->add_option("--density", costs.log_density, "natural logarithm of the facets per unit uv^2")
        ->capture_default_str();
    costs_command->add_option("--repetitions", costs.repetitions, "of which the median is taken")
        ->capture_default_str();
    costs_command->add_flag("--no-callgrind", costs.no_callgrind, "count no instructions");
    costs_command->add_flag("--counting", costs.counting, "shade every row once (what callgrind runs)")->group("");
    costs_command->add_flag("--json", costs.json, "print {\"rows\": [...]}");

    glint::figure_options figure;
    CLI::App* const figure_command =
        app.add_subcommand("figure", "a figure of KK25, the published method beside ours and explicit facets");
    figure_command->add_option("number", figure.number, "6, 7, 10, 11, 13 or 14")->required();
    figure_command->add_option("--env", figure.environment,
                               "environment map of figures 6 and 10 (none: a procedural one)");
    figure_command->add_option("--realisations", figure.realisations, "of which means are taken")
        ->capture_default_str();
    figure_command->add_option("--seed", figure.seed, "which realisation")->capture_default_str();
    figure_command->add_option("-o,--output", figure.output, "PNG to write")->capture_default_str();
    add_threads(figure_command);

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& asked) { // --help, --version
        return app.exit(asked);
    } catch (const CLI::ParseError& error) {
        throw std::invalid_argument(one_line(error.what()) + " (see glint --help)");
    }

    if (threads < 0 || threads > 1024)
        throw std::invalid_argument("--threads " + std::to_string(threads) + " is not in [0, 1024]");
    if (render_command->count("--scene") > 0)
        for (const CLI::Option* const option : render_command->get_options())
            if (option->count() > 0 && is_of_the_picture(*option) && !option->check_lname("scene"))
                throw std::invalid_argument(option->get_name() +
                                            " is for scenes without a file: the file of --scene says it");
    if (!glint::is_environment(render.light))
        for (const char* const option : {"--env", "--levels", "--classes"})
            if (render_command->count(option) > 0)
                throw std::invalid_argument(std::string(option) + " is for environments, not for --light " +
                                            render.light);
    if (render_command->count("--env") > 0 && render.environment.empty()) throw std::invalid_argument("--env is empty");
    std::optional<tbb::global_control> limit;
    if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));

    render.origin = origin_of(*render_command);
    if (*render_command) glint::render(render);
    if (*merge_command) glint::merge(merge);
    if (*sheet_command) glint::sheet(sheet);
    if (*furnace_command) glint::furnace(furnace);
    if (*compare_command && compare_light.scene.light.empty()) glint::compare(compare);
    if (*compare_command && !compare_light.scene.light.empty()) {
        compare_light.scene.counting.law = compare.law;
        compare_light.scene.seed = compare.seed;
        compare_light.scene.output = compare.output;
        compare_light.scene.json = compare.json;
        glint::compare_light(compare_light);
    }
    if (*costs_command) glint::costs(costs);
    if (*figure_command) glint::figure(figure);
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
    } catch (const std::bad_alloc&) {
        std::fputs("glint: not enough memory\n", stderr);
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "glint: %s\n", one_line(error.what()).c_str());
        return 2;
    }
}
