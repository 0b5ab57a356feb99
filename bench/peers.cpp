// bench/peers.cpp: what one would take instead: std::binomial_distribution, Boost.Random, GSL.
//
// They draw exactly, for integer trials, from a sequential generator, and set up each distribution when its parameters
// change. Multinomials are chains of their binomials, and gsl_ran_multinomial. Boost's fastest good engine for these
// is taus88; mt19937 stands beside it. GSL's generators are called through a pointer; gsl_rng_taus is its fastest.
#include <random>

// Boost 1.74 is included as a system library: its own warnings are its own.
#include <boost/random/binomial_distribution.hpp>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/taus88.hpp>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include "suites.hpp"

namespace {

using streams::measure;

/// A distribution of the standard's kind, made anew for each draw.
template <class Distribution, class Generator>
struct distribution_peer {
    Generator generator;
    std::int64_t operator()(std::int64_t trials, double probability) {
        return Distribution(trials, probability)(generator);
    }
};

using boost_binomial = boost::random::binomial_distribution<std::int64_t>;
using boost_taus88 = distribution_peer<boost_binomial, boost::random::taus88>;
using boost_mt19937 = distribution_peer<boost_binomial, boost::random::mt19937>;
using std_mt19937 = distribution_peer<std::binomial_distribution<std::int64_t>, std::mt19937>;

struct free_generator {
    void operator()(gsl_rng* generator) const { gsl_rng_free(generator); }
};

struct gsl_taus {
    std::shared_ptr<gsl_rng> generator{gsl_rng_alloc(gsl_rng_taus), free_generator{}};
    std::int64_t operator()(std::int64_t trials, double probability) {
        return gsl_ran_binomial(generator.get(), probability, static_cast<unsigned>(trials));
    }
};

template <class Peer>
void register_peer(const std::string& name, Peer peer, float most_trials) {
    const auto draw = [peer](float trials, float probability, std::size_t) mutable {
        return peer(static_cast<std::int64_t>(trials), static_cast<double>(probability));
    };
    streams::measure_each("mixed/" + name, streams::mixed(), draw);
    for (const auto& [at, stream] : suites::curve_points())
        if (stream.trials[0] <= most_trials) streams::measure_each(at + name, stream, draw);
}

/// Conditional binomials, one category after the other.
template <class Peer>
void register_chain(const std::string& name, std::size_t categories, Peer peer) {
    measure("multinomial_" + std::to_string(categories) + "/" + name, streams::size,
            [stream = streams::mixed_multinomial(categories), counts = std::vector<std::int64_t>(categories),
             peer]() mutable {
                for (std::size_t i = 0; i < streams::size; ++i) {
                    auto left = static_cast<std::int64_t>(stream.trials[i]);
                    double share = 1;
                    for (std::size_t k = 0; k + 1 < counts.size(); ++k) {
                        const auto p = static_cast<double>(stream.probabilities[k][i]);
                        counts[k] = left > 0 ? peer(left, (std::min)(1., p / share)) : 0;
                        left -= counts[k];
                        share -= p;
                    }
                    counts.back() = left;
                    benchmark::DoNotOptimize(counts.data());
                    benchmark::ClobberMemory();
                }
            });
}

void register_gsl_multinomial(std::size_t categories) {
    measure("multinomial_" + std::to_string(categories) + "/gsl_ran_multinomial", streams::size,
            [stream = streams::mixed_multinomial(categories), counts = std::vector<unsigned>(categories),
             p = std::vector<double>(categories), gsl = gsl_taus{}]() mutable {
                for (std::size_t i = 0; i < streams::size; ++i) {
                    for (std::size_t k = 0; k < p.size(); ++k) p[k] = static_cast<double>(stream.probabilities[k][i]);
                    gsl_ran_multinomial(gsl.generator.get(), p.size(), static_cast<unsigned>(stream.trials[i]),
                                        p.data(), counts.data());
                    benchmark::DoNotOptimize(counts.data());
                    benchmark::ClobberMemory();
                }
            });
}

} // namespace

void suites::register_peers() {
    register_peer("boost", boost_taus88{}, 1e12F);
    register_peer("boost_mt19937", boost_mt19937{}, 1e12F);
    register_peer("std", std_mt19937{}, 1e12F);
    register_peer("gsl", gsl_taus{}, 1e9F); // trials are unsigned int
    for (const std::size_t categories : {2U, 4U, 8U, 16U}) {
        register_chain("boost", categories, boost_taus88{});
        register_chain("std", categories, std_mt19937{});
        register_chain("gsl", categories, gsl_taus{});
        register_gsl_multinomial(categories);
    }
}
