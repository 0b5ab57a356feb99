// What laws and their peers cost, in one program, for one run: ratios are to be read, not nanoseconds.
//
//     build/gcc/bench/mica_benchmark --benchmark_filter=mixed/
//
// Suites: mixed (parameters fresh for every draw, batches), mixed_scalar, fixed, trials and mean (cost along N and N p),
// multinomial_K, gate, grid (a pixel by counts and by variates), shade (a pixel with its light), prefilter (a changing environment). The same with AVX2 and AVX-512: mica_benchmark_avx2, mica_benchmark_avx512.
#include "suites.hpp"

int main(int argc, char** argv) {
    suites::register_laws();
    suites::register_peers();
    suites::register_grids();
    suites::register_shade();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
