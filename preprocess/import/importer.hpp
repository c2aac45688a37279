#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry.hpp"
#include "common/result.hpp"

namespace iwalk {

// A corner of an input triangle. Attributes that the input does not have are 0.
struct Corner {
    glm::dvec3 position{0};   // model units; always finite
    std::uint32_t color = 0;  // RGBA8 in memory order, sRGB
    glm::vec3 normal{0};      // unit length
};
using Triangle = std::array<Corner, 3>;

// RGBA8 of what has no colour among others that have: light grey, opaque.
inline constexpr std::uint32_t kPlainColor = 0xffc8c8c8;

// What a first look at an input tells.
struct ImportSummary {
    std::uint64_t vertices = 0;  // with finite positions
    // No more triangles than this will come: exact for texts other than PLY, and STL; for binary PLY, where
    // it is what the bytes have room for, three times as many as there are, as a rule (ProgressSink is the
    // one for progress); 0 when unknown.
    std::uint64_t triangleBound = 0;
    ModelBox bounds;  // of the finite vertices
    // The spacing of representable numbers at the largest |coordinate|: 2^-23 of its power of two for 32-bit
    // floats (what a PLY declares, text or not), 2^-52 for doubles, 1 for integers. OBJ text, which does not
    // say, counts as floats unless it lies farther from 0 than 1024 times its size.
    double precision = 0;
    bool colors = false, normals = false;
};

// What streaming the triangles came to.
struct ImportCounts {
    std::uint64_t triangles = 0;         // handed to the sink
    std::uint64_t droppedNonFinite = 0;  // had a corner whose position is NaN or infinite
};

// May take the triangles and leave any other vector in their place.
using TriangleSink = std::function<Result<void>(std::vector<Triangle>&)>;
using VertexSink = std::function<void(std::span<const glm::dvec3>)>;
// Called now and then with the part done of the pass under way, 0..1.
using ProgressSink = std::function<void(double)>;

// One input file, read front to back in bounded memory: scan() once, then triangles() once. Bad input is an
// Error that names the file and the place (byte offset, line, or element index) and says what is wrong;
// nothing that a file claims is believed before it is checked against the file's size.
class Importer {
  public:
    virtual ~Importer() = default;
    // Reads all vertices (kept for triangles(): in memory up to the limit, beyond that in a spill file) and
    // hands the finite positions on in batches.
    virtual Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) = 0;
    // Hands all triangles on in file order, polygons fanned, in batches of some thousands.
    virtual Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) = 0;
    // False when nothing is kept from scan() to triangles(), so that triangles() can do without it.
    virtual bool needsScan() const { return true; }
};

// What people say about inputs that the files do not.
struct ImportChoices {
    bool yUp = false;  // y is up in them: turned, so that z is
    // Of height maps: the distance of neighbouring samples, and of heights that differ by 1, in model units;
    // and the height that stands for a hole.
    double spacing = 1, heightScale = 1;
    std::optional<double> noData;
    std::optional<double> seaLevel;  // model units: colours them by height
};

struct ImportLimits {
    std::uint64_t memoryBytes = 0;  // for one importer, buffers and kept vertices included; at least 16 MiB
    std::string spillDirectory;     // exists; what the importer makes there is gone when it is, or is killed
    ImportChoices choices{};
    // Threads that may take part: with more than one those of the TBB arena that scan() and triangles() are
    // called in. What is handed out, and when, is the same; sinks are called by the calling thread.
    unsigned threads = 1;
    // Text is parsed in blocks of about so many bytes, up to 1 MiB. Larger: fewer hand-overs, more memory.
    std::size_t blockBytes = std::size_t{64} << 10;
    // How many assemblies the file is part of, and how often they place it in all.
    unsigned nesting = 0;
    std::uint64_t copies = 1;
};

// Picks the reader by the file's first bytes and its extension. Fails when there is none for it, or the file
// cannot be opened.
Result<std::unique_ptr<Importer>> openImporter(const std::string& path, const ImportLimits& limits);

// Whether a file of this name is taken for a model when it is found in a directory.
bool isModelName(const std::string& path);

}  // namespace iwalk
