// Morph blocks say where vertices go, but not which colours and normals they get there. These are looked up
// in the coarser entry: a triangle's image is there, with its corners' attributes.
#include "preprocess/levels/old_targets.hpp"

#include <algorithm>

#include "preprocess/levels/entry_triangles.hpp"

namespace iwalk {
namespace {

// A vertex of an entry.
struct Vertex {
    CellPoint position;
    VertexAttributes attributes;
    bool operator==(const Vertex&) const = default;
};
struct VertexHash {
    std::size_t operator()(const Vertex& v) const {
        return static_cast<std::size_t>(
            hashOf(v.position) ^ mixBits(v.attributes.color | std::uint64_t{v.attributes.normal} << 32));
    }
};

// Entries of more pages than this are not compared with what they were: it would take too much memory. All of
// them counts as new.
constexpr std::uint32_t kMostPages = 8;

}  // namespace

// Where the vertices of an entry went.
struct OldTargets::Known {
    void add(const Vertex& vertex, std::size_t v, const PageTargets& went) {
        if (!numbers.add(vertex).second) return;
        targets.positions.push_back(went.positions[v]);
        targets.errors.push_back(went.errors[v]);
        if (!went.colors.empty()) targets.colors.push_back(went.colors[v]);
        if (!went.normals.empty()) targets.normals.push_back(went.normals[v]);
    }
    void set(const Vertex& vertex, std::size_t v, PageTargets& to) const {
        const std::uint32_t number = numbers.find(vertex);
        CHECK(number != kNoNumber);
        to.positions[v] = targets.positions[number];
        to.errors[v] = targets.errors[number];
        if (!to.colors.empty()) to.colors[v] = targets.colors[number];
        if (!to.normals.empty()) to.normals[v] = targets.normals[number];
    }

    Numbers<Vertex, VertexHash> numbers;
    PageTargets targets;  // by number
};

std::optional<unsigned> oldLevel(const OldTree& old, unsigned level) {
    if (!old.exists() || level < old.grownBy()) return std::nullopt;
    return level - old.grownBy();
}

const LevelRecord* oldSource(const OldTree& old, const LevelModel& model, const Stage& stage,
                             const StagePage& page, const PageOwner& owner) {
    const std::optional<unsigned> level = oldLevel(old, stage.level);
    const std::uint32_t node = model.origin[owner.node];
    if (!level || node == OldTree::kNone) return nullptr;
    const LevelRecord* entry = nullptr;
    if (!page.held) {
        entry = changingEntry(old.model(), node, *level);
    } else if (isHeld(old.model(), node, *level)) {
        entry = &old.model().entryAt(node, kFullLevel);
    }
    const bool isTooLarge = entry != nullptr && page.fresh && entry->pageCount > kMostPages;
    return isTooLarge ? nullptr : entry;
}

OldTargets::OldTargets(const OldTree& old, const LevelModel& model, const PageWriter& writer,
                       PageStore& store, unsigned level)
    : old_(old), model_(model), writer_(writer), store_(store), level_(level) {
    const std::vector<NodeRecord>& nodes = old.model().nodes;
    parents_.assign(nodes.size(), OldTree::kNone);
    for (std::uint32_t node = 0; node < nodes.size(); ++node) {
        const auto children = static_cast<std::size_t>(Hierarchy::childCount(nodes[node]));
        std::fill_n(parents_.begin() + nodes[node].firstChild, children, node);
    }
}

Result<void> OldTargets::set(const Stage& stage, const StagePage& page, const SourcePage& source,
                             const std::vector<bool>& decided, PageTargets& targets) const {
    for (const PageOwner& owner : page.owners) {
        const LevelRecord* const entry = oldSource(old_, model_, stage, page, owner);
        if (entry == nullptr) continue;  // then all of it is decided
        const std::uint32_t oldNode = model_.origin[owner.node];
        Known known;
        const auto add = [&](std::uint32_t number, const SourcePage& oldPage, std::uint32_t first,
                             std::uint32_t count) {
            return addKnown(oldNode, number, oldPage, first, count, known);
        };
        if (page.fresh) {
            RETURN_IF_ERROR(forPages(*entry, writer_.records(), store_, add));
        } else {
            RETURN_IF_ERROR(add(page.number, source, owner.firstRange, owner.rangeCount));
        }
        forTriangles(source, owner.firstRange, owner.rangeCount, [&](std::uint32_t i) {
            for (const std::uint16_t v : std::span(source.indices).subspan(i, 3)) {
                if (!decided[v]) known.set({source.positions[v], attributesOf(source, v)}, v, targets);
            }
        });
    }
    return {};
}

// The vertices of an old page's ranges, and where they went.
Result<void> OldTargets::addKnown(std::uint32_t oldNode, std::uint32_t number, const SourcePage& page,
                                  std::uint32_t firstRange, std::uint32_t rangeCount, Known& known) const {
    ASSIGN_OR_RETURN(PageTargets went, ofPage(number, page));
    std::ranges::fill(went.errors, coarserEntry(oldNode).error);
    RETURN_IF_ERROR(addAttributes(oldNode, page, firstRange, rangeCount, went));
    forTriangles(page, firstRange, rangeCount, [&](std::uint32_t i) {
        for (const std::uint16_t v : std::span(page.indices).subspan(i, 3)) {
            known.add({page.positions[v], attributesOf(page, v)}, v, went);
        }
    });
    return {};
}

// But for attributes and errors.
Result<PageTargets> OldTargets::ofPage(std::uint32_t number, const SourcePage& source) const {
    PageTargets targets{source.positions, std::vector<float>(source.positions.size(), 0.0f), source.colors,
                        source.normals};
    const PageRecord& record = writer_.records()[number];
    if (record.morphBytes > 0) {
        ASSIGN_OR_RETURN(targets.positions, store_.targets(record, source));
    }
    return targets;
}

// That the old node's entry of the next finer level turned into.
const LevelRecord& OldTargets::coarserEntry(std::uint32_t oldNode) const {
    const std::vector<LevelRecord>& own = old_.model().entries[oldNode];
    const auto found = std::ranges::find(own, static_cast<std::uint8_t>(level_), &LevelRecord::level);
    return found != own.end() ? *found : old_.model().entryAt(parents_[oldNode], level_);
}

Result<void> OldTargets::addAttributes(std::uint32_t oldNode, const SourcePage& source,
                                       std::uint32_t firstRange, std::uint32_t rangeCount,
                                       PageTargets& targets) const {
    if (source.colors.empty() && source.normals.empty()) return {};
    EntryTriangles coarser;
    RETURN_IF_ERROR(coarser.read(coarserEntry(oldNode), writer_.records(), store_));
    forTriangles(source, firstRange, rangeCount, [&](std::uint32_t i) {
        const std::uint16_t* const corner = &source.indices[i];
        const auto& positions = targets.positions;
        const auto found = coarser.find({positions[corner[0]], positions[corner[1]], positions[corner[2]]});
        for (std::size_t c = 0; found && c < 3; ++c) {
            if (positions[corner[c]] == source.positions[corner[c]]) continue;
            if (!source.colors.empty()) targets.colors[corner[c]] = (*found)[c].color;
            if (!source.normals.empty()) targets.normals[corner[c]] = (*found)[c].normal;
        }
    });
    return {};
}

}  // namespace iwalk
