#pragma once

#include "preprocess/import/ply_values.hpp"
#include "preprocess/import/progress_meter.hpp"
#include "preprocess/import/triangle_output.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {

bool isPlyIndices(const PlyProperty& property);  // by its name

// The position of vertex_indices or vertex_index among the element's properties. Fails when there is none, or
// it is no list of integers.
Result<std::size_t> findPlyIndices(const PlyElement& element, const std::string& path);

// Streams the whole face element, of which `values` stands at the beginning, as triangles.
Result<void> readPlyFaces(const PlyElement& element, PlyFormat format, PlyValues& values,
                          const std::string& path, VertexStore& store, TriangleOutput& output,
                          ProgressMeter& progress);

}  // namespace iwalk
