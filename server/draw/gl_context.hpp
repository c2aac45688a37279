#pragma once

#include <memory>
#include <string>

#include "common/result.hpp"

namespace iwalk {

// An OpenGL 4.5 core context without a display, current on the thread that made it until it is destroyed.
class GlContext {
  public:
    static Result<std::unique_ptr<GlContext>> createHeadless();
    virtual ~GlContext() = default;

    virtual std::string renderer() const = 0;  // the GL's name for the log
};

}  // namespace iwalk
