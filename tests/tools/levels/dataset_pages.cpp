#include "tests/tools/levels/dataset_pages.hpp"

#include <algorithm>
#include <cstring>

#include "common/dataset/morph.hpp"

namespace iwalk::levels {
namespace {

// Ranges of a page that are an entry's.
struct Piece {
    std::uint32_t page, firstRange, rangeCount;
    EntryPlace place;
};

void addPieces(const Hierarchy& hierarchy, const LevelRecord& entry, const EntryPlace& place,
               std::vector<Piece>& pieces) {
    for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page) {
        const bool shared = entry.pageCount == 1;
        pieces.push_back({page, shared ? entry.firstRange : 0u,
                          shared ? entry.rangeCount : hierarchy.pages[page].rangeCount, place});
    }
}

LatticePoint pointOf(const std::uint32_t (&p)[3]) {
    return {p[0], p[1], p[2]};
}

// Of [level d] .. [level f], [full], or [full] alone, the one that is drawn where the whole model is drawn at
// a level; -1: none. `depth` of the node is at most `level`.
int drawnEntry(std::span<const LevelRecord> entries, bool leaf, unsigned depth, unsigned level) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (entries[i].level == level) return static_cast<int>(i);
    }
    // Of an interior node at its own depth nothing else counts; otherwise what it owns is at full.
    const bool full = !entries.empty() && entries.back().level == kFullLevel;
    return full && (leaf || depth < level) ? static_cast<int>(entries.size()) - 1 : -1;
}

}  // namespace

LatticeBox DecodedPage::box(const Range& range) const {
    return {origin + pointOf(range.boxMin), origin + pointOf(range.boxMax)};
}

Result<DatasetPages> DatasetPages::open(const std::string& dataset) {
    DatasetPages pages;
    pages.dataset_ = dataset;
    ASSIGN_OR_RETURN(pages.manifest_, loadManifest(dataset));
    ASSIGN_OR_RETURN(pages.hierarchy_, loadHierarchy(dataset, pages.manifest_));
    for (const DatasetFile& file : pages.manifest_.pageFiles) {
        ASSIGN_OR_RETURN(auto opened, openForReading(dataset + "/" + file.name));
        pages.files_.push_back(std::move(opened));
    }
    return pages;
}

const LevelRecord& DatasetPages::entry(const EntryPlace& place) const {
    return hierarchy_.entries[hierarchy_.nodes[place.node].firstEntry + place.entry];
}

std::vector<EntryPlace> DatasetPages::wholeModel(unsigned level) const {
    std::vector<EntryPlace> places;
    for (std::uint32_t n = 0; n < hierarchy_.nodes.size(); ++n) {
        const NodeRecord& node = hierarchy_.nodes[n];
        if (node.depth > level) continue;
        const int entry = drawnEntry(hierarchy_.entriesOf(node), Hierarchy::isLeaf(node), node.depth, level);
        if (entry >= 0) places.push_back({n, static_cast<std::uint32_t>(entry)});
    }
    return places;
}

std::vector<EntryPlace> DatasetPages::allEntries() const {
    std::vector<EntryPlace> places;
    for (std::uint32_t n = 0; n < hierarchy_.nodes.size(); ++n) {
        for (std::uint32_t e = 0; e < hierarchy_.nodes[n].entryCount; ++e) places.push_back({n, e});
    }
    return places;
}

int DatasetPages::nextLevel(const EntryPlace& place) const {
    if (!hierarchy_.hasLevels()) return -1;
    if (place.entry > 0) return entry({place.node, place.entry - 1}).level;
    return hierarchy_.nodes[place.node].depth - 1;
}

Result<void> DatasetPages::visitRanges(const std::vector<EntryPlace>& entries, bool targets,
                                       const Visit& visit) const {
    std::vector<Piece> pieces;
    for (const EntryPlace& place : entries) addPieces(hierarchy_, entry(place), place, pieces);
    std::ranges::sort(pieces, {}, [](const Piece& piece) { return std::pair(piece.page, piece.firstRange); });
    DecodedPage page;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Piece& piece = pieces[i];
        if (i == 0 || pieces[i - 1].page != piece.page) {
            ASSIGN_OR_RETURN(page, read(piece.page, targets));
        }
        for (std::uint32_t r = piece.firstRange; r < piece.firstRange + piece.rangeCount; ++r)
            visit(piece.place, page, page.ranges[r]);
    }
    return {};
}

Result<DecodedPage> DatasetPages::read(std::uint32_t index, bool targets) const {
    const PageRecord& record = hierarchy_.pages[index];
    std::vector<std::byte> bytes(record.bytes), decoded(pageLayout(record).bytes);
    RETURN_IF_ERROR(files_[record.file]->readAt(record.offset, bytes));
    auto table = decodePage(bytes, record, decoded);
    if (!table) {
        return fail("{}/{}: page {} at byte {}: {}", dataset_, manifest_.pageFiles[record.file].name, index,
                    record.offset, table.error().message);
    }
    DecodedPage page;
    page.origin = table->origin;
    page.positions = latticePositions(*table, decoded, record);
    page.indices.resize(record.indexCount);
    std::memcpy(page.indices.data(), decoded.data() + pageLayout(record).indices, 2 * page.indices.size());
    if (targets && record.morphBytes > 0) RETURN_IF_ERROR(readTargets(record, *table, page));
    page.ranges = std::move(table->ranges);
    return page;
}

Result<void> DatasetPages::readTargets(const PageRecord& record, const PageTable& table,
                                       DecodedPage& page) const {
    std::vector<std::byte> bytes(record.morphBytes);
    RETURN_IF_ERROR(files_[record.morphFile]->readAt(record.morphOffset, bytes));
    const auto morph = decodeMorph(bytes, record, table);
    if (!morph) {
        return fail("{}/{}: morph block at byte {}: {}", dataset_, manifest_.pageFiles[record.morphFile].name,
                    record.morphOffset, morph.error().message);
    }
    page.targets = targetsOf(*morph, page.positions);
    return {};
}

}  // namespace iwalk::levels
