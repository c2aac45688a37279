#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "preprocess/import/line_blocks.hpp"
#include "preprocess/import/obj_line.hpp"

// What some lines of an OBJ file say, read without knowing what came before them. Lines count from the
// block's first, 0. Reading ends at the first bad line.
namespace iwalk {

// For the first pass.
struct ObjVertexBlock {
    struct Vertex {
        std::array<double, 6> numbers;  // x y z, and what follows; else 0
        bool colored;                   // there were six
    };

    LineBlock lines;
    std::vector<Vertex> vertices;
    std::vector<glm::vec3> normals;      // of unit length or 0
    std::vector<std::string> libraries;  // what stands behind `mtllib`
    std::uint64_t triangleBound = 0;
    std::uint64_t lineCount = 0;

    void parse();
};

// For the second pass, in pieces of a bounded size: most blocks are one, a very long face is several.
class ObjFaceBlock {
  public:
    struct Face {
        std::uint32_t corners;            // in the piece
        bool goesOn;                      // it began in the piece before
        std::uint32_t vertices, normals;  // before it, in the piece
        std::uint64_t line;
    };
    struct Material {
        std::size_t face;  // from this one on
        std::string name;
    };

    LineBlock lines;
    // The piece. Vertices and normals are counted.
    std::vector<Face> faces;
    std::vector<ObjCorner> corners;  // of one face after the other
    std::vector<Material> materials;
    std::uint32_t vertices = 0, normals = 0;
    std::string badCorner;  // quoted: stands behind the last face's; empty when there is none

    void parse();      // the first piece
    bool parseMore();  // the next piece; false when there is none
    std::uint64_t lineCount() const { return cursor_.linesRead(); }

  private:
    void parseLine(std::string_view line);
    void takeCorners(bool goesOn);

    Lines cursor_;
    std::string_view rest_;  // of the face under way
    bool inFace_ = false, ended_ = false;
};

}  // namespace iwalk
