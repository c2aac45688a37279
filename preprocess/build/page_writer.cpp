#include "preprocess/build/page_writer.hpp"

#include "preprocess/build/parallel.hpp"

namespace iwalk {

Result<void> PageWriter::write(std::vector<PageJob> jobs, const EntryOf& entryOf, tbb::task_arena& arena) {
    std::vector<BuiltPage> built(jobs.size());
    const auto build = [&](std::size_t i) -> Result<void> {
        built[i] = buildPage(jobs[i], lattice_, format_, attributes_);
        jobs[i] = {};
        return {};
    };
    const auto finish = [&](std::size_t i) {
        BuiltPage page = std::move(built[i]);
        return append(page, entryOf);
    };
    return orderedFor(arena, 0, jobs.size(), build, finish);
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
