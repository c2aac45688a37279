#pragma once

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <mutex>
#include <optional>

#include "common/result.hpp"

namespace iwalk {

// Calls work(i) for i in [begin, end) on all threads of the arena, in order as far as threads go; stops at
// the first error.
template <class Work>
Result<void> parallelFor(tbb::task_arena& arena, std::size_t begin, std::size_t end, Work work) {
    std::atomic<std::size_t> next = begin;
    std::mutex mutex;
    std::optional<Error> first;
    const auto loop = [&](int) {
        for (std::size_t i = next++; i < end; i = next++) {
            Result<void> result = work(i);
            if (result) continue;
            next = end;
            const std::lock_guard lock(mutex);
            if (!first) first = result.error();
        }
    };
    arena.execute([&] { tbb::parallel_for(0, arena.max_concurrency(), loop); });
    if (first) return *first;
    return {};
}

}  // namespace iwalk
