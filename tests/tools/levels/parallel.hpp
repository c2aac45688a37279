#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace iwalk::levels {

// Calls task(begin, end) for parts of [0, count), one on each of `threads` threads (0: one for each core).
template <class Task>
void forParts(std::size_t count, unsigned threads, const Task& task) {
    const std::size_t parts = threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::jthread> workers;
    for (std::size_t i = 0; i < parts; ++i)
        workers.emplace_back([&, i] { task(count * i / parts, count * (i + 1) / parts); });
}

}  // namespace iwalk::levels
