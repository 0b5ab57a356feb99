// mica/mica.hpp: everything (but reference/, which is for judging it).
#pragma once

/// Binomial and multinomial counts, grids and shading: a room for each in the folders of include/mica.
namespace mica {}

#include "config.hpp"

#include "numeric/angle.hpp"
#include "numeric/elementary.hpp"
#include "numeric/gate.hpp"
#include "numeric/normal.hpp"
#include "numeric/number.hpp"
#include "numeric/pack.hpp"

#include "random/generator_uniforms.hpp"
#include "random/hash.hpp"
#include "random/normal_pair.hpp"
#include "random/uniform.hpp"
#include "random/uniform_stream.hpp"

#include "law/batch.hpp"
#include "law/bernoulli_sum.hpp"
#include "law/binomial_distribution.hpp"
#include "law/binomial_law.hpp"
#include "law/distribution_stream.hpp"
#include "law/dual_gated.hpp"
#include "law/exact.hpp"
#include "law/floored_gated.hpp"
#include "law/gated.hpp"
#include "law/gaussian.hpp"
#include "law/multinomial.hpp"
#include "law/multinomial_distribution.hpp"
#include "law/quantile.hpp"
#include "law/rarer_side.hpp"
#include "law/smooth_quantile.hpp"
#include "law/softened_quantile.hpp"

#include "grid/angular.hpp"
#include "grid/blended_uniforms.hpp"
#include "grid/distributed.hpp"
#include "grid/footprint.hpp"
#include "grid/grid_vertices.hpp"
#include "grid/simplex.hpp"
#include "grid/tetrahedron.hpp"

#include "shade/contour_area.hpp"
#include "shade/effects.hpp"
#include "shade/environment.hpp"
#include "shade/environment_classes.hpp"
#include "shade/environment_glints.hpp"
#include "shade/glint_kernel.hpp"
#include "shade/lights.hpp"
#include "shade/microfacet.hpp"
#include "shade/ndf.hpp"
#include "shade/prefilter.hpp"
#include "shade/shading_point.hpp"
#include "shade/vector.hpp"
