#include "server/adapt/cut.hpp"

namespace iwalk {

Cut cutAtLevel(const Hierarchy& hierarchy, unsigned level) {
    Cut cut;
    cut.entry.reserve(hierarchy.nodes.size());
    for (const NodeRecord& node : hierarchy.nodes) {
        const LevelRecord* entry = hierarchy.drawnAt(node, level);
        const auto index =
            entry != nullptr ? entry - hierarchy.entries.data() : std::ptrdiff_t{Cut::kNothing};
        cut.entry.push_back(static_cast<std::uint32_t>(index));
    }
    return cut;
}

}  // namespace iwalk
