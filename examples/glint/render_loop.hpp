// Rows side by side, and how long they take.
#pragma once

#include <chrono>
#include <cstddef>

#include <tbb/parallel_for.h>

#include "progress.hpp"

namespace glint {

/// Runs the rows of a loop side by side, with progress under a label.
struct parallel_loop {
    const char* label;

    template <class Body>
    void operator()(std::size_t count, const Body& body) const {
        progress reporter(label, count);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
            body(i);
            reporter.advance();
        });
    }
};

/// Seconds on the wall since it was made.
class stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

} // namespace glint
