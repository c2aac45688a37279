#include "common/dataset/hierarchy.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>

#include "common/dataset/hierarchy_check.hpp"
#include "common/file.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kHierarchyMagic = 0x53485749;  // "IWHS"
constexpr std::uint32_t kEndianTag = 0x01020304;

struct HierarchyHeader {
    std::uint32_t magic, version, endian, rootCellLog2;
    std::int64_t rootCell[3];
    std::uint32_t nodeCount, entryCount, pageCount, reserved;
    std::uint64_t payloadHash;  // xxh64 of all node records, then all level records, then all page records
    std::uint64_t hash;         // xxh64 of everything before
};
static_assert(sizeof(HierarchyHeader) == kHierarchyHeaderBytes);

std::uint64_t headerHash(const HierarchyHeader& header) {
    return XXH64(&header, offsetof(HierarchyHeader, hash), 0);
}

std::uint64_t payloadHash(const Hierarchy& hierarchy) {
    XXH64_state_t state;
    XXH64_reset(&state, 0);
    XXH64_update(&state, hierarchy.nodes.data(), hierarchy.nodes.size() * sizeof(NodeRecord));
    XXH64_update(&state, hierarchy.entries.data(), hierarchy.entries.size() * sizeof(LevelRecord));
    XXH64_update(&state, hierarchy.pages.data(), hierarchy.pages.size() * sizeof(PageRecord));
    return XXH64_digest(&state);
}

LatticePoint pointOf(const std::int64_t (&values)[3]) {
    return LatticePoint(values[0], values[1], values[2]);
}

Result<void> checkHeader(const std::string& path, const HierarchyHeader& header, std::uint64_t fileBytes) {
    if (header.magic != kHierarchyMagic)
        return fail("{}: byte 0: not a hierarchy; {}", path, kHierarchyDamaged);
    if (header.version != kDatasetVersion) {
        return fail("{}: version {}, but this program reads version {}; build the dataset again with it",
                    path, header.version, kDatasetVersion);
    }
    if (header.endian != kEndianTag)
        return fail("{}: byte 8: written in another byte order; {}", path, kHierarchyDamaged);
    if (header.hash != headerHash(header))
        return fail("{}: header: checksum does not match; {}", path, kHierarchyDamaged);
    if (header.reserved != 0) return fail("{}: byte 52: not 0; {}", path, kHierarchyDamaged);
    const std::uint64_t wanted = sizeof(header) + std::uint64_t{header.nodeCount} * sizeof(NodeRecord) +
                                 std::uint64_t{header.entryCount} * sizeof(LevelRecord) +
                                 std::uint64_t{header.pageCount} * sizeof(PageRecord);
    if (fileBytes != wanted) {
        return fail("{}: {} bytes where its header says {}; {}", path, fileBytes, wanted, kHierarchyDamaged);
    }
    return {};
}

// Moves `place` behind them.
template <class Record>
Result<void> readRecords(const RandomAccessFile& file, std::uint64_t& place, std::uint32_t count,
                         std::vector<Record>& records) {
    records.resize(count);
    const auto bytes = std::as_writable_bytes(std::span(records));
    RETURN_IF_ERROR(file.readAt(place, bytes));
    place += bytes.size();
    return {};
}

Result<Hierarchy> readHierarchy(const std::string& path) {
    ASSIGN_OR_RETURN(const std::unique_ptr<RandomAccessFile> file, openForReading(path));
    HierarchyHeader header{};
    if (file->size() < sizeof(header))
        return fail("{}: {} bytes are no hierarchy; {}", path, file->size(), kHierarchyDamaged);
    RETURN_IF_ERROR(file->readAt(0, std::as_writable_bytes(std::span(&header, 1))));
    RETURN_IF_ERROR(checkHeader(path, header, file->size()));

    Hierarchy hierarchy;
    hierarchy.rootCell = pointOf(header.rootCell);
    hierarchy.rootCellLog2 = header.rootCellLog2;
    std::uint64_t place = sizeof(header);
    RETURN_IF_ERROR(readRecords(*file, place, header.nodeCount, hierarchy.nodes));
    RETURN_IF_ERROR(readRecords(*file, place, header.entryCount, hierarchy.entries));
    RETURN_IF_ERROR(readRecords(*file, place, header.pageCount, hierarchy.pages));
    if (payloadHash(hierarchy) != header.payloadHash) {
        return fail("{}: records from byte {} on: checksum does not match; {}", path, sizeof(header),
                    kHierarchyDamaged);
    }
    return hierarchy;
}

}  // namespace

LatticeBox Hierarchy::box(const NodeRecord& node) {
    return {pointOf(node.boxMin), pointOf(node.boxMax)};
}
LatticeBox Hierarchy::ownBox(const NodeRecord& node) {
    return {pointOf(node.ownMin), pointOf(node.ownMax)};
}

const LevelRecord* Hierarchy::entryAt(const NodeRecord& node, unsigned level) const {
    const std::span<const LevelRecord> all = entriesOf(node);
    const auto found = std::ranges::find(all, level, &LevelRecord::level);
    return found == all.end() ? nullptr : &*found;
}

std::uint32_t Hierarchy::ownTriangles(const NodeRecord& node) const {
    const LevelRecord* full = fullEntryOf(node);
    return full != nullptr ? full->triangles : 0;
}

const LevelRecord* Hierarchy::drawnAt(const NodeRecord& node, unsigned level) const {
    level = std::max(level, coarsestLevel(rootCellLog2));
    if (hasLevels() && node.depth > level) return nullptr;  // an ancestor's entry covers it
    const LevelRecord* entry = entryAt(node, level);
    return entry != nullptr ? entry : fullEntryOf(node);
}

std::vector<LatticePoint> cellsOfNodes(const Hierarchy& hierarchy) {
    std::vector<LatticePoint> cells(hierarchy.nodes.size(), hierarchy.rootCell);
    for (std::size_t n = 0; n < hierarchy.nodes.size(); ++n) {
        const NodeRecord& node = hierarchy.nodes[n];
        std::uint32_t child = node.firstChild;
        for (unsigned octant = 0; octant < 8; ++octant) {
            if ((node.childMask >> octant & 1) == 0) continue;
            const std::int64_t half = std::int64_t{1} << (hierarchy.rootCellLog2 - node.depth - 1);
            cells[child++] =
                cells[n] + LatticePoint(octant & 1 ? half : 0, octant & 2 ? half : 0, octant & 4 ? half : 0);
        }
    }
    return cells;
}

Result<Hierarchy> loadHierarchy(const std::string& dataset, const Manifest& manifest) {
    const std::string path = dataset + "/" + manifest.hierarchy.name;
    ASSIGN_OR_RETURN(Hierarchy hierarchy, readHierarchy(path));
    RETURN_IF_ERROR(checkHierarchy(path, hierarchy, manifest));
    return hierarchy;
}

Result<std::uint64_t> saveHierarchy(const std::string& path, const Hierarchy& hierarchy) {
    HierarchyHeader header{};
    header.magic = kHierarchyMagic;
    header.version = kDatasetVersion;
    header.endian = kEndianTag;
    header.rootCellLog2 = hierarchy.rootCellLog2;
    for (std::size_t axis = 0; axis < 3; ++axis) header.rootCell[axis] = hierarchy.rootCell[axis];
    header.nodeCount = static_cast<std::uint32_t>(hierarchy.nodes.size());
    header.entryCount = static_cast<std::uint32_t>(hierarchy.entries.size());
    header.pageCount = static_cast<std::uint32_t>(hierarchy.pages.size());
    header.payloadHash = payloadHash(hierarchy);
    header.hash = headerHash(header);

    ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(path));
    RETURN_IF_ERROR(file.write(bytesOf(header)));
    RETURN_IF_ERROR(file.write(std::as_bytes(std::span(hierarchy.nodes))));
    RETURN_IF_ERROR(file.write(std::as_bytes(std::span(hierarchy.entries))));
    RETURN_IF_ERROR(file.write(std::as_bytes(std::span(hierarchy.pages))));
    RETURN_IF_ERROR(file.sync());
    return file.size();
}

}  // namespace iwalk
