#include "preprocess/build/verify.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>

#include "common/dataset/hierarchy.hpp"
#include "common/dataset/page.hpp"
#include "common/file.hpp"

namespace iwalk {
namespace {

// Which ranges of a page are whose.
struct Share {
    std::uint32_t page, firstRange, rangeCount, node;
};

// In the order of pages and ranges; loadHierarchy() has seen to it that these cover everything once.
std::vector<Share> sharesOf(const Hierarchy& hierarchy) {
    std::vector<Share> shares;
    for (std::uint32_t n = 0; n < hierarchy.nodes.size(); ++n) {
        const NodeRecord& node = hierarchy.nodes[n];
        for (std::uint32_t p = node.firstPage; p < node.firstPage + node.pageCount; ++p) {
            const bool shared = node.pageCount == 1;
            shares.push_back({p, shared ? node.firstRange : 0u,
                              shared ? node.rangeCount : hierarchy.pages[p].rangeCount, n});
        }
    }
    std::ranges::sort(shares, {}, [](const Share& share) { return std::pair(share.page, share.firstRange); });
    return shares;
}

// The lowest corners of the nodes' cells.
std::vector<LatticePoint> cellsOf(const Hierarchy& hierarchy) {
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

LatticePoint pointOf(const std::uint32_t (&p)[3]) {
    return LatticePoint(p[0], p[1], p[2]);
}

class Verifier {
  public:
    Verifier(const Hierarchy& hierarchy)
        : hierarchy_(hierarchy), cells_(cellsOf(hierarchy)), ownBoxes_(cells_.size()) {}

    // A decoded page against its ranges' boxes and its nodes' cells; the first thing that is wrong.
    std::optional<std::string> checkPage(const PageRecord& record, const PageTable& table,
                                         std::span<const std::byte> decoded, std::span<const Share> shares) {
        std::vector<std::uint16_t> indices(record.indexCount);
        std::memcpy(indices.data(), decoded.data() + pageLayout(record).indices, 2 * indices.size());
        for (const Share& share : shares) {
            for (std::uint32_t r = share.firstRange; r < share.firstRange + share.rangeCount; ++r) {
                const Range& range = table.ranges[r];
                LatticeBox box;
                for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; i += 3) {
                    LatticeBox triangle;
                    LatticePoint sum(0);
                    for (std::uint32_t c = 0; c < 3; ++c) {
                        const LatticePoint p(pageOffset(decoded, record, indices[i + c]));
                        triangle.add(p);
                        sum += p + table.origin - hierarchy_.rootCell;
                    }
                    if (!belongs(share.node, triangle.edge(), sum / std::int64_t{3})) {
                        return fmt::format("triangle {} does not belong into node {}", i / 3, share.node);
                    }
                    box.add(triangle);
                }
                if (box.min != pointOf(range.boxMin) || box.max != pointOf(range.boxMax)) {
                    return fmt::format("range {}: box is not that of its triangles", r);
                }
                ownBoxes_[share.node].add(LatticeBox{box.min + table.origin, box.max + table.origin});
            }
        }
        return std::nullopt;
    }

    // After all pages.
    std::vector<std::string> checkNodes() const {
        std::vector<std::string> problems;
        for (std::size_t n = 0; n < ownBoxes_.size(); ++n) {
            if (ownBoxes_[n] == Hierarchy::ownBox(hierarchy_.nodes[n])) continue;
            problems.push_back(fmt::format("node {}: own box is not that of its triangles", n));
        }
        return problems;
    }

  private:
    bool belongs(std::uint32_t n, std::int64_t longest, const LatticePoint& centroid) const {
        const std::int64_t edge = std::int64_t{1} << (hierarchy_.rootCellLog2 - hierarchy_.nodes[n].depth);
        const LatticePoint inCell = centroid + hierarchy_.rootCell - cells_[n];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (inCell[axis] < 0 || inCell[axis] >= edge) return false;
        }
        // In an interior node only what is too large for its children.
        return longest <= edge && (hierarchy_.nodes[n].childMask == 0 || 2 * longest > edge);
    }

    const Hierarchy& hierarchy_;
    std::vector<LatticePoint> cells_;
    std::vector<LatticeBox> ownBoxes_;
};

// Reads and decodes one page; the bytes of `decoded` are the caller's to reuse.
Result<PageTable> readPage(const RandomAccessFile& file, const PageRecord& record,
                           std::vector<std::byte>& decoded) {
    std::vector<std::byte> bytes(record.bytes);
    RETURN_IF_ERROR(file.readAt(record.offset, bytes));
    decoded.resize(pageLayout(record).bytes);
    return decodePage(bytes, record, decoded);
}

}  // namespace

Result<Verification> verifyDataset(const std::string& dataset, Progress& progress) {
    progress.phase("checking hierarchy");
    ASSIGN_OR_RETURN(const Manifest manifest, loadManifest(dataset));
    ASSIGN_OR_RETURN(const Hierarchy hierarchy, loadHierarchy(dataset, manifest));
    std::vector<std::unique_ptr<RandomAccessFile>> files;
    for (const DatasetFile& named : manifest.pageFiles) {
        ASSIGN_OR_RETURN(std::unique_ptr<RandomAccessFile> file, openForReading(dataset + "/" + named.name));
        files.push_back(std::move(file));
    }

    progress.phase("checking pages");
    Verification result;
    Verifier verifier(hierarchy);
    const std::vector<Share> shares = sharesOf(hierarchy);
    std::vector<std::byte> decoded;
    std::size_t next = 0;
    for (std::uint32_t p = 0; p < hierarchy.pages.size(); ++p) {
        const std::size_t first = next;
        while (next < shares.size() && shares[next].page == p) ++next;
        const PageRecord& record = hierarchy.pages[p];
        const auto table = readPage(*files[record.file], record, decoded);
        const std::optional<std::string> problem =
            table
                ? verifier.checkPage(record, *table, decoded, std::span(shares).subspan(first, next - first))
                : table.error().message;
        if (problem) {
            result.problems.push_back(fmt::format("{}/{}: page {} at byte {}: {}", dataset,
                                                  manifest.pageFiles[record.file].name, p, record.offset,
                                                  *problem));
        }
        ++result.pages;
        result.triangles += record.indexCount / 3;
        result.bytes += record.bytes;
        progress.done(static_cast<double>(p + 1) / static_cast<double>(hierarchy.pages.size()));
    }
    if (!result.problems.empty()) return result;  // the nodes' boxes would only follow
    for (const std::string& problem : verifier.checkNodes()) {
        result.problems.push_back(fmt::format("{}/{}: {}", dataset, manifest.hierarchy.name, problem));
    }
    return result;
}

}  // namespace iwalk
