#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <functional>
#include <vector>

#include "preprocess/build/packer.hpp"
#include "preprocess/build/page_writer.hpp"
#include "preprocess/build/spill.hpp"
#include "preprocess/build/subtree.hpp"
#include "preprocess/build/tree.hpp"

namespace iwalk {

struct AssembleOptions {
    std::uint64_t leafTriangles = 0;
    std::size_t batchTriangles = 0;  // in memory at once; not less than a leaf's
    unsigned threads = 1;
    std::function<void(double)> done;  // the part of all triangles that is in pages
};

// Turns the bins of the topmost grid into octree and pages, in depth-first order, a batch of triangles in
// memory at a time. Parts that are too large for a batch are sorted into bins of their own on disk first.
// What comes out does not depend on the batches' size: nodes follow from counts, and the order in a node from
// keys and the input's order. Nodes of the old tree that nothing touches enter the new one with their
// entries.
class Assembler {
  public:
    Assembler(const RecordFormat& format, const Lattice& lattice, AssembleOptions options, ChunkFile& spill,
              PageWriter& writer, const OldTree& old);

    Result<void> run(std::vector<Bin> bins);
    Tree::Records takeTree() { return tree_.finish(); }

  private:
    // Triangles of the batch that belong together: of one node, or of a subtree still to be split.
    struct Unit {
        bool subtree;
        std::uint32_t node;   // the node; of a subtree: what it hangs on
        std::uint8_t octant;  // of a subtree's root
        unsigned depth;
        std::uint64_t total;  // of the node, in all its units
        std::size_t first, count;
        std::uint32_t old;  // of a subtree: the node of the old tree that its root is, or OldTree::kNone
    };
    // Where a grid is in the octree.
    struct GridPlace {
        std::uint32_t parent;
        std::uint8_t octant;
        unsigned depth;
        std::uint32_t old;
    };

    std::uint32_t addNode(const GridPlace& place);
    void keep(const GridPlace& place);
    void keepOwn(std::uint32_t node);
    Result<void> addGrid(std::vector<Bin> bins, const GridPlace& place);
    Result<void> addSubtree(Bin bin, const GridPlace& place);
    Result<void> addOwn(std::vector<Bin> bins, std::uint32_t node, std::uint64_t total);
    Result<void> addTooMany(Bin bin, std::uint32_t node, std::uint64_t total, unsigned keyBits);
    Result<void> addInPieces(Bin bin, std::uint32_t node, std::uint64_t total);
    template <class BinOfRecord>
    Result<std::vector<Bin>> distribute(Bin bin, std::size_t binCount, BinOfRecord binOfRecord);

    Result<void> makeRoom(std::uint64_t triangles);
    Result<void> load(Bin bin);
    Result<void> flush();
    std::vector<Subtree> growUnits(std::vector<std::uint32_t>& order);
    std::vector<std::uint32_t> addNodes(const Unit& unit, const Subtree& grown);
    std::vector<Slice> makeSlices(const std::vector<Subtree>& grown, const std::vector<std::uint32_t>& order);
    void findLevels(std::vector<Slice>& slices);
    Result<void> writePages();
    void sortSlices(std::vector<Slice>& slices, std::vector<std::uint32_t>& order);
    unsigned edgeLog2(std::uint32_t node) const;

    RecordFormat format_;
    Lattice lattice_;
    AssembleOptions options_;
    ChunkFile& spill_;
    PageWriter& writer_;
    const OldTree& old_;
    tbb::global_control threads_;  // more threads than cores, too
    tbb::task_arena arena_;
    Tree tree_;
    Packer packer_;
    std::vector<std::uint32_t> records_;  // of the batch
    std::vector<Unit> units_;
    std::vector<std::uint64_t> totals_;  // of the slices under way
    std::uint64_t allTriangles_ = 0, doneTriangles_ = 0;
};

}  // namespace iwalk
