#include "preprocess/levels/page_store.hpp"

#include <algorithm>
#include <cstring>

#include "common/dataset/morph.hpp"

namespace iwalk {

Result<std::unique_ptr<PageStore>> PageStore::open(std::vector<std::string> paths, const Lattice& lattice,
                                                   std::size_t limitBytes) {
    auto store = std::unique_ptr<PageStore>(new PageStore(std::move(paths), lattice, limitBytes));
    for (const std::string& path : store->paths_) {
        ASSIGN_OR_RETURN(std::unique_ptr<RandomAccessFile> file, openForReading(path));
        store->files_.push_back(std::move(file));
    }
    return store;
}

Result<std::shared_ptr<const SourcePage>> PageStore::get(std::uint32_t number, const PageRecord& record) {
    {
        const std::lock_guard lock(mutex_);
        const auto found = pages_.find(number);
        if (found != pages_.end()) {
            used_.splice(used_.begin(), used_, found->second.used);
            return found->second.page;
        }
    }
    // Two threads may read a page at once; that is rarer than it would be dear to wait.
    ASSIGN_OR_RETURN(SourcePage page, read(record));
    auto shared = std::make_shared<const SourcePage>(std::move(page));
    keep(number, shared);
    return std::shared_ptr<const SourcePage>(shared);
}

Result<SourcePage> PageStore::read(const PageRecord& record) const {
    std::vector<std::byte> bytes(record.bytes), decoded(pageLayout(record).bytes);
    RETURN_IF_ERROR(files_[record.file]->readAt(record.offset, bytes));
    Result<PageTable> decodedTable = decodePage(bytes, record, decoded);
    if (!decodedTable) return damaged(record.file, record.offset, decodedTable.error());
    PageTable table = std::move(*decodedTable);
    const PageLayout layout = pageLayout(record);
    SourcePage page;
    page.origin = CellPoint(table.origin - lattice_.rootCell);
    page.ranges = std::move(table.ranges);
    page.positions.reserve(record.vertexCount);
    for (std::uint32_t v = 0; v < record.vertexCount; ++v) {
        page.positions.push_back(page.origin + CellPoint(pageOffset(decoded, record, v)));
    }
    if (!isInRoot(page.positions)) {
        return damaged(record.file, record.offset, fail("reaches out of the root's cell"));
    }
    const auto copy = [&](auto& to, std::uint32_t from, std::size_t count) {
        to.resize(count);
        std::memcpy(to.data(), decoded.data() + from, count * sizeof(to[0]));
    };
    if ((record.flags & kPageColors) != 0) copy(page.colors, layout.colors, record.vertexCount);
    if ((record.flags & kPageNormals) != 0) copy(page.normals, layout.normals, record.vertexCount);
    copy(page.indices, layout.indices, record.indexCount);
    return page;
}

Result<std::vector<CellPoint>> PageStore::targets(const PageRecord& record, const SourcePage& page) const {
    std::vector<std::byte> bytes(record.morphBytes);
    RETURN_IF_ERROR(files_[record.morphFile]->readAt(record.morphOffset, bytes));
    const PageTable table{lattice_.fromCell(page.origin), page.ranges};
    const Result<PageMorph> morph = decodeMorph(bytes, record, table);
    if (!morph) return damaged(record.morphFile, record.morphOffset, morph.error());
    std::vector<CellPoint> targets;
    targets.reserve(page.positions.size());
    for (std::size_t v = 0; v < page.positions.size(); ++v) {
        const std::uint32_t number = morph->numbers[v];
        targets.push_back(number < page.positions.size()
                              ? page.positions[number]
                              : CellPoint(morph->origin - lattice_.rootCell +
                                          LatticePoint(morph->extras[number - page.positions.size()])));
    }
    if (isInRoot(targets)) return targets;
    return damaged(record.morphFile, record.morphOffset, fail("reaches out of the root's cell"));
}

bool PageStore::isInRoot(const std::vector<CellPoint>& points) const {
    const std::uint64_t edge = std::uint64_t{1} << lattice_.rootCellLog2;
    return std::ranges::all_of(points,
                               [&](const CellPoint& p) { return p.x < edge && p.y < edge && p.z < edge; });
}

Error PageStore::damaged(std::size_t file, std::uint64_t offset, const Error& error) const {
    return fail("{}: page or morph block at byte {}: {}; the dataset is damaged: build it again",
                paths_[file], offset, error.message);
}

void PageStore::keep(std::uint32_t number, std::shared_ptr<const SourcePage> page) {
    const std::lock_guard lock(mutex_);
    if (pages_.contains(number)) return;
    held_ += page->bytes();
    used_.push_front(number);
    pages_.emplace(number, Entry{std::move(page), used_.begin()});
    while (held_ > limit_ && used_.size() > 1) {
        const auto oldest = pages_.find(used_.back());
        held_ -= oldest->second.page->bytes();
        pages_.erase(oldest);
        used_.pop_back();
    }
}

}  // namespace iwalk
