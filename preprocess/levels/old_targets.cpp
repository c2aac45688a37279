// Morph blocks say where vertices go, but not which colours and normals they get there. These are looked up
// in the coarser entry: a triangle's image is there, with its corners' attributes.
#include "preprocess/levels/old_targets.hpp"

#include <algorithm>
#include <array>

#include "preprocess/levels/numbers.hpp"

namespace iwalk {
namespace {

using Corners = std::array<CellPoint, 3>;

struct CornersHash {
    std::size_t operator()(const Corners& c) const {
        return static_cast<std::size_t>(hashOf(c[0]) ^ 3 * hashOf(c[1]) ^ 7 * hashOf(c[2]));
    }
};

bool comesBefore(const CellPoint& a, const CellPoint& b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}

// Which corner of the triangle comes first, whatever it begins with.
std::size_t firstOf(const Corners& corners) {
    return static_cast<std::size_t>(std::ranges::min_element(corners, comesBefore) - corners.begin());
}

struct Attributes {
    std::uint32_t color = 0, normal = 0;
};

// The triangles of an entry: attributes of corners by the places of all three.
class AttributeTable {
  public:
    void add(const SourcePage& page, std::uint32_t firstIndex) {
        Corners corners;
        std::array<Attributes, 3> attributes;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint16_t vertex = page.indices[firstIndex + c];
            corners[c] = page.positions[vertex];
            if (!page.colors.empty()) attributes[c].color = page.colors[vertex];
            if (!page.normals.empty()) attributes[c].normal = page.normals[vertex];
        }
        const auto first = static_cast<std::ptrdiff_t>(firstOf(corners));
        std::rotate(corners.begin(), corners.begin() + first, corners.end());
        std::rotate(attributes.begin(), attributes.begin() + first, attributes.end());
        table_.try_emplace(corners, attributes);
    }

    // Of the corners in their order; nullopt when there is no such triangle.
    std::optional<std::array<Attributes, 3>> find(Corners corners) const {
        const auto first = static_cast<std::ptrdiff_t>(firstOf(corners));
        std::rotate(corners.begin(), corners.begin() + first, corners.end());
        const auto found = table_.find(corners);
        if (found == table_.end()) return std::nullopt;
        std::array<Attributes, 3> attributes = found->second;
        std::rotate(attributes.begin(), attributes.end() - first, attributes.end());
        return attributes;
    }

  private:
    std::unordered_map<Corners, std::array<Attributes, 3>, CornersHash> table_;
};

template <class Visit>
void forTriangles(const SourcePage& page, std::uint32_t firstRange, std::uint32_t count, Visit visit) {
    for (const Range& range : std::span(page.ranges).subspan(firstRange, count)) {
        for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; i += 3) visit(i);
    }
}

}  // namespace

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

Result<PageTargets> OldTargets::of(const StagePage& page, const SourcePage& source) const {
    PageTargets targets{{}, std::vector<float>(source.positions.size(), 0.0f), source.colors, source.normals};
    ASSIGN_OR_RETURN(targets.positions, store_.targets(page.record, source));
    for (const PageOwner& owner : page.owners) RETURN_IF_ERROR(addOwner(owner, source, targets));
    return targets;
}

// That the old node's entry of the next finer level turned into.
const LevelRecord& OldTargets::coarserEntry(std::uint32_t node) const {
    const std::vector<LevelRecord>& own = old_.model().entries[node];
    const auto found = std::ranges::find(own, static_cast<std::uint8_t>(level_), &LevelRecord::level);
    return found != own.end() ? *found : old_.model().entryAt(parents_[node], level_);
}

Result<void> OldTargets::addOwner(const PageOwner& owner, const SourcePage& source,
                                  PageTargets& targets) const {
    const LevelRecord& coarser = coarserEntry(model_.origin[owner.node]);
    forTriangles(source, owner.firstRange, owner.rangeCount, [&](std::uint32_t i) {
        for (std::size_t c = 0; c < 3; ++c) {
            float& error = targets.errors[source.indices[i + c]];
            error = std::max(error, coarser.error);
        }
    });
    if (source.colors.empty() && source.normals.empty()) return {};
    AttributeTable table;
    for (std::uint32_t number = coarser.firstPage; number < coarser.firstPage + coarser.pageCount; ++number) {
        ASSIGN_OR_RETURN(const std::shared_ptr<const SourcePage> page,
                         store_.get(number, writer_.records()[number]));
        const bool shared = coarser.pageCount == 1;
        forTriangles(*page, shared ? coarser.firstRange : 0u,
                     shared ? coarser.rangeCount : static_cast<std::uint32_t>(page->ranges.size()),
                     [&](std::uint32_t i) { table.add(*page, i); });
    }
    forTriangles(source, owner.firstRange, owner.rangeCount, [&](std::uint32_t i) {
        const std::uint16_t* const corner = &source.indices[i];
        const auto found = table.find(
            {targets.positions[corner[0]], targets.positions[corner[1]], targets.positions[corner[2]]});
        for (std::size_t c = 0; found && c < 3; ++c) {
            if (targets.positions[corner[c]] == source.positions[corner[c]]) continue;
            if (!source.colors.empty()) targets.colors[corner[c]] = (*found)[c].color;
            if (!source.normals.empty()) targets.normals[corner[c]] = (*found)[c].normal;
        }
    });
    return {};
}

}  // namespace iwalk
