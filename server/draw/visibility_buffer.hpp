#pragma once

#include <cstdint>
#include <vector>

#include "common/result.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// For each pixel of a block the nearest triangle's number and its depth, in two layers. What is drawn in
// order goes into the first. What is drawn later but may belong before it goes into the second, which begins
// with the first one's depths, each moved one float away: so a pixel has a number in the second layer exactly
// where something was drawn that is as near as the first layer or nearer, and equal depths can be told
// (shading).
class VisibilityBuffer {
  public:
    VisibilityBuffer() = default;
    ~VisibilityBuffer();
    VisibilityBuffer(const VisibilityBuffer&) = delete;
    VisibilityBuffer& operator=(const VisibilityBuffer&) = delete;

    // px: the largest block.
    Result<void> prepare(int width, int height);
    // Whether programs may count in an image of 32-bit integers (kCountsBinding).
    void setCounts(bool counts);

    void clear();          // nothing drawn; one layer
    void beginRest();      // goes on in the second layer; wants the block's viewport and the depth test
    void forgetNumbers();  // but not depths
    bool hasRest() const { return rest_; }

    void bind() const;            // for drawing
    void bindForShading() const;  // texture units 0 to 3: numbers, depths, and those of the second layer

    // The pixels of a part of the block, row by row, as drawn so far.
    void readDepths(const PixelRect& part, float* depths) const;
    // Appends the depths of some of these rows.
    void sampleDepths(const PixelRect& part, std::vector<float>& depths) const;
    // The second layer's number where it has one, even where equal depths say otherwise.
    void readNumbers(const PixelRect& part, std::vector<std::uint32_t>& numbers) const;

  private:
    struct Layer {
        std::uint32_t framebuffer = 0, numbers = 0, depths = 0;  // GL names
    };
    Result<void> prepare(Layer& layer, int width, int height);

    Layer layers_[2];
    int width_ = 0, height_ = 0;                                   // px
    std::uint32_t restProgram_ = 0, emptyArray_ = 0, counts_ = 0;  // GL names; 0: no counts
    bool rest_ = false;
};

}  // namespace iwalk
