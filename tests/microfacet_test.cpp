// The microfacet terms against quadrature that does not know their closed forms: integrals over log(theta), azimuths by
// bisection on the reflected ray itself, albedo by sampling D n.h instead of visible normals.

#include <cmath>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include <mica/shade/microfacet.hpp>

namespace {

using vector = mica::vector3<double>;

constexpr double pi = 3.14159265358979323846;

/// Integral of f over theta from low to high: midpoint rule in x, log(theta) = middle - half cos(x). The logarithm
/// because GGX is a peak as narrow as alpha, the cosine because it removes square-root ends.
template <class Integrand>
double integral(double low, double high, int nodes, const Integrand& f) {
    const double log_low = std::log(std::fmax(low, 1e-9)), log_high = std::log(std::fmax(high, 1e-9));
    const double half = (log_high - log_low) / 2;
    double sum = 0;
    for (int i = 0; i < nodes; ++i) {
        const double x = pi * (i + 0.5) / nodes;
        const double theta = std::exp(log_low + half * (1 - std::cos(x)));
        sum += f(theta) * theta * half * std::sin(x);
    }
    return sum * pi / nodes;
}

template <class Integrand>
double over_polar_angles(int nodes, const Integrand& f) {
    return integral(0, pi / 2, nodes, f);
}

double facets_at(double theta, double alpha) {
    return 2 * pi * mica::ggx_distribution(std::cos(theta), alpha) * std::sin(theta);
}

constexpr double roughnesses[] = {0.001, 0.01, 0.03, 0.1, 0.25, 0.5, 0.8, 0.999, 1};

// --- D, D_H -----------------------------------------------------------------------------------------------------

TEST(GgxDistribution, ProjectedFacetAreaIsOne) {
    for (const double alpha : roughnesses) {
        const double area =
            over_polar_angles(20000, [alpha](double theta) { return facets_at(theta, alpha) * std::cos(theta); });
        EXPECT_NEAR(area, 1, 1e-6) << alpha;
    }
}

TEST(GgxDistribution, Ends) {
    // At n.h = 1, 1 / (pi alpha^2); at grazing, alpha^2 / pi; constant at alpha = 1.
    EXPECT_NEAR(mica::ggx_distribution(1., 0.1), 100 / pi, 1e-9);
    EXPECT_NEAR(mica::ggx_distribution(0., 0.1), 0.01 / pi, 1e-12);
    EXPECT_NEAR(mica::ggx_distribution(0.3, 1.), 1 / pi, 1e-12);
    for (const float n_dot_h : {0.F, 0.5F, 0.999999F, 1.F, 1.000001F})
        for (const float alpha : {0.F, 1e-30F, 1e-4F, 1.F}) {
            const float d = mica::ggx_distribution(n_dot_h, alpha);
            EXPECT_TRUE(std::isfinite(d) && d >= 0) << n_dot_h << ' ' << alpha;
        }
}

// In float, where cos^2 (alpha^2 - 1) + 1 has lost its digits for small alpha.
TEST(GgxDistribution, NoCancellationInFloat) {
    for (const float alpha : {1e-3F, 1e-2F, 0.1F, 1.F}) {
        const double exact = 1 / (pi * static_cast<double>(alpha) * static_cast<double>(alpha));
        EXPECT_NEAR(static_cast<double>(mica::ggx_distribution(1.F, alpha)) / exact, 1, 1e-6);
    }
}

TEST(TotalFacetArea, AgreesWithQuadrature) {
    for (const double alpha : roughnesses) {
        const double area = over_polar_angles(20000, [alpha](double theta) { return facets_at(theta, alpha); });
        EXPECT_NEAR(mica::total_facet_area(alpha), area, 1e-6) << alpha;
        const auto in_float = static_cast<double>(mica::total_facet_area(static_cast<float>(alpha)));
        EXPECT_NEAR(in_float / mica::total_facet_area(static_cast<double>(static_cast<float>(alpha))), 1, 2e-6)
            << alpha;
    }
}

TEST(TotalFacetArea, Ends) {
    EXPECT_NEAR(mica::total_facet_area(0.), 1, 1e-6);
    EXPECT_NEAR(mica::total_facet_area(1.), 2, 1e-12);
    EXPECT_EQ(mica::total_facet_area(2.), mica::total_facet_area(1.)); // roughness beyond 1 counts as 1
}

// Where the formula is 0/0 and a series takes over.
TEST(TotalFacetArea, SmoothNearOne) {
    for (int i = 0; i <= 2000; ++i) {
        const auto alpha = static_cast<float>(1 - i * 1e-6);
        const double slope = 4. / 3; // of D_H at 1
        EXPECT_NEAR(static_cast<double>(mica::total_facet_area(alpha)), 2 - slope * i * 1e-6, 4e-6) << alpha;
    }
}

// --- E_D --------------------------------------------------------------------------------------------------------

/// Whether a facet at (theta, phi) reflects the eye's ray to above the horizon.
bool reflects_upwards(double theta, double phi, const vector& wo) {
    const vector h{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    return mica::reflected(wo, h).z > 0;
}

/// Share of the azimuths at which facets at theta reflect upwards: they are those nearest the eye's.
double share_of_azimuths(double theta, const vector& wo) {
    if (!reflects_upwards(theta, 0, wo)) return 0;
    if (reflects_upwards(theta, pi, wo)) return 1;
    double inside = 0, outside = pi;
    for (int i = 0; i < 30; ++i) {
        const double middle = (inside + outside) / 2;
        (reflects_upwards(theta, middle, wo) ? inside : outside) = middle;
    }
    return (inside + outside) / (2 * pi);
}

/// In three parts, because the share has kinks half the view angle to both sides of 45 degrees.
double facets_in_view(double n_dot_v, double alpha) {
    const vector wo{std::sqrt(1 - n_dot_v * n_dot_v), 0, n_dot_v};
    const double half_view = std::acos(n_dot_v) / 2;
    const auto seen = [&](double theta) { return facets_at(theta, alpha) * share_of_azimuths(theta, wo); };
    return integral(0, pi / 4 - half_view, 2000, seen) + integral(pi / 4 - half_view, pi / 4 + half_view, 2000, seen) +
           integral(pi / 4 + half_view, pi / 2, 2000, seen);
}

TEST(VisibleFacetArea, AgreesWithQuadrature) {
    double worst = 0;
    for (const double n_dot_v : {0., 1e-4, 1e-3, 0.01, 0.05, 0.2, 0.5, 0.8, 0.99, 1.})
        for (const double alpha : {0.01, 0.03, 0.1, 0.25, 0.5, 0.8, 1.}) {
            const double error = std::abs(mica::visible_facet_area(n_dot_v, alpha) - facets_in_view(n_dot_v, alpha));
            EXPECT_LE(error, 3e-5) << n_dot_v << ' ' << alpha;
            worst = std::fmax(worst, error);
        }
    std::printf("largest error of E_D: %.2g\n", worst);
}

TEST(VisibleFacetArea, IsAPartOfAllFacets) {
    for (int i = 0; i <= 100; ++i)
        for (int j = 0; j <= 100; ++j) {
            const double n_dot_v = i / 100., alpha = j * j / 1e4;
            const double visible = mica::visible_facet_area(n_dot_v, alpha);
            EXPECT_TRUE(visible > 0 && visible <= mica::total_facet_area(alpha)) << n_dot_v << ' ' << alpha;
        }
}

TEST(VisibleFacetArea, Ends) {
    for (const double alpha : roughnesses)
        EXPECT_NEAR(mica::visible_facet_area(0., alpha), mica::total_facet_area(alpha) / 2, 5e-5) << alpha;
    // From above, the facets within 45 degrees; at alpha = 1 D is constant.
    EXPECT_NEAR(mica::visible_facet_area(1., 1.), 2 - std::sqrt(2.), 5e-5);
    EXPECT_NEAR(mica::visible_facet_area(0.5, 0.), 1, 5e-5); // a mirror's only facet
    for (const double n_dot_v : {-1., 2.})
        for (const double alpha : {-1., 2.}) EXPECT_TRUE(std::isfinite(mica::visible_facet_area(n_dot_v, alpha)));
}

// --- masking and Fresnel ----------------------------------------------------------------------------------------

TEST(Masking, IsAProbability) {
    for (int i = 0; i <= 50; ++i)
        for (int j = 0; j <= 50; ++j)
            for (const float alpha : {0.F, 1e-4F, 0.01F, 0.3F, 1.F}) {
                const float l = static_cast<float>(i) / 50, v = static_cast<float>(j) / 50;
                const float g = mica::ggx_masking_shadowing(l, v, alpha);
                EXPECT_TRUE(g >= 0 && g <= 1 + 1e-6F) << l << ' ' << v << ' ' << alpha;
                EXPECT_EQ(g, mica::ggx_masking_shadowing(v, l, alpha));
                const float g1 = mica::ggx_masking(v, alpha);
                EXPECT_TRUE(g1 >= 0 && g1 <= 1 + 1e-6F) << v << ' ' << alpha;
                EXPECT_LE(g, (std::min)(g1, mica::ggx_masking(l, alpha)) + 1e-6F);
            }
}

TEST(Masking, Ends) {
    EXPECT_EQ(mica::ggx_masking_shadowing(0.F, 0.5F, 0.5F), 0.F);
    EXPECT_EQ(mica::ggx_masking_shadowing(0.5F, -0.1F, 0.5F), 0.F);
    EXPECT_EQ(mica::ggx_masking(-0.1F, 0.5F), 0.F);
    EXPECT_NEAR(mica::ggx_masking(1.F, 0.7F), 1.F, 1e-6F);
    EXPECT_NEAR(mica::ggx_masking_shadowing(1.F, 1.F, 0.7F), 1.F, 1e-6F);
    EXPECT_NEAR(mica::ggx_masking_shadowing(0.3F, 0.2F, 0.F), 1.F, 1e-6F); // a mirror hides nothing
}

// What the eye sees of all facets is the surface: integral of D G1 (v.h)+ = n.v (Heitz 2014, Eq. 16).
TEST(Masking, ConservesTheVisibleArea) {
    for (const double n_dot_v : {0.05, 0.3, 0.8})
        for (const double alpha : {0.1, 0.4, 1.}) {
            const double sine = std::sqrt(1 - n_dot_v * n_dot_v);
            const double projected = over_polar_angles(3000, [&](double theta) {
                double sum = 0;
                for (int i = 0; i < 400; ++i) {
                    const double azimuth = 2 * pi * (i + 0.5) / 400;
                    const double cosine = sine * std::sin(theta) * std::cos(azimuth) + n_dot_v * std::cos(theta);
                    sum += std::fmax(0, cosine) / 400;
                }
                return facets_at(theta, alpha) * sum;
            });
            EXPECT_NEAR(projected * mica::ggx_masking(n_dot_v, alpha), n_dot_v, 1e-4) << n_dot_v << ' ' << alpha;
        }
}

TEST(SchlickFresnel, Ends) {
    for (const float f0 : {0.F, 0.04F, 0.9F, 1.F}) {
        EXPECT_EQ(mica::schlick_fresnel(f0, 1.F), f0);
        EXPECT_EQ(mica::schlick_fresnel(f0, 0.F), 1.F);
        EXPECT_EQ(mica::schlick_fresnel(f0, -1.F), 1.F);
        EXPECT_EQ(mica::schlick_fresnel(f0, 2.F), f0);
        EXPECT_FLOAT_EQ(mica::schlick_fresnel(f0, 0.5F), f0 + (1 - f0) / 32);
    }
}

// --- directional albedo -----------------------------------------------------------------------------------------

/// The larger of the two errors, NaN if either is.
double difference(mica::albedo_terms<double> a, mica::albedo_terms<double> b) {
    const double scale = std::abs(a.scale - b.scale), bias = std::abs(a.bias - b.bias);
    return std::isnan(scale) || scale > bias ? scale : bias;
}

/// E(f0) = f0 scale + bias, by sampling D n.h on a fine grid, uniform in the square root of the probability beyond
/// theta, where the steepest facets would otherwise be too few.
mica::albedo_terms<double> albedo_by_sampling_normals(double n_dot_v, double alpha, int strata) {
    const vector wo{std::sqrt(1 - n_dot_v * n_dot_v), 0, n_dot_v};
    mica::albedo_terms<double> sum{0, 0};
    for (int i = 0; i < strata; ++i)
        for (int j = 0; j < strata; ++j) {
            const double s = (i + 0.5) / strata, phi = pi * (j + 0.5) / strata; // one half: the other is its mirror
            const double theta = std::atan(alpha * std::sqrt(1 - s * s) / s);
            const vector h{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
            const double v_dot_h = mica::dot(wo, h);
            const double n_dot_l = mica::reflected(wo, h).z;
            if (!(v_dot_h > 0 && n_dot_l > 0)) continue;
            // f n.l / density = F G v.h / (n.v n.h)
            const double weight =
                2 * s * mica::ggx_masking_shadowing(n_dot_l, n_dot_v, alpha) * v_dot_h / (n_dot_v * h.z);
            const double fresnel = std::pow(1 - v_dot_h, 5);
            sum.scale += (1 - fresnel) * weight;
            sum.bias += fresnel * weight;
        }
    const double samples = static_cast<double>(strata) * strata;
    return {sum.scale / samples, sum.bias / samples};
}

TEST(DirectionalAlbedo, AgreesWithSampledNormals) {
    double worst = 0;
    for (const double n_dot_v : {0.02, 0.05, 0.1, 0.3, 0.6, 0.9, 1.})
        for (const double alpha : {0.01, 0.03, 0.1, 0.12, 0.25, 0.5, 0.8, 1.}) {
            const auto albedo = mica::directional_albedo_terms(n_dot_v, alpha);
            const auto truth = albedo_by_sampling_normals(n_dot_v, alpha, 500);
            const double error = difference(albedo, truth);
            EXPECT_LE(error, 3e-3) << n_dot_v << ' ' << alpha;
            worst = std::fmax(worst, error);
        }
    std::printf("largest error of the albedo terms: %.2g\n", worst);
}

TEST(DirectionalAlbedo, LiesBetweenZeroAndOne) {
    for (int i = 0; i <= 40; ++i)
        for (int j = 0; j <= 40; ++j) {
            const auto albedo = mica::directional_albedo_terms(i / 40., j / 40.);
            EXPECT_TRUE(albedo.scale >= 0 && albedo.bias >= 0 && albedo.scale + albedo.bias <= 1 + 1e-12)
                << i << ' ' << j;
        }
}

TEST(DirectionalAlbedo, OfAMirrorIsFresnel) {
    for (const double n_dot_v : {0.05, 0.2, 0.5, 1.}) {
        const auto albedo = mica::directional_albedo_terms(n_dot_v, 0.);
        EXPECT_NEAR(0.04 * albedo.scale + albedo.bias, mica::schlick_fresnel(0.04, n_dot_v), 2e-3) << n_dot_v;
        EXPECT_NEAR(albedo.scale + albedo.bias, 1, 2e-3) << n_dot_v; // a white mirror loses nothing
    }
}

// --- tables -----------------------------------------------------------------------------------------------------

const mica::microfacet_table& table() {
    static const mica::microfacet_table built;
    return built;
}

struct view {
    float n_dot_v, roughness;
};

/// Half of them uniform, half crowded towards grazing angles and mirrors.
class random_views {
  public:
    view operator()() {
        const double x = unit_(random_), y = unit_(random_);
        crowded_ = !crowded_;
        if (!crowded_) return {static_cast<float>(x), static_cast<float>(y)};
        return {static_cast<float>(std::pow(10, -4 * x)), static_cast<float>(std::pow(10, -4 * y))};
    }

  private:
    std::mt19937 random_{1};
    std::uniform_real_distribution<double> unit_{0, 1};
    bool crowded_ = false;
};

TEST(MicrofacetTable, VisibleFraction) {
    random_views random;
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto [n_dot_v, roughness] = random();
        const double mu = static_cast<double>(n_dot_v), alpha = static_cast<double>(roughness);
        const double fraction = static_cast<double>(table().visible_fraction(n_dot_v, roughness));
        const double error = std::abs(fraction - mica::visible_facet_area(mu, alpha) / mica::total_facet_area(alpha));
        ASSERT_LE(error, 5e-4) << n_dot_v << ' ' << roughness;
        worst = std::fmax(worst, error);
    }
    std::printf("largest interpolation error of E_D / D_H: %.2g\n", worst);
}

TEST(MicrofacetTable, Albedo) {
    random_views random;
    double worst = 0, worst_grazing = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto [n_dot_v, roughness] = random();
        const auto stored = table().albedo(n_dot_v, roughness);
        const auto truth = mica::directional_albedo_terms(static_cast<double>(n_dot_v), static_cast<double>(roughness));
        const double error = difference({static_cast<double>(stored.scale), static_cast<double>(stored.bias)}, truth);
        const bool grazing = n_dot_v < 0.05F && roughness < 0.01F;
        ASSERT_LE(error, grazing ? 5e-2 : 1e-2) << n_dot_v << ' ' << roughness;
        (grazing ? worst_grazing : worst) = std::fmax(grazing ? worst_grazing : worst, error);
    }
    std::printf("largest interpolation error of the albedo: %.2g, grazing and smooth: %.2g\n", worst, worst_grazing);
}

// So that probabilities need no clamp, and a surface returns no more light than it gets.
TEST(MicrofacetTable, StaysInRange) {
    for (int i = -2; i <= 202; ++i)
        for (int j = -2; j <= 202; ++j) {
            const float n_dot_v = static_cast<float>(i) / 200, roughness = static_cast<float>(j) / 200;
            const float visible = table().visible_fraction(n_dot_v, roughness);
            EXPECT_TRUE(visible > 0 && visible <= 1) << n_dot_v << ' ' << roughness;
            const auto albedo = table().albedo(n_dot_v, roughness);
            EXPECT_TRUE(albedo.scale >= 0 && albedo.bias >= 0 && albedo.scale + albedo.bias <= 1 + 1e-6F);
        }
}

} // namespace
