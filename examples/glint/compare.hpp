// Counts by interpolation, by blended variates and of facets that really exist, on the same patch.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render.hpp"

namespace glint {

/// What the command line asks of `glint compare`.
struct compare_options {
    std::string law = "quantile";
    std::vector<std::string> modes = {"counts", "variates", "facets"};
    std::vector<double> ratios = {1, 4, 16, 64};
    std::vector<double> trials = {0.5, 1.5, 8, 50, 1000.5, 1e4};
    std::vector<double> probabilities = {0.002, 0.02, 0.2, 0.5};
    double precision = 0.0017; ///< standard error of mean_ratio to reach, and 4 times that of variance_ratio
    double most_samples = 1 << 18;
    double footprint_scale = 1.25;
    std::uint32_t seed = 1;
    std::string output = "compare.png";
    bool json = false;
};

void compare(const compare_options& options);

/// What the command line asks of `glint compare --light`.
struct compare_light_options {
    render_options scene; ///< its light; of its roughness and density, those below and the picture's
    std::vector<double> roughness = {0.1, 0.3, 0.6};
    std::vector<double> facets = {0.5, 5, 50}; ///< that flash, in a pixel
};

void compare_light(const compare_light_options& options);

/// What the command line asks of `glint strips`.
struct strips_options {
    std::uint32_t seed = 1;
    std::string output = "strips.png";
};

/// Frames of a zoom, a rotation and a pan, each mode in a row of its own.
void strips(const strips_options& options);

/// What the command line asks of `glint cells`.
struct cells_options {
    std::uint32_t seed = 1;
    std::string output = "cells.png";
};

/// The normal variates of 512 x 512 neighbouring cells, as grey: no pattern to be seen.
void cells(const cells_options& options);

/// What the command line asks of `glint between`.
struct between_options {
    std::uint32_t seed = 1;
    bool json = false;
};

/// Distributions of counts on and between two levels (DB23 Fig. 4).
void between(const between_options& options);

} // namespace glint
