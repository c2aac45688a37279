#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

// An OpenGL 4.5 core context, current on the thread that made it until it is destroyed.
class GlContext {
  public:
    // Ranks of one host share its GPUs in turn: `localRank` counts them, and the first GPU takes rank 0.
    static Result<std::unique_ptr<GlContext>> createHeadless(std::size_t localRank = 0);
    virtual ~GlContext() = default;

    virtual std::string renderer() const;  // the GL's name for the log
};

// Of `devices` that say whether they are GPUs, the order in which a rank tries them: GPUs first, its own
// before all others; then the rest.
std::vector<std::size_t> deviceOrder(const std::vector<bool>& gpus, std::size_t localRank);

}  // namespace iwalk
