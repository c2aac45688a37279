#include "preprocess/build/verify_levels.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>

#include "preprocess/build/verify_nesting.hpp"

namespace iwalk {
namespace {

// Of an entry with more vertices only a share of the positions is kept.
constexpr std::uint64_t kMostPositions = std::uint64_t{1} << 20;

// An entry that turns into the one that is looked at.
struct Source {
    const LevelRecord* entry;
    std::optional<unsigned> octant;  // of the child that has it; none: the same node
};

std::vector<Source> sourcesOf(const Hierarchy& hierarchy, const NodeRecord& node, std::size_t e) {
    const std::span<const LevelRecord> entries = hierarchy.entriesOf(node);
    std::vector<Source> sources;
    if (e + 1 < entries.size()) sources.push_back({&entries[e + 1], std::nullopt});
    if (!Hierarchy::isWhole(node, entries[e])) return sources;
    std::uint32_t child = node.firstChild;
    for (unsigned octant = 0; octant < 8; ++octant) {
        if ((node.childMask >> octant & 1) == 0) continue;
        sources.push_back({&hierarchy.entriesOf(hierarchy.nodes[child++])[0], octant});
    }
    return sources;
}

// Calls visit(vertex) once for each that the ranges use.
template <class Visit>
void visitVertices(const PlainPage& page, std::size_t firstRange, std::size_t ranges, Visit visit) {
    std::vector<bool> seen(page.positions.size());
    for (const Range& range : std::span(page.ranges).subspan(firstRange, ranges)) {
        for (const std::uint16_t v : page.indicesOf(range)) {
            if (!seen[v]) visit(v);
            seen[v] = true;
        }
    }
}

// An entry, as the finer ones see it that turn into it.
class Image {
  public:
    static Result<Image> read(PageReader& reader, const LevelRecord& entry) {
        Image image;
        while (entry.vertices >> image.skip_ > kMostPositions) ++image.skip_;
        const auto add = [&](std::uint32_t, const PlainPage& page, std::size_t first,
                             std::size_t count) -> Result<void> {
            for (const Range& range : std::span(page.ranges).subspan(first, count)) {
                image.ranges_.add(CellPlace::of(range.path), page.box(range));
            }
            visitVertices(page, first, count, [&](std::uint16_t v) { image.add(page.positions[v]); });
            return {};
        };
        RETURN_IF_ERROR(visitPages(reader, entry, add));
        std::ranges::sort(image.positions_);
        return image;
    }

    // What is wrong with ranges of a finer page that turn into this.
    std::optional<std::string> check(const PlainPage& page, std::size_t first, std::size_t count,
                                     std::optional<unsigned> octant) const {
        std::vector<std::uint8_t> known(page.positions.size());  // targets that are here
        for (std::size_t r = first; r < first + count; ++r) {
            const Range& range = page.ranges[r];
            const CellPlace place = octant ? CellPlace::of(*octant, range.path) : CellPlace::of(range.path);
            const CoarseRanges::Found found = ranges_.find(place, page.box(range));
            if (!found.boxed) {
                return fmt::format("range {}: box reaches out of that of its range in the coarser level", r);
            }
            if (const auto problem = checkImages(page, range, found.contained, known)) {
                return fmt::format("range {}: {}", r, *problem);
            }
        }
        return std::nullopt;
    }

  private:
    static std::uint64_t hashOf(const LatticePoint& point) { return XXH64(&point, sizeof(point), 0); }
    bool inSample(std::uint64_t hash) const { return skip_ == 0 || hash >> (64 - skip_) == 0; }
    void add(const LatticePoint& position) {
        const std::uint64_t hash = hashOf(position);
        if (inSample(hash)) positions_.push_back(hash);
    }
    bool has(const LatticePoint& position) const {
        const std::uint64_t hash = hashOf(position);
        return !inSample(hash) || std::ranges::binary_search(positions_, hash);
    }

    // A triangle that stays one has its image here; what becomes a line or a point may be gone.
    std::optional<std::string> checkImages(const PlainPage& page, const Range& range, bool contained,
                                           std::vector<std::uint8_t>& known) const {
        const std::span<const std::uint16_t> corners = page.indicesOf(range);
        for (std::size_t i = 0; i < corners.size(); i += 3) {
            const auto target = [&](std::size_t c) -> const LatticePoint& {
                return page.targets[corners[i + c]];
            };
            if (target(0) == target(1) || target(1) == target(2) || target(2) == target(0)) continue;
            if (!contained) return "lies in no range of the coarser level";
            for (std::size_t c = 0; c < 3; ++c) {
                std::uint8_t& isKnown = known[corners[i + c]];
                if (isKnown == 0 && !has(target(c))) {
                    return fmt::format("vertex {} goes where the coarser level has none", corners[i + c]);
                }
                isKnown = 1;
            }
        }
        return std::nullopt;
    }

    CoarseRanges ranges_;
    std::vector<std::uint64_t> positions_;  // hashes, ascending
    unsigned skip_ = 0;                     // of 2^skip_ positions one is kept
};

// The coarsest level that a node's own triangles are at full resolution at, and one level finer too: from
// there on they stay. `morphs`: whether the pages of full have morph blocks.
unsigned firstHeldLevel(const Hierarchy& hierarchy, const NodeRecord& node, bool morphs) {
    const std::span<const LevelRecord> entries = hierarchy.entriesOf(node);
    if (entries.size() == 1) return node.depth;
    const LevelRecord& next = entries[entries.size() - 2];
    // An interior node's own triangles may be at full resolution in its whole entry already.
    return Hierarchy::isWhole(node, next) && !morphs ? node.depth : next.level + 1u;
}

}  // namespace

LevelChecker::LevelChecker(const Hierarchy& hierarchy, PageReader& reader, const TargetTable& targets)
    : hierarchy_(hierarchy), reader_(reader), targets_(targets) {
    for (const LevelRecord& entry : hierarchy.entries) {
        if (entry.level != kFullLevel) finestLevel_ = std::max(finestLevel_, unsigned{entry.level});
    }
}

Result<void> LevelChecker::check(std::uint32_t n, std::vector<LevelProblem>& problems) {
    const NodeRecord& node = hierarchy_.nodes[n];
    for (std::size_t e = 0; e < node.entryCount; ++e) RETURN_IF_ERROR(checkImages(node, e, problems));
    return checkHeld(node, problems);
}

Result<void> LevelChecker::checkImages(const NodeRecord& node, std::size_t e,
                                       std::vector<LevelProblem>& problems) {
    const std::vector<Source> sources = sourcesOf(hierarchy_, node, e);
    if (sources.empty()) return {};
    ASSIGN_OR_RETURN(const Image image, Image::read(reader_, hierarchy_.entriesOf(node)[e]));
    for (const Source& source : sources) {
        std::optional<LevelProblem> problem;
        const auto visit = [&](std::uint32_t p, const PlainPage& page, std::size_t first,
                               std::size_t count) -> Result<void> {
            if (problem) return {};
            const auto what = image.check(page, first, count, source.octant);
            if (what) problem = LevelProblem{p, *what};
            return {};
        };
        RETURN_IF_ERROR(visitPages(reader_, *source.entry, visit));
        if (problem) problems.push_back(std::move(*problem));
    }
    return {};
}

// What is at full resolution and stays there agrees with neighbours that move.
Result<void> LevelChecker::checkHeld(const NodeRecord& node, std::vector<LevelProblem>& problems) {
    const LevelRecord* const full = hierarchy_.fullEntryOf(node);
    if (full == nullptr) return {};
    std::optional<LevelProblem> problem;
    const auto visit = [&](std::uint32_t p, const PlainPage& page, std::size_t first,
                           std::size_t count) -> Result<void> {
        const unsigned firstLevel = firstHeldLevel(hierarchy_, node, page.morph.has_value());
        visitVertices(page, first, count, [&](std::uint16_t v) {
            for (unsigned level = firstLevel; level <= finestLevel_ && !problem; ++level) {
                if (targets_.stays(level, page.positions[v])) continue;
                problem = LevelProblem{
                    p,
                    fmt::format("vertex {} stays on the way to level {}, but not in another page", v, level)};
            }
        });
        return {};
    };
    RETURN_IF_ERROR(visitPages(reader_, *full, visit));
    if (problem) problems.push_back(std::move(*problem));
    return {};
}

}  // namespace iwalk
