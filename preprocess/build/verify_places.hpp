#pragma once

#include <optional>
#include <string>

#include "preprocess/build/verify_reader.hpp"

// Inside verifyDataset() only: whether pages lie where their nodes and ranges say.
namespace iwalk {

// Which ranges of a page are whose.
struct Share {
    std::uint32_t page, firstRange, rangeCount, node, entry;
};

// In the order of pages and ranges; loadHierarchy() has seen to it that these cover everything once.
std::vector<Share> sharesOf(const Hierarchy& hierarchy);

class PlaceChecker {
  public:
    explicit PlaceChecker(const Hierarchy& hierarchy);

    // A page against its ranges' boxes and its nodes' boxes and cells; the first thing that is wrong. Pages
    // come in order.
    std::optional<std::string> check(const PlainPage& page, std::span<const Share> shares);
    // Triangles at full resolution in the pages so far.
    std::uint64_t fullTriangles() const { return fullTriangles_; }

  private:
    std::optional<std::string> checkRange(const PlainPage& page, const Range& range, const Share& share);
    std::optional<std::string> checkPath(const Share& share, std::uint32_t path);
    std::optional<std::string> checkMorph(const PlainPage& page, std::size_t range, const Share& share) const;
    unsigned cellLog2(std::uint32_t node) const;
    bool belongs(std::uint32_t node, std::uint32_t path, std::int64_t longest,
                 const LatticePoint& centroid) const;

    const Hierarchy& hierarchy_;
    std::vector<LatticePoint> cells_;
    std::vector<std::uint32_t> lastPaths_;  // of each entry, as its ranges come
    std::uint64_t fullTriangles_ = 0;
};

}  // namespace iwalk
