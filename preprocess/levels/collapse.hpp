#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace iwalk {

// The part of a level that one cell of space decides about: points (vertices known by position), wedges
// (points with attributes), and triangles. Points are relative to the cell's centre, in lattice steps.
struct CollapseMesh {
    std::vector<glm::vec3> points;
    std::vector<float> errors;       // by point: bound of its distance from full resolution, steps
    std::vector<std::uint8_t> held;  // by point: other cells use it, so it stays where it is
    std::vector<std::array<std::uint32_t, 3>> triangles;  // points
    // By triangle and corner; empty when the model has no attributes. A wedge belongs to one point.
    std::vector<std::array<std::uint32_t, 3>> wedges;
    std::vector<std::uint32_t> wedgeColors;  // by wedge, RGBA8: lines where colours meet are kept
};

struct CollapseLimits {
    float error;        // steps: no point of the surface moves farther from full resolution
    float longestEdge;  // steps: what is collapsed gets no longer edges, so that boxes stay small
};

// Where points and wedges go: by number, to the number of a point or wedge that stays.
struct CollapseMap {
    std::vector<std::uint32_t> points, wedges;
};

// The map from one level to the next coarser one. First edges collapse, cheapest first: point s goes into its
// neighbour t when errors[s] plus the distance of t from the planes of s's triangles, from the lines of its
// border edges and folds, and of s from its new triangles, is within the limit and no triangle turns over.
// Then what is still dense is joined, disjoint parts too: s goes into any t that is as near as the limit
// leaves. No contraction leaves a line behind that is no triangle's edge, so thin parts become ribbons and
// small ones pairs of triangles, but never vanish. `mesh` is used up; its errors are those of the points that
// stay.
CollapseMap collapse(CollapseMesh& mesh, const CollapseLimits& limits);

// The least error limit at which each of `points` could be the first to collapse, when edges may get
// `edgesPerError` times as long as it; steps, INFINITY for never. All triangles of the points must be there.
std::vector<float> collapseErrors(CollapseMesh& mesh, std::span<const std::uint32_t> points,
                                  float edgesPerError);

}  // namespace iwalk
