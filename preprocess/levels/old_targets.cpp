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

void copy(const PageTargets& from, std::size_t a, PageTargets& to, std::size_t b) {
    to.positions[b] = from.positions[a];
    to.errors[b] = from.errors[a];
    if (!to.colors.empty()) to.colors[b] = from.colors[a];
    if (!to.normals.empty()) to.normals[b] = from.normals[a];
}

}  // namespace

std::optional<unsigned> oldLevel(const OldTree& old, unsigned level) {
    if (!old.exists() || level < old.grownBy()) return std::nullopt;
    return level - old.grownBy();
}

const LevelRecord* oldSource(const OldTree& old, const LevelModel& model, const Stage& stage,
                             const StagePage& page, const PageOwner& owner) {
    const std::optional<unsigned> level = oldLevel(old, stage.level);
    const std::uint32_t node = model.origin[owner.node];
    if (!level || node == OldTree::kNone) return nullptr;
    if (!page.held) return changingEntry(old.model(), node, *level);
    return isHeld(old.model(), node, *level) ? &old.model().entryAt(node, kFullLevel) : nullptr;
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
                             const std::function<bool(std::size_t)>& wanted, PageTargets& targets) const {
    for (const PageOwner& owner : page.owners) {
        const LevelRecord* const entry = oldSource(old_, model_, stage, page, owner);
        if (entry == nullptr) continue;
        const std::uint32_t oldNode = model_.origin[owner.node];
        Numbers<Vertex, VertexHash> numbers;
        PageTargets known;  // by number
        const auto add = [&](std::uint32_t number, const SourcePage& oldPage, std::uint32_t firstRange,
                             std::uint32_t rangeCount) -> Result<void> {
            if (!page.fresh && number != page.number) return {};
            ASSIGN_OR_RETURN(PageTargets went, ofPage(number, oldPage));
            std::ranges::fill(went.errors, coarserEntry(oldNode).error);
            RETURN_IF_ERROR(addAttributes(oldNode, oldPage, firstRange, rangeCount, went));
            forTriangles(oldPage, firstRange, rangeCount, [&](std::uint32_t i) {
                for (const std::uint16_t v : std::span(oldPage.indices).subspan(i, 3)) {
                    const auto [place, isNew] = numbers.add({oldPage.positions[v], attributesOf(oldPage, v)});
                    if (!isNew) continue;
                    known.positions.push_back(went.positions[v]);
                    known.errors.push_back(went.errors[v]);
                    known.colors.push_back(went.colors.empty() ? 0 : went.colors[v]);
                    known.normals.push_back(went.normals.empty() ? 0 : went.normals[v]);
                }
            });
            return {};
        };
        RETURN_IF_ERROR(forPages(*entry, writer_.records(), store_, add));
        forTriangles(source, owner.firstRange, owner.rangeCount, [&](std::uint32_t i) {
            for (const std::uint16_t v : std::span(source.indices).subspan(i, 3)) {
                if (!wanted(v)) continue;
                const std::uint32_t place = numbers.find({source.positions[v], attributesOf(source, v)});
                if (place != kNoNumber) copy(known, place, targets, v);
            }
        });
    }
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
