#pragma once

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <mutex>
#include <optional>

#include "common/result.hpp"

namespace iwalk {

// The first error that any of several threads has come to.
class FirstError {
  public:
    bool any() const { return any_; }
    void add(const Result<void>& result) {
        if (result) return;
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = result.error();
        any_ = true;
    }
    Result<void> result() const { return error_ ? Result<void>(*error_) : Result<void>(); }

  private:
    std::atomic<bool> any_ = false;
    std::mutex mutex_;
    std::optional<Error> error_;
};

// Calls work(i) for i in [begin, end) on all threads of the arena, in order as far as threads go; stops at
// the first error.
template <class Work>
Result<void> parallelFor(tbb::task_arena& arena, std::size_t begin, std::size_t end, Work work) {
    std::atomic<std::size_t> next = begin;
    FirstError error;
    const auto loop = [&](int) {
        for (std::size_t i = next++; i < end && !error.any(); i = next++) error.add(work(i));
    };
    arena.execute([&] { tbb::parallel_for(0, arena.max_concurrency(), loop); });
    return error.result();
}

// Calls work(i) likewise, and after it finish(i), one at a time and in order; only a few of them are under
// way at once. No thread waits for the others' work but at the end.
template <class Work, class Finish>
Result<void> orderedFor(tbb::task_arena& arena, std::size_t begin, std::size_t end, Work work,
                        Finish finish) {
    std::size_t next = begin;
    FirstError error;
    const auto take = [&](tbb::flow_control& control) {
        if (next == end || error.any()) control.stop();
        return next++;
    };
    const auto attempt = [&](auto& call, std::size_t i) {
        if (!error.any()) error.add(call(i));
    };
    using tbb::filter_mode, tbb::make_filter;
    const auto filters = make_filter<void, std::size_t>(filter_mode::serial_in_order, take) &
                         make_filter<std::size_t, std::size_t>(
                             filter_mode::parallel, [&](std::size_t i) { return attempt(work, i), i; }) &
                         make_filter<std::size_t, void>(filter_mode::serial_in_order,
                                                        [&](std::size_t i) { attempt(finish, i); });
    const std::size_t atOnce = 4 * static_cast<std::size_t>(arena.max_concurrency());
    arena.execute([&] { tbb::parallel_pipeline(atOnce, filters); });
    return error.result();
}

}  // namespace iwalk
