// Progress of long work: a line that counts up on a terminal, nothing in a pipe.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdio>
#include <string>

#include <unistd.h>

namespace glint {

class progress {
  public:
    progress(std::string label, std::size_t steps)
        : label_(std::move(label)), steps_(steps), shown_(isatty(STDERR_FILENO) == 1) {}
    ~progress() {
        if (shown_) std::fprintf(stderr, "\r\033[K");
    }
    progress(const progress&) = delete;
    progress& operator=(const progress&) = delete;

    /// One step done; from any thread.
    void advance() {
        const std::size_t done = ++done_;
        if (shown_ && 100 * done / steps_ != 100 * (done - 1) / steps_)
            std::fprintf(stderr, "\r%s %3zu %%", label_.c_str(), 100 * done / steps_);
    }

  private:
    std::string label_;
    std::size_t steps_;
    bool shown_;
    std::atomic<std::size_t> done_ = 0;
};

} // namespace glint
