// What effects and lights cost.
#pragma once

#include <cstddef>

namespace glint {

/// What the command line asks of `glint costs`.
struct costs_options {
    std::size_t size = 64; ///< of the picture whose pixels are shaded
    double log_density = 13;
    int repetitions = 31;
    bool counting = false; ///< run by callgrind: shade the pixels of every row once, and print nothing
    bool no_callgrind = false;
    bool json = false;
};

void costs(const costs_options& options);

} // namespace glint
