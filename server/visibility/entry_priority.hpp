#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/hierarchy.hpp"
#include "server/adapt/cut.hpp"
#include "server/visibility/eye.hpp"
#include "server/visibility/workers.hpp"
#include "server/wall/projection.hpp"

namespace iwalk {

// All that visibility needs to know of a tile in a frame.
struct TileSight {
    ScreenProjection projection;  // of the tile's screen
    PixelRect tile;               // px of the screen
    LatticeEye eye;
    double near = 0;  // steps

    // Pixels move by less than one when vertices are snapped.
    Frustum frustum() const { return frustumOf(projection, tile, 1, near); }
};

// How much of the tile an entry of the cut is likely to show.
struct EntryPriority {
    std::uint32_t node = 0, entry = 0;  // indices in Hierarchy
    float rays = 0;                     // how many meet its box
    float contribution = 0;             // of these together, when they come to it (RayGrid::Arrival)
};

// The optical depth of a leaf as seen along the unit vector `direction`: -ln(1 - opacity), finite.
float opticalDepth(const NodeRecord& leaf, const glm::vec3& direction);

// The area of a box with these sides as seen in parallel projection along the unit vector `direction`.
float silhouetteArea(const glm::vec3& sides, const glm::vec3& direction);

// From the eye to the middle of the box; a unit vector.
glm::vec3 directionTo(const glm::vec3& low, const glm::vec3& high);

// Ray-cast PLP (Correa 2004, section 4.3.1): the entries of the cut whose boxes meet the tile's frustum,
// front to back, as sparse rays find them. Needs the hierarchy alone. `cells`: cellsOfNodes().
//
// A ray that crosses a leaf loses the part 1 - (1 - a)^(l / c), where a is the leaf's opacity from the sample
// direction nearest to the middle of its cell, l the ray's length in the cell, and c the mean length of all
// rays of this direction through it (volume / silhouette): such rays together lose a, as was measured. An
// entry that stands for everything below its node, and an interior node's own triangles, get what arrives at
// their box; what they hide is in the opacities of the leaves.
std::vector<EntryPriority> entryPriorities(const Hierarchy& hierarchy, const std::vector<LatticePoint>& cells,
                                           const Cut& cut, const TileSight& sight, double raysPerPixel,
                                           Workers& workers);

}  // namespace iwalk
