#pragma once

#include <array>
#include <optional>
#include <span>
#include <unordered_map>

#include "preprocess/levels/numbers.hpp"
#include "preprocess/levels/page_store.hpp"

namespace iwalk {

struct VertexAttributes {
    std::uint32_t color = 0, normal = 0;
    bool operator==(const VertexAttributes&) const = default;
};

// The triangles of an entry, by the places of their corners.
class EntryTriangles {
  public:
    using Corners = std::array<CellPoint, 3>;
    using Attributes = std::array<VertexAttributes, 3>;

    // Reads them; `records`: of the pages.
    Result<void> read(const LevelRecord& entry, std::span<const PageRecord> records, PageStore& store);

    // What the corners of the triangle there have, in their order; nullopt when there is none that way round.
    std::optional<Attributes> find(Corners corners) const;
    // Whether the triangle at this place of the page's indices is here, too.
    bool has(const SourcePage& page, std::uint32_t firstIndex) const;

  private:
    struct Hash {
        std::size_t operator()(const Corners& c) const {
            return static_cast<std::size_t>(hashOf(c[0]) ^ 3 * hashOf(c[1]) ^ 7 * hashOf(c[2]));
        }
    };
    void add(const SourcePage& page, std::uint32_t firstIndex);

    std::unordered_map<Corners, Attributes, Hash> triangles_;  // the least corner first
};

// Of a vertex of a page.
VertexAttributes attributesOf(const SourcePage& page, std::uint16_t vertex);

// Calls visit(first index) for each triangle in ranges [first, first + count) of the page.
template <class Visit>
void forTriangles(const SourcePage& page, std::uint32_t first, std::uint32_t count, Visit visit) {
    for (const Range& range : std::span(page.ranges).subspan(first, count)) {
        for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; i += 3) visit(i);
    }
}

// Calls visit(page number, page, first range, ranges) for each page of an entry; fails when reading does.
template <class Visit>
Result<void> forPages(const LevelRecord& entry, std::span<const PageRecord> records, PageStore& store,
                      Visit visit) {
    for (std::uint32_t number = entry.firstPage; number < entry.firstPage + entry.pageCount; ++number) {
        ASSIGN_OR_RETURN(const std::shared_ptr<const SourcePage> page, store.get(number, records[number]));
        const bool shared = entry.pageCount == 1;
        RETURN_IF_ERROR(visit(number, *page, shared ? std::uint32_t{entry.firstRange} : 0u,
                              shared ? std::uint32_t{entry.rangeCount} : records[number].rangeCount));
    }
    return {};
}

}  // namespace iwalk
