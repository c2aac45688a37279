#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/build/page_job.hpp"

namespace iwalk {

// Cuts an entry into as few pages as do, each of whole runs and about as large as the others: where the runs
// of each page end.
std::vector<std::size_t> cutPages(std::span<const Run> runs, std::size_t mostTriangles);

// Deals the triangles of the nodes, which come in depth-first order, out to pages. What a node has too much
// for one page is cut evenly; small neighbours share a page. The pages do not depend on how nodes come in
// slices.
class Packer {
  public:
    // A page has at most `mostTriangles` (and kMaxPageTriangles): the leaf size, so that a leaf is one page.
    Packer(const RecordFormat& format, std::size_t mostTriangles);

    // A slice of a node that has `total` triangles in all. Only a node for several pages may come in several
    // slices.
    void add(Slice slice, std::uint64_t total);
    // A whole entry of a coarser level, with its runs and its triangles its own.
    void add(Slice slice);
    // Completes the page that waits.
    void finish() { closeShared(); }
    std::size_t mostTriangles() const { return most_; }  // of a page
    // The pages that are complete.
    std::vector<PageJob> take() { return std::exchange(complete_, {}); }
    // Copies what still waits for its page out of memory that is about to go.
    void keep();

  private:
    void addLarge(Slice slice, std::uint64_t total);
    void addPieces(const Slice& slice);
    void closeShared();
    void closeLarge(std::optional<std::uint64_t> keyAfter);
    std::uint64_t keyOf(const Slice& slice, std::size_t i) const;
    bool fits(const Slice& slice) const;

    RecordFormat format_;
    std::size_t words_, most_;
    PageJob waiting_;  // shared by small nodes, or the next page of a large one
    std::size_t waitingTriangles_ = 0;
    LatticeBox waitingBox_;
    std::uint64_t largeDone_ = 0;  // triangles of the large node under way
    bool pageFull_ = false;        // `waiting_` is complete but for the key behind it
    std::vector<PageJob> complete_;
};

}  // namespace iwalk
