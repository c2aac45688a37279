#pragma once

#include <cstdint>
#include <memory>

#include "common/result.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// A projector's part of the picture: pixels that neighbours show as well are dimmed, so that the light of all
// who show one adds up to the picture's. Across an overlap a tile's part grows evenly from 0 to 1. Values are
// rounded to 8 bits in turn, the larger part first, and each later one makes up for what rounding has left:
// so the sum is within 1/255 of full light for any value and any gamma up to 3. Needs a current GL context.
class BlendPass {
  public:
    // For tiles of width x height px.
    static Result<std::unique_ptr<BlendPass>> create(int width, int height, const Blend& blend);
    virtual ~BlendPass() = default;

    // From one RGBA8 texture, row 0 on top, to another, which is the pass's own.
    virtual std::uint32_t apply(std::uint32_t drawn) = 0;
};

}  // namespace iwalk
