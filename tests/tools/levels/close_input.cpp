#include "tests/tools/levels/close_input.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <utility>

namespace iwalk::levels {
namespace {

// A side of an input triangle.
struct Side {
    std::uint32_t low, high;  // places, in ascending order
    std::uint32_t range;      // that has it
    MorphVertex from, to;     // in the order in which it is passed
    bool upward() const { return from.place == low; }
};

void addSides(const CutRange& range, std::uint32_t number, std::vector<Side>& sides) {
    for (std::size_t i = 0; i < range.corners.size(); ++i) {
        const MorphVertex& from = range.corners[i];
        const MorphVertex& to = range.corners[i % 3 == 2 ? i - 2 : i + 1];
        const auto [low, high] = std::minmax(from.place, to.place);
        if (low != high) sides.push_back({low, high, number, from, to});
    }
}

// What is left over of sides that are passed more often one way than the other.
std::vector<Side> openSides(const RangeModel& model) {
    std::vector<Side> sides, open;
    for (std::uint32_t r = 0; r < model.ranges().size(); ++r) {
        if (model.ranges()[r].level == model.fullLevel()) addSides(model.ranges()[r], r, sides);
    }
    const auto edge = [](const Side& side) { return std::pair(side.low, side.high); };
    std::ranges::stable_sort(sides, {}, edge);
    for (auto begin = sides.begin(); begin != sides.end();) {
        const auto end =
            std::find_if(begin, sides.end(), [&](const Side& s) { return edge(s) != edge(*begin); });
        const auto upward = std::count_if(begin, end, [](const Side& side) { return side.upward(); });
        const auto downward = end - begin - upward;
        auto excess = std::abs(upward - downward);
        for (auto side = begin; side != end && excess > 0; ++side) {
            if (side->upward() != (upward > downward)) continue;
            open.push_back(*side);
            --excess;
        }
        begin = end;
    }
    return open;
}

// Vertices of every level by their place.
class Vertices {
  public:
    explicit Vertices(const RangeModel& model) {
        for (const CutRange& range : model.ranges()) {
            for (const MorphVertex& vertex : range.corners)
                byPlace_.try_emplace({range.next, vertex.place}, vertex);
        }
    }
    // The vertex at a place in ranges that morph to `next`; one that stays where it is when there is none.
    MorphVertex at(std::uint32_t place, int next) const {
        const auto found = byPlace_.find({next, place});
        return found != byPlace_.end() ? found->second : MorphVertex{place, place, 0};
    }

  private:
    std::map<std::pair<int, std::uint32_t>, MorphVertex> byPlace_;
};

}  // namespace

std::size_t closeInput(RangeModel& model) {
    const std::vector<Side> open = openSides(model);
    if (open.empty()) return 0;
    const Vertices vertices(model);
    const LatticePoint far(std::numeric_limits<std::int64_t>::max());
    for (const Side& side : open) {
        MorphVertex from = side.from, to = side.to;
        for (std::uint32_t r = side.range; r != kNoRange; r = model.ranges()[r].parent) {
            const MorphVertex apex = model.vertex(far, far, model.ranges()[r].next);
            for (const MorphVertex& corner : {to, from, apex}) model.ranges()[r].corners.push_back(corner);
            if (model.ranges()[r].parent == kNoRange) break;
            const int next = model.ranges()[model.ranges()[r].parent].next;
            from = vertices.at(from.target, next), to = vertices.at(to.target, next);
        }
    }
    return open.size();
}

}  // namespace iwalk::levels
