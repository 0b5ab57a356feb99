// Any text as the parameters of a std-style distribution: it is read to the last number or changes nothing, what is read can
// be drawn from, and what is written is read again as the same.
#include <random>
#include <sstream>

#include <mica/law/binomial_distribution.hpp>
#include <mica/law/multinomial_distribution.hpp>

#include "input.hpp"

namespace {

template <class Distribution>
void read_and_write(const std::string& text, Distribution& read) {
    const Distribution before = read;
    std::istringstream in(text);
    if (!(in >> read)) require(read == before, "a failed read changes nothing");
    std::stringstream copy;
    copy << read;
    Distribution again;
    copy >> again;
    require(again == read, "what is written is read again");
}

template <class Int>
void draw(const std::string& text) {
    std::minstd_rand generator(1);
    mica::binomial_distribution<Int> binomial(7, 0.25);
    read_and_write(text, binomial);
    const Int count = binomial(generator);
    require(count >= 0 && count <= binomial.t(), "a count is in [0, t]", static_cast<double>(count));

    mica::multinomial_distribution<Int> multinomial(7, {0.25, 0.5});
    read_and_write(text, multinomial);
    double sum = 0;
    for (const Int one : multinomial(generator)) {
        require(one >= 0, "a count is at least 0", static_cast<double>(one));
        sum += static_cast<double>(one);
    }
    require(sum <= static_cast<double>(multinomial.t()), "counts sum to at most t", sum);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text = input(data, size).rest();
    draw<long long>(text);
    draw<short>(text);
    return 0;
}
