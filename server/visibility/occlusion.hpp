#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/visibility/screen_box.hpp"

namespace iwalk {

// Answers 'hidden?' for boxes, against what has been drawn of a block.
class Occlusion {
  public:
    virtual ~Occlusion() = default;

    // From here on the depth counts that has been drawn so far. What is drawn later makes no answer wrong: a
    // surface only comes nearer.
    virtual void update() = 0;

    // hidden[i] becomes 1 when no pixel of boxes[i] can show anything of it: what is drawn there is strictly
    // nearer. 0 may also mean 'not known'. Empty boxes are hidden.
    virtual void hidden(std::span<const ScreenBox> boxes, std::vector<std::uint8_t>& hidden) = 0;
};

}  // namespace iwalk
