#pragma once

#include <map>

#include "tests/server/wall_renders.hpp"

namespace iwalk::bench {

// What is measured, by name: one value a frame.
using Series = std::map<std::string, std::vector<double>>;

// A wall of N x N tiles in each of the servers' modes, with the servers' own way of a frame. One rank has all
// tiles of a wall, so that pages are in memory once for each mode.
class BenchWall {
  public:
    // The dataset outlives it. `width`, `height`: px of a tile. `costOfLooking`: of ConservativeDrawing.
    // `threads`: of visibility.
    BenchWall(const Dataset& dataset, int width, int height, int n, double costOfLooking, unsigned threads);

    // All modes draw the frame, one after the other. Appends sums over the tiles: MODE.ms (elapsed),
    // MODE.cpu_ms (of all threads), MODE.triangles, and of cplp the parts.
    void drawFrame(const Camera& camera, Series& series);

  private:
    const Wall wall_;
    tools::WallServers frustum_, cplp_, plp_;
};

}  // namespace iwalk::bench
