#include "preprocess/build/page_writer.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

namespace iwalk {

Result<void> PageWriter::write(std::vector<PageJob> jobs, const EntryOf& entryOf, tbb::task_arena& arena) {
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
        for (BuiltPage& page : built) RETURN_IF_ERROR(append(page, entryOf));
    }
    return {};
}

Result<void> PageWriter::append(BuiltPage& page, const EntryOf& entryOf) {
    page.record.offset = file_.size();
    page.record.file = fileNumber_;
    RETURN_IF_ERROR(file_.write(page.bytes));
    const std::uint32_t number = static_cast<std::uint32_t>(records_.size());
    for (const NodeRanges& owner : page.nodes) {
        LevelRecord& entry = entryOf(owner);
        const bool first = entry.pageCount++ == 0;
        if (first) entry.firstPage = number;
        entry.firstRange = first ? static_cast<std::uint16_t>(owner.firstRange) : std::uint16_t{0};
        entry.rangeCount = first ? static_cast<std::uint16_t>(owner.rangeCount) : std::uint16_t{0};
        entry.triangles += owner.triangles;
        entry.vertices += owner.vertices;
    }
    RETURN_IF_ERROR(errors_.add(number, page.errors));
    records_.push_back(page.record);
    return {};
}

Result<void> PageWriter::appendMorph(std::uint32_t number, std::span<const std::byte> bytes) {
    records_[number].morphOffset = file_.size();
    records_[number].morphFile = fileNumber_;
    return file_.write(bytes);
}

}  // namespace iwalk
