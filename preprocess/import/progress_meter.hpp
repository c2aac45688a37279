#pragma once

#include <algorithm>
#include <cstdint>

#include "preprocess/import/importer.hpp"

namespace iwalk {

// Calls a progress sink every 4 MiB of a file's bytes [begin, end).
class ProgressMeter {
  public:
    ProgressMeter(const ProgressSink& sink, std::uint64_t begin, std::uint64_t end)
        : sink_(sink), begin_(begin), end_(end), next_(begin + kStep) {}

    void at(std::uint64_t offset) {
        if (offset < next_) return;
        next_ = offset + kStep;
        if (!sink_ || end_ <= begin_) return;
        const double part = static_cast<double>(offset - begin_) / static_cast<double>(end_ - begin_);
        sink_(std::min(part, 1.0));
    }
    void done() const {
        if (sink_) sink_(1);
    }

  private:
    static constexpr std::uint64_t kStep = std::uint64_t{4} << 20;  // bytes
    const ProgressSink& sink_;
    std::uint64_t begin_, end_, next_;
};

}  // namespace iwalk
