#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/dataset/hierarchy.hpp"
#include "common/dataset/manifest.hpp"
#include "common/dataset/page.hpp"
#include "common/file.hpp"

namespace iwalk::levels {

// A page as it is judged: lattice positions.
struct DecodedPage {
    std::vector<LatticePoint> positions;
    std::vector<LatticePoint> targets;  // where vertices morph to; empty: the page has no morph block
    std::vector<std::uint16_t> indices;
    LatticePoint origin{0, 0, 0};
    std::vector<Range> ranges;

    LatticeBox box(const Range& range) const;
};

// An entry of a node by its place: entries[nodes[node].firstEntry + entry].
struct EntryPlace {
    std::uint32_t node, entry;
};

// A dataset whose pages are read one by one.
class DatasetPages {
  public:
    static Result<DatasetPages> open(const std::string& dataset);
    const Manifest& manifest() const { return manifest_; }
    const Hierarchy& hierarchy() const { return hierarchy_; }
    const LevelRecord& entry(const EntryPlace& place) const;
    // All entries that together are the model at a level (kFullLevel: the input).
    std::vector<EntryPlace> wholeModel(unsigned level) const;
    std::vector<EntryPlace> allEntries() const;
    // The level that the vertices of an entry morph to; -1: there is none coarser.
    int nextLevel(const EntryPlace& place) const;

    // Calls visit once for every range of the entries, page by page.
    using Visit = std::function<void(const EntryPlace&, const DecodedPage&, const Range&)>;
    Result<void> visitRanges(const std::vector<EntryPlace>& entries, bool targets, const Visit& visit) const;

  private:
    Result<DecodedPage> read(std::uint32_t page, bool targets) const;
    Result<void> readTargets(const PageRecord& record, const PageTable& table, DecodedPage& page) const;

    std::string dataset_;
    Manifest manifest_;
    Hierarchy hierarchy_;
    std::vector<std::unique_ptr<RandomAccessFile>> files_;
};

}  // namespace iwalk::levels
