#pragma once

#include <string>
#include <vector>

#include "preprocess/import/importer.hpp"

namespace iwalk {

// A small model whose numbers all types of PLY can hold.
struct TestMesh {
    std::vector<Corner> vertices;
    std::vector<std::vector<unsigned>> polygons;
};
// A cube of quadrilaterals, a triangle and a pentagon, with colours and normals.
TestMesh testCube();
// The mesh as an importer is to hand it out: polygons fanned; colours and normals only where asked for.
std::vector<Triangle> fanned(const TestMesh& mesh, bool colors, bool normals);

// How to write it. Types are written into the header as they are named here.
struct PlyFlavor {
    std::string format = "binary_little_endian";
    std::string coordinate = "float", count = "uchar", index = "int";
    std::string indexName = "vertex_indices";
    std::string color = {};        // type of colours; none when empty
    std::string colorPrefix = {};  // "diffuse_" for instance
    bool normals = false;          // as floats
    bool alpha = false;            // with colours
    bool reversed = false;         // properties in reverse
    bool extras = false;           // with properties and elements that nobody knows
    bool vertexLists = false;      // a list among the vertex's properties
    bool facesFirst = false;
    std::string lineEnd = "\n";
};
std::string writePly(const TestMesh& mesh, const PlyFlavor& flavor);

// One value as it stands in the data of a PLY file.
std::string plyValue(const std::string& format, const std::string& type, double value);

}  // namespace iwalk
