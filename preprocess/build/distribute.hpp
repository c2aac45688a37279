#pragma once

#include <span>
#include <string>
#include <vector>

#include "preprocess/build/old_tree.hpp"
#include "preprocess/build/record.hpp"
#include "preprocess/build/spill.hpp"
#include "preprocess/import/importer.hpp"

namespace iwalk {

// A batch of triangles on its way into the bins.
struct PackedTriangles {
    std::vector<Triangle> triangles;
    // Made by Distributor::pack(): the bin of each, or what it is instead; and its words where it has a bin.
    static constexpr std::uint16_t kDegenerate = 0xffff, kSplit = 0xfffe;
    std::vector<std::uint16_t> bins;
    std::vector<std::uint32_t> words;
};

// Puts the triangles of the inputs on the lattice and into the bins of the topmost grid.
class Distributor {
  public:
    // `middle`: of the model, lattice.
    Distributor(const Lattice& lattice, const LatticePoint& middle, const RecordFormat& format, bool colors,
                bool normals, ChunkFile& file, OldTree& old);

    // The triangles that follow are of this input: its name for errors, and what it has.
    void begin(const std::string& input, const ImportSummary& summary);
    // Triangles that are too long for the lattice are split. Fails when one does not fit it, or the disk is
    // full.
    Result<void> add(std::span<const Triangle> triangles);
    // The same in two steps: the first for several batches at once, by any threads; the second for one after
    // the other.
    void pack(PackedTriangles& batch) const;
    Result<void> append(const PackedTriangles& batch);
    // A triangle that the dataset has had before.
    Result<void> addOld(const TriangleRecord& record);
    // Of the input that began last: stored triangles, and those with fewer than three distinct lattice
    // positions; triangles that are in several pieces, and those of which a part at least is left out.
    std::uint64_t stored() const { return stored_; }
    std::uint64_t degenerate() const { return degenerate_; }
    std::uint64_t split() const { return split_; }
    std::uint64_t cut() const { return cut_; }

    Result<std::vector<Bin>> finish() { return writer_.finish(); }

  private:
    bool quantise(const Triangle& triangle, double stepsPerUnit, TriangleRecord& record) const;
    Result<void> keep(const Triangle& triangle, TriangleRecord& record);
    Result<void> keepPieces(const Triangle& triangle);
    Result<void> storePacked(std::size_t bin, const std::uint32_t* words);
    void touch(const TrianglePlace& place, const std::array<CellPoint, 3>& positions);
    Result<void> store(const TriangleRecord& record, const TrianglePlace& place);
    Error misfit(const Triangle& triangle) const;
    void setAttributes(const Triangle& triangle, TriangleRecord& record) const;

    Lattice lattice_;
    glm::dvec3 middle_;        // steps
    std::uint64_t mostSteps_;  // of a triangle
    RecordFormat format_;
    bool colors_, normals_;  // of the dataset
    double stepsPerUnit_;
    BinWriter writer_;
    OldTree& old_;  // is told of new triangles
    std::string input_;
    ImportSummary summary_;
    std::uint64_t stored_ = 0, degenerate_ = 0, split_ = 0, cut_ = 0;
};

}  // namespace iwalk
