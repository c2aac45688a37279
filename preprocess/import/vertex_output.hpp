#pragma once

#include <cmath>
#include <vector>

#include "preprocess/import/importer.hpp"

namespace iwalk {

inline bool isFinite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Hands finite positions on to a sink in batches and keeps count of them: what a scan does that keeps nothing
// else.
class VertexOutput {
  public:
    explicit VertexOutput(const VertexSink& sink) : sink_(sink) { batch_.reserve(kBatch); }

    void add(const glm::dvec3& position) {
        if (!isFinite(position)) return;
        bounds_.add(position);
        batch_.push_back(position);
        if (batch_.size() == kBatch) flush();
    }
    // Hands on what is left, and says what came. Call at the end.
    void finish(ImportSummary& summary) {
        flush();
        summary.vertices = count_;
        summary.bounds = bounds_;
    }

  private:
    void flush() {
        count_ += batch_.size();
        if (sink_ && !batch_.empty()) sink_(batch_);
        batch_.clear();
    }

    static constexpr std::size_t kBatch = 4096;
    const VertexSink& sink_;
    std::vector<glm::dvec3> batch_;
    std::uint64_t count_ = 0;
    ModelBox bounds_;
};

}  // namespace iwalk
