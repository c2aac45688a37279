#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#include "common/dataset/hierarchy.hpp"
#include "common/dataset/morph.hpp"
#include "common/dataset/page_files.hpp"

// Inside verifyDataset() only.
namespace iwalk {

// A page and its morph block, decoded; all in lattice coordinates.
struct PlainPage {
    LatticePoint origin{0, 0, 0};
    std::vector<Range> ranges;
    std::vector<LatticePoint> positions;  // by vertex
    std::vector<LatticePoint> targets;    // by vertex; without a morph block where they are
    std::vector<std::uint16_t> indices;
    std::optional<PageMorph> morph;

    LatticeBox box(const Range& range) const;
    LatticeBox morphBox(std::size_t range) const;  // with a morph block
    std::span<const std::uint16_t> indicesOf(const Range& range) const {
        return std::span(indices).subspan(range.firstIndex, range.indexCount);
    }
    std::size_t bytes() const;
};

class PageReader {
  public:
    PageReader(const Hierarchy& hierarchy, const PageFiles& files) : hierarchy_(hierarchy), files_(files) {}

    Result<PlainPage> read(std::uint32_t page) const;
    // The same; the pages used last stay in memory.
    Result<std::shared_ptr<const PlainPage>> get(std::uint32_t page);

  private:
    struct Kept {
        std::uint32_t number;
        std::shared_ptr<const PlainPage> page;
    };
    // Some pages of each level around one place; those of a node's neighbours are much the same.
    static constexpr std::size_t kMostBytes = std::size_t{64} << 20;

    const Hierarchy& hierarchy_;
    const PageFiles& files_;
    std::list<Kept> kept_;  // last used first
    std::size_t keptBytes_ = 0;
};

// Calls visit(number, page, first range, ranges) for each page of an entry, until it or reading fails.
template <class Visit>
Result<void> visitPages(PageReader& reader, const LevelRecord& entry, Visit visit) {
    for (std::uint32_t p = entry.firstPage; p < entry.firstPage + entry.pageCount; ++p) {
        ASSIGN_OR_RETURN(const std::shared_ptr<const PlainPage> page, reader.get(p));
        const bool shared = entry.pageCount == 1;
        RETURN_IF_ERROR(visit(p, *page, shared ? entry.firstRange : std::size_t{0},
                              shared ? entry.rangeCount : page->ranges.size()));
    }
    return {};
}

}  // namespace iwalk
