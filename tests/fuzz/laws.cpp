// Any bits as trials and probabilities, any uniforms of (0,1), to every law, scalar and in packs: results are finite, in
// [0, ceil N], integers where the law counts them, and those of a lane are those of a scalar.
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include <mica/law/multinomial.hpp>
#include <mica/numeric/pack.hpp>
#include <mica/random/uniform_stream.hpp>

#include "../law_names.hpp"
#include "input.hpp"

namespace {

using every_law =
    std::tuple<mica::gaussian_binomial, mica::bernoulli_sum_binomial, mica::floored_gated_binomial,
               mica::gated_binomial, mica::dual_gated_binomial, mica::basic_dual_gated_binomial<mica::naive_gate>,
               mica::basic_dual_gated_binomial<mica::scaled_gate>, mica::quantile_binomial<1>,
               mica::quantile_binomial<4>, mica::quantile_binomial<16>, mica::smooth_quantile_binomial<4>,
               mica::exact_binomial>;

/// Uniforms of the input's bits, some as they are where they lie in (0,1); a few, then random ones, since a rejection that
/// meets the same bad uniform for ever never ends.
template <class Real>
class scripted_uniforms {
  public:
    explicit scripted_uniforms(input& bytes) : go_on_(bytes.take<std::uint32_t>()) {
        for (Real& u : script_) u = bytes.take<Real>();
    }

    Real operator()() {
        if (next_ < script_.size()) {
            const Real u = script_[next_++];
            if (u > 0 && u < 1) return u;
        }
        return go_on_();
    }

  private:
    std::array<Real, 8> script_{};
    std::size_t next_ = 0;
    mica::uniform_stream<Real> go_on_;
};

/// ceil(N) as a law sees N.
template <class Real>
Real most_counts(Real trials) {
    return std::isnan(trials) || trials < 0 ? 0 : std::ceil((std::min)(trials, std::numeric_limits<Real>::max()));
}

template <class Real>
constexpr Real all_counted = 1 / std::numeric_limits<Real>::epsilon();

/// The published floored law counts all trials only where they are an integer.
template <class Law>
constexpr bool counts_all_trials = Law::integer_counts;
template <class Gate>
constexpr bool counts_all_trials<mica::basic_floored_gated_binomial<Gate>> = false;

template <class Law, class Real>
void require_support(Real trials, Real probability, Real successes, Real failures) {
    const Real most = std::isnan(probability) ? 0 : most_counts(trials);
    for (const Real count : {successes, failures}) {
        require(count >= 0, "a count is at least 0", static_cast<double>(trials), static_cast<double>(probability));
        require(count <= most, "a count is at most ceil(N)", static_cast<double>(trials),
                static_cast<double>(probability));
    }
    if (!(counts_all_trials<Law> || trials == std::floor(trials)) || !Law::integer_counts) return;
    for (const Real count : {successes, failures})
        require(count == std::floor(count), "an integer law counts integers", static_cast<double>(trials),
                static_cast<double>(probability));
    if (most == 0 || most > all_counted<Real>) return;
    const Real sum = successes + failures;
    require(sum == most || sum == std::floor(trials), "all trials count", static_cast<double>(trials),
            static_cast<double>(probability));
}

template <class Law, class Real, int Lanes>
void draw(input bytes) {
    using Pack = mica::pack<Real, Lanes>;
    Pack trials(0), probability(0);
    for (int i = 0; i < Lanes; ++i) {
        trials.set(i, bytes.take<Real>());
        probability.set(i, bytes.take<Real>());
    }
    const auto seed = bytes.take<std::uint32_t>();
    const auto drawn = Law{}(trials, probability,
                             mica::uniform_stream<Pack>{mica::index_of<Pack>(seed), mica::index_of<Pack>::iota(0U)});
    for (int i = 0; i < Lanes; ++i) {
        const auto alone =
            Law{}(trials[i], probability[i], mica::uniform_stream<Real>{seed, static_cast<std::uint32_t>(i)});
        require_support<Law>(trials[i], probability[i], alone.successes, alone.failures);
        require(same_bits(drawn.successes[i], alone.successes) && same_bits(drawn.failures[i], alone.failures),
                "a lane is a scalar", static_cast<double>(drawn.successes[i]), static_cast<double>(alone.successes));
        const auto scripted = Law{}(trials[i], probability[i], scripted_uniforms<Real>(bytes));
        require_support<Law>(trials[i], probability[i], scripted.successes, scripted.failures);
    }

    // Categories: the lanes' probabilities as they come.
    std::array<Real, Lanes> probabilities;
    for (std::size_t k = 0; k < Lanes; ++k) probabilities[k] = probability[static_cast<int>(k)];
    const auto counts = mica::multinomial<Lanes, Law>{}(trials[0], probabilities, mica::uniform_stream<Real>{seed});
    Real sum = 0;
    for (const Real count : counts) {
        require(count >= 0 && count <= most_counts(trials[0]), "a category's count is in [0, ceil N]",
                static_cast<double>(trials[0]), static_cast<double>(count));
        sum += count;
    }
    if (counts_all_trials<Law> && most_counts(trials[0]) <= all_counted<Real>)
        require(sum <= most_counts(trials[0]), "the counts sum to no more than N", static_cast<double>(trials[0]),
                static_cast<double>(sum));
}

template <std::size_t... I>
void draw_with(std::uint32_t law, const input& bytes, std::index_sequence<I...>) {
    const auto draw_law = [&]<std::size_t Law>() {
        draw<std::tuple_element_t<Law, every_law>, float, 4>(bytes);
        draw<std::tuple_element_t<Law, every_law>, double, 2>(bytes);
    };
    ((law == I ? draw_law.template operator()<I>() : void()), ...);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    input bytes(data, size);
    const auto law = bytes.below(std::tuple_size_v<every_law>);
    draw_with(law, bytes, std::make_index_sequence<std::tuple_size_v<every_law>>{});
    return 0;
}
