// The kernels that the program is compiled for, by what they are composed of.
#pragma once

#include <functional>
#include <span>

#include "description.hpp"

namespace glint {

/// Classes of light of a pixel.
inline constexpr std::size_t most_classes = 8;

/// Shades a pixel whose classes of light are known: point, material, classes, half vector, seed.
using kernel_function = std::function<mica::glint_radiance<float>(
    const mica::shading_point<float>&, const mica::glint_material&, std::span<const mica::light_class<float>>,
    mica::vector3<float>, std::uint32_t)>;

struct compiled_kernel {
    kernel_function shade;
    std::size_t (*binomials)(std::size_t categories); ///< of a pixel
};

/// The names of the laws.
inline constexpr char known_laws[] =
    "none, gaussian, bernoulli_sum, published_gated, floored_gated, gated, dual_gated, quantile, "
    "quantile:4, quantile:8, smooth_quantile, smooth_quantile:4, exact";

/// The kernel that has just these effects, for so many classes of light. Throws std::invalid_argument where the program has
/// no such kernel: every law counts 1 to 8 classes by variates, quantile and dual_gated by counts; effects are for quantile.
compiled_kernel find_kernel(const counting_description& counting, std::size_t classes);

} // namespace glint
