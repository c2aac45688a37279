#pragma once

#include <vector>

#include "server/visibility/screen_box.hpp"
#include "server/visibility/workers.hpp"

namespace iwalk {

// Hierarchical Z (Greene, Kass, Miller 1993): for squares of 1, 2, 4, ... px the farthest depth in them.
// Depths are reversed, so the farthest is the least.
class DepthPyramid {
  public:
    // `depths`: of the pixels (0, 0) to (width, height), row by row; what they were the last time is given
    // back, to be filled again. Later questions must stay within them.
    void build(std::vector<float>& depths, int width, int height, Workers& workers);

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

    std::vector<Level> levels_;  // from squares of 1 px on
};

}  // namespace iwalk
