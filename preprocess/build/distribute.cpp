#include "preprocess/build/distribute.hpp"

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "common/dataset/page.hpp"
#include "preprocess/build/grid.hpp"
#include "preprocess/build/split.hpp"

namespace iwalk {
namespace {

// To the nearest integer, ties to even, for |value| < 2^51: adding pushes the fraction out. Much faster than
// a call.
double roundToInteger(double value) {
    constexpr double kPush = 6755399441055744.0;  // 1.5 * 2^52
    return (value + kPush) - kPush;
}

std::uint32_t faceNormal(const Triangle& triangle) {
    const glm::dvec3 cross =
        glm::cross(triangle[1].position - triangle[0].position, triangle[2].position - triangle[0].position);
    const double length = glm::length(cross);
    return packNormal(length > 0 && std::isfinite(length) ? glm::vec3(cross / length) : glm::vec3(0, 0, 1));
}

}  // namespace

Distributor::Distributor(const Lattice& lattice, const LatticePoint& middle, const RecordFormat& format,
                         bool colors, bool normals, ChunkFile& file, OldTree& old)
    : lattice_(lattice),
      middle_(middle),
      mostSteps_(lattice.rootCellLog2 > kMostWholeLog2 ? kMostTriangleSteps : ~std::uint64_t{0}),
      format_(format),
      colors_(colors),
      normals_(normals),
      stepsPerUnit_(std::ldexp(1.0, -lattice.stepExponent)),
      writer_(file, kGridBins, format.words()),
      old_(old) {}

void Distributor::begin(const std::string& input, const ImportSummary& summary) {
    input_ = input;
    summary_ = summary;
    stored_ = degenerate_ = split_ = cut_ = 0;
}

// False when a corner is out of reach or the triangle too long.
bool Distributor::quantise(const Triangle& triangle, double stepsPerUnit, TriangleRecord& record) const {
    std::uint64_t longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const double steps = roundToInteger(triangle[corner].position[axis] * stepsPerUnit);
            if (!(std::abs(steps) <= static_cast<double>(kMaxSteps))) return false;
            record.positions[corner][axis] =
                static_cast<std::uint64_t>(static_cast<std::int64_t>(steps) - lattice_.rootCell[axis]);
        }
        const auto [low, high] =
            std::minmax({record.positions[0][axis], record.positions[1][axis], record.positions[2][axis]});
        longest = std::max(longest, high - low);
    }
    return longest <= mostSteps_;
}

Error Distributor::misfit(const Triangle& triangle) const {
    const glm::dvec3& p = triangle[0].position;
    return fail(
        "{}: triangle {} at ({:g}, {:g}, {:g}) is too far out for lattice steps of 2^{}: "
        "remove it, or give a coarser --step",
        input_, stored_ + degenerate_, p.x, p.y, p.z, lattice_.stepExponent);
}

void Distributor::setAttributes(const Triangle& triangle, TriangleRecord& record) const {
    const std::uint32_t flat = normals_ && !summary_.normals ? faceNormal(triangle) : 0;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        if (colors_) record.colors[corner] = summary_.colors ? triangle[corner].color : kPlainColor;
        if (normals_) record.normals[corner] = summary_.normals ? packNormal(triangle[corner].normal) : flat;
    }
}

Result<void> Distributor::add(std::span<const Triangle> triangles) {
    TriangleRecord record;
    for (const Triangle& triangle : triangles) {
        if (!quantise(triangle, stepsPerUnit_, record)) {
            RETURN_IF_ERROR(keepPieces(triangle));
            continue;
        }
        const auto& [a, b, c] = record.positions;
        if (a == b || b == c || c == a) {
            ++degenerate_;
            continue;
        }
        RETURN_IF_ERROR(keep(triangle, record));
    }
    return {};
}

void Distributor::pack(PackedTriangles& batch) const {
    batch.bins.resize(batch.triangles.size());
    batch.words.resize(batch.triangles.size() * format_.words());
    std::uint32_t* words = batch.words.data();
    TriangleRecord record;
    for (std::size_t i = 0; i < batch.triangles.size(); ++i, words += format_.words()) {
        const Triangle& triangle = batch.triangles[i];
        const auto& [a, b, c] = record.positions;
        if (!quantise(triangle, stepsPerUnit_, record)) {
            batch.bins[i] = PackedTriangles::kSplit;
        } else if (a == b || b == c || c == a) {
            batch.bins[i] = PackedTriangles::kDegenerate;
        } else {
            setAttributes(triangle, record);
            const TrianglePlace place = placeOf(a, b, c, lattice_.rootCellLog2);
            batch.bins[i] = static_cast<std::uint16_t>(binOf(place, 0, lattice_.rootCellLog2));
            format_.pack(record, words);
        }
    }
}

Result<void> Distributor::append(const PackedTriangles& batch) {
    const std::uint32_t* words = batch.words.data();
    for (std::size_t i = 0; i < batch.triangles.size(); ++i, words += format_.words()) {
        if (batch.bins[i] == PackedTriangles::kDegenerate) {
            ++degenerate_;
        } else if (batch.bins[i] == PackedTriangles::kSplit) {
            RETURN_IF_ERROR(keepPieces(batch.triangles[i]));
        } else {
            RETURN_IF_ERROR(storePacked(batch.bins[i], words));
        }
    }
    return {};
}

Result<void> Distributor::keep(const Triangle& triangle, TriangleRecord& record) {
    setAttributes(triangle, record);
    const auto& [a, b, c] = record.positions;
    const TrianglePlace place = placeOf(a, b, c, lattice_.rootCellLog2);
    RETURN_IF_ERROR(store(record, place));
    touch(place, record.positions);
    ++stored_;
    return {};
}

void Distributor::touch(const TrianglePlace& place, const std::array<CellPoint, 3>& positions) {
    if (!old_.exists()) return;
    LatticeBox box;
    for (const CellPoint& corner : positions) box.add(lattice_.fromCell(corner));
    old_.touch(place, box);
}

Result<void> Distributor::keepPieces(const Triangle& triangle) {
    Triangle inSteps = triangle;
    double farthest = 0;
    for (Corner& corner : inSteps) {
        corner.position *= stepsPerUnit_;
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            corner.position[axis] = std::nearbyint(corner.position[axis]);
            farthest = std::max(farthest, std::abs(corner.position[axis]));
        }
    }
    if (!std::isfinite(farthest)) return misfit(triangle);
    const SplitTriangle split = splitTriangle(inSteps, middle_);
    TriangleRecord record;
    for (const Triangle& piece : split.pieces) {
        if (!quantise(piece, 1, record)) return misfit(triangle);
        const auto& [a, b, c] = record.positions;
        if (a != b && b != c && c != a) RETURN_IF_ERROR(keep(piece, record));
    }
    split_ += split.pieces.size() > 1 ? 1 : 0;
    cut_ += split.isCut ? 1 : 0;
    return {};
}

Result<void> Distributor::store(const TriangleRecord& record, const TrianglePlace& place) {
    ASSIGN_OR_RETURN(std::uint32_t* const words, writer_.append(binOf(place, 0, lattice_.rootCellLog2)));
    format_.pack(record, words);
    return {};
}

Result<void> Distributor::storePacked(std::size_t bin, const std::uint32_t* words) {
    ASSIGN_OR_RETURN(std::uint32_t* const room, writer_.append(bin));
    std::memcpy(room, words, format_.bytes());
    ++stored_;
    if (old_.exists()) {
        touch(format_.place(words),
              {format_.position(words, 0), format_.position(words, 1), format_.position(words, 2)});
    }
    return {};
}

Result<void> Distributor::addOld(const TriangleRecord& record) {
    const auto& [a, b, c] = record.positions;
    return store(record, placeOf(a, b, c, lattice_.rootCellLog2));
}

}  // namespace iwalk
