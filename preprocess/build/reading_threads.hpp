#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

namespace iwalk {

// The threads that read: what may hand work to others runs among them, and ends before they do.
class ReadingThreads {
  public:
    explicit ReadingThreads(unsigned threads)
        : control_(tbb::global_control::max_allowed_parallelism, threads),
          arena_(static_cast<int>(threads)) {}

    // Returns what `work()` does. The calling thread is the leading one.
    template <class Work>
    auto lead(Work work) {
        return arena_.execute(work);
    }

  private:
    tbb::global_control control_;  // more threads than cores, too
    tbb::task_arena arena_;
};

}  // namespace iwalk
