// Returns 0 if mica works in two translation units of somebody else's project.
#include <mica/mica.hpp>

float failures_of_another_unit(float trials, float probability);

int main() {
    mica::uniform_stream<float> xi{7, 7};
    const auto outcome = mica::exact_binomial{}(100.F, 0.25F, xi);
    return outcome.failures == failures_of_another_unit(100.F, 0.25F) ? 0 : 1;
}
