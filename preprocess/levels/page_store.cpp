#include "preprocess/levels/page_store.hpp"

#include <cstring>

namespace iwalk {

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
    RETURN_IF_ERROR(file_->readAt(record.offset, bytes));
    ASSIGN_OR_RETURN(PageTable table, decodePage(bytes, record, decoded));
    const PageLayout layout = pageLayout(record);
    SourcePage page;
    page.origin = CellPoint(table.origin - lattice_.rootCell);
    page.ranges = std::move(table.ranges);
    page.positions.reserve(record.vertexCount);
    for (std::uint32_t v = 0; v < record.vertexCount; ++v) {
        page.positions.push_back(page.origin + CellPoint(pageOffset(decoded, record, v)));
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
