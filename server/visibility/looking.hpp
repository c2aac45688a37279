#pragma once

#include <algorithm>

namespace iwalk {

// Decides, for one block from frame to frame, whether finding out what is hidden is likely to spare more
// than it costs. What was hidden when it was last looked says how much there is to be spared; before that,
// and where much more or much less is in view than then, all may be hidden. Where looking does not pay it is
// tried again after 2 frames, then after 4, 8, and then every 16: so trying costs little, and a single frame
// does not decide for long.
class Looking {
  public:
    // For a frame with so many triangles in view; `cost`: of looking, in triangles drawn.
    bool pays(double triangles, double cost) {
        if (triangles < cost) return false;
        const bool known = triangles_ > 0 && triangles < 1.5 * triangles_ && 1.5 * triangles > triangles_;
        if (!known || share_ * triangles >= cost) return true;
        return ++framesWithout_ > patience_;
    }

    // It was looked, and so many of the triangles in view were hidden.
    void looked(double hidden, double triangles, double cost) {
        share_ = triangles > 0 ? hidden / triangles : 0;
        triangles_ = triangles;
        patience_ = hidden >= cost ? 1 : std::min(2 * patience_, kMostPatience);
        framesWithout_ = 0;
    }

  private:
    static constexpr unsigned kMostPatience = 16;  // frames
    double share_ = 1;                             // hidden of those in view, when it was last looked
    double triangles_ = 0;                         // in view then
    unsigned patience_ = 1, framesWithout_ = 0;    // frames
};

}  // namespace iwalk
