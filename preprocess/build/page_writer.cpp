#include "preprocess/build/page_writer.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

namespace iwalk {

Result<void> PageWriter::write(std::vector<PageJob> jobs, Tree& tree, tbb::task_arena& arena) {
    // A few pages a thread at a time: what is built and not yet written stays small.
    const std::size_t step = 4 * static_cast<std::size_t>(arena.max_concurrency());
    for (std::size_t begin = 0; begin < jobs.size(); begin += step) {
        std::vector<BuiltPage> built(std::min(step, jobs.size() - begin));
        arena.execute([&] {
            tbb::parallel_for(std::size_t{0}, built.size(), [&](std::size_t i) {
                built[i] = buildPage(jobs[begin + i], lattice_, format_, attributes_);
                jobs[begin + i] = {};
            });
        });
        for (BuiltPage& page : built) RETURN_IF_ERROR(append(page, tree));
    }
    return {};
}

Result<void> PageWriter::append(BuiltPage& page, Tree& tree) {
    page.record.offset = file_.size();
    page.record.file = 0;
    RETURN_IF_ERROR(file_.write(page.bytes));
    const std::uint32_t number = static_cast<std::uint32_t>(records_.size());
    for (const NodeRanges& owner : page.nodes) {
        NodeRecord& node = tree[owner.node];
        const bool first = node.pageCount++ == 0;
        if (first) node.firstPage = number;
        node.firstRange = first ? static_cast<std::uint16_t>(owner.firstRange) : std::uint16_t{0};
        node.rangeCount = first ? static_cast<std::uint16_t>(owner.rangeCount) : std::uint16_t{0};
    }
    vertices_ += page.record.vertexCount;
    records_.push_back(page.record);
    return {};
}

}  // namespace iwalk
