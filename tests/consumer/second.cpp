#include <mica/mica.hpp>

float failures_of_another_unit(float trials, float probability) {
    mica::uniform_stream<float> xi{7, 7};
    return mica::exact_binomial{}(trials, probability, xi).failures;
}
