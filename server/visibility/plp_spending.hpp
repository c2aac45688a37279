#pragma once

#include <cstdint>
#include <vector>

#include "server/visibility/depth_pyramid.hpp"
#include "server/visibility/workers.hpp"

namespace iwalk {

// Spends a budget of triangles on the ranges of a block (`--mode plp`). What rays say is a guess, and what
// was drawn already tells more: how many pixels of a range's box are not nearer. So the budget is spent in
// steps, with a look at the depth between two of them; what is hidden is left out, and the next step goes by
// those pixels per triangle.
class PlpSpending {
  public:
    struct Range {
        std::uint32_t number = 0;     // the caller's
        std::uint32_t triangles = 0;  // what it costs; 0: it is paid for
        ScreenBox box;                // not empty
    };
    struct Taken {
        std::uint32_t number = 0;
        float spent = 0;  // of what can be spent, before it: [0, 1)
    };

    // `ranges` by priority.
    PlpSpending(std::vector<Range> ranges, std::uint64_t budget);

    // To be drawn next, by priority. What is too large for what is left of the budget leaves room for what
    // comes after it.
    std::vector<Taken> step();
    // No more steps: everything is taken, or nothing fits.
    bool done() const { return done_; }
    // Before the next step: what was drawn so far. The result is the number of ranges that are hidden.
    std::size_t look(const DepthPyramid& drawn, Workers& workers);

    std::uint64_t left() const { return budget_ - spent_; }

  private:
    std::vector<Range> open_;
    std::uint64_t budget_ = 0, whole_ = 0, spent_ = 0;  // whole_: what can be spent
    unsigned steps_ = 0;
    bool done_ = false;
};

}  // namespace iwalk
