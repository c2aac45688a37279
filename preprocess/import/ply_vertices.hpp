#pragma once

#include <vector>

#include "preprocess/import/ply_values.hpp"
#include "preprocess/import/progress_meter.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {

// Which properties of a vertex element are read, and into which column.
struct PlyVertexPlan {
    VertexFormat format;
    int precisionBits = 0;  // of the positions: 23 floats, 52 doubles, 0 integers
    struct Field {
        VertexColumn column = kNoColumn;
        std::size_t offset = 0;  // bytes into a record of fixed size
        double factor = 1;       // to the column's scale
    };
    std::vector<Field> fields;  // by property
};

// Fails when positions are missing or are lists.
Result<PlyVertexPlan> planPlyVertices(const PlyElement& element, const std::string& path);

// Reads the whole element, of which `values` stands at the beginning.
Result<void> readPlyVertices(const PlyElement& element, PlyFormat format, const PlyVertexPlan& plan,
                             PlyValues& values, VertexStore& store, const VertexSink& sink,
                             ProgressMeter& progress);

}  // namespace iwalk
