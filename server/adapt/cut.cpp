#include "server/adapt/cut.hpp"

namespace iwalk {

Cut fullResolution(const Hierarchy& hierarchy) {
    Cut cut;
    cut.drawn.reserve(hierarchy.nodes.size());
    for (const NodeRecord& node : hierarchy.nodes) cut.drawn.push_back(node.pageCount > 0);
    return cut;
}

}  // namespace iwalk
