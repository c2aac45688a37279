#pragma once

#include <functional>
#include <vector>

#include "server/visibility/screen_box.hpp"

namespace iwalk {

// Hierarchical Z (Greene, Kass, Miller 1993): for squares of 1, 2, 4, ... px the farthest depth in them.
// Depths are reversed, so the farthest is the least.
class DepthPyramid {
  public:
    // Writes the depths of rows [first, first + rows), one row after another.
    using ReadRows = std::function<void(int first, int rows, float* depths)>;
    // Of the pixels (0, 0) to (width, height), in which later questions must stay. Reads some rows at a time,
    // and makes their squares while they are in the processor's cache.
    void build(int width, int height, const ReadRows& read);

    // Whether all pixels of the box are strictly nearer than it. Exact to the pixel; the pyramid only makes
    // it fast.
    bool hides(const ScreenBox& box) const;

    // About how many pixels of the box are not strictly nearer than it: counted in 16 rows at the most.
    float openPixels(const ScreenBox& box) const;

  private:
    struct Level {
        int width = 0, height = 0;  // in squares
        std::vector<float> farthest;
    };
    bool hides(const ScreenBox& box, int level) const;
    void halve(std::size_t level, int first, int end);

    std::vector<Level> levels_;  // from squares of 1 px on
};

}  // namespace iwalk
