// Packs may be included after what takes them: every room with packs, in that order. (clang-format would sort the includes.)
// clang-format off
#include <mica/law/exact.hpp>
#include <mica/law/dual_gated.hpp>
#include <mica/law/multinomial.hpp>
#include <mica/law/quantile.hpp>
#include <mica/law/smooth_quantile.hpp>
#include <mica/grid/distributed.hpp>
#include <mica/shade/environment_glints.hpp>
#include <mica/shade/glint_kernel.hpp>
#include <mica/shade/lights.hpp>
#include <mica/numeric/pack.hpp>
// clang-format on

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace {

using pack = mica::pack<float, 4>;

mica::shading_point<pack> point() {
    mica::shading_point<pack> p{};
    p.normal = {pack(0), pack(0), pack(1)};
    p.tangent = {pack(1), pack(0), pack(0)};
    p.wo = {pack(0), pack(0.6F), pack(0.8F)};
    p.derivatives = {pack(0.01F), pack(0), pack(0), pack(0.02F)};
    return p;
}

template <class Law>
void expect_counts(Law law) {
    mica::uniform_stream<pack> xi{1, mica::index_of<pack>(2)};
    const auto counts = law(pack(20), pack(0.25F), xi);
    const auto several = mica::multinomial<2, Law>{}(pack(20), std::array{pack(0.25F), pack(0.5F)}, xi);
    for (int i = 0; i < 4; ++i) {
        EXPECT_FLOAT_EQ(lane(counts.successes, i) + lane(counts.failures, i), 20);
        EXPECT_LE(lane(several[0] + several[1], i), 20.001F);
    }
}

TEST(PackLast, Laws) {
    expect_counts(mica::exact_binomial{});
    expect_counts(mica::dual_gated_binomial{});
    expect_counts(mica::quantile_binomial<4>{});
    expect_counts(mica::smooth_quantile_binomial<4>{});
}

TEST(PackLast, LightsAndKernels) {
    const mica::microfacet_table table;
    const auto p = point();
    const mica::ggx<pack> facets{pack(0.3F), pack(0.2F)};
    const auto shade = [&](const auto& light) {
        const auto seen = respond(light, p, facets, {1, 1, 1}, table);
        const std::array<mica::light_class<pack>, 1> classes{{{seen.smooth, seen.probability}}};
        const auto radiance =
            mica::glint_kernel<mica::quantile_binomial<4>>{}(p, mica::glint_material{}, classes, seen.half_vector, 1U);
        for (int i = 0; i < 4; ++i) {
            EXPECT_GT(lane(seen.probability, i), 0);
            EXPECT_GT(lane(radiance.smooth.g, i), 0);
            EXPECT_GE(lane(radiance.glint.g, i), 0);
        }
    };
    shade(mica::directional_light{{0, -0.6F, 0.8F}, {1, 1, 1}});
    shade(mica::sun_light{{0, -0.6F, 0.8F}, {1, 1, 1}});
    shade(mica::rectangle_light{{0, -3, 4}, {-1, 0, 0}, {0, 0.8F, 0.6F}, {1, 1, 1}});
    shade(mica::disk_light{{0, -3, 4}, {0, 0.6F, -0.8F}, 1, {1, 1, 1}});

    const mica::environment_map white(64, 32, std::vector<mica::rgb<float>>(64 * 32, {1, 1, 1}));
    const std::array roughness{0.3F};
    const mica::prefiltered_classes<2> sky(white, mica::environment_classes<2>::by_brightness(white), roughness);
    mica::glint_material material;
    material.roughness = 0.3F;
    const auto lit = mica::shade(mica::glint_kernel<mica::quantile_binomial<4>>{}, p, material, sky, table, 1U);
    EXPECT_GT(lane(lit.smooth.g, 3), 0);
}

} // namespace
