// Figures of the papers, drawn again by this code.
#pragma once

#include <cstdint>
#include <string>

namespace glint {

/// What the command line asks of `glint figure`.
struct figure_options {
    int number = 6; ///< of KK25: 6, 7, 10, 11, 13 or 14
    std::string environment;
    int realisations = 1024; ///< of what is averaged
    std::uint32_t seed = 1;
    std::string output = "figure.png";
};

void figure(const figure_options& options);

} // namespace glint
