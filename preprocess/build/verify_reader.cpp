#include "preprocess/build/verify_reader.hpp"

#include <algorithm>
#include <cstring>

namespace iwalk {
namespace {

LatticeBox boxFrom(const std::uint32_t (&low)[3], const std::uint32_t (&high)[3],
                   const LatticePoint& origin) {
    return {origin + LatticePoint(low[0], low[1], low[2]), origin + LatticePoint(high[0], high[1], high[2])};
}

}  // namespace

LatticeBox PlainPage::box(const Range& range) const {
    return boxFrom(range.boxMin, range.boxMax, origin);
}

LatticeBox PlainPage::morphBox(std::size_t range) const {
    return boxFrom(morph->boxes[range].min, morph->boxes[range].max, morph->origin);
}

std::size_t PlainPage::bytes() const {
    return positions.size() * (2 * sizeof(LatticePoint) + 4) + indices.size() * 2 +
           ranges.size() * (sizeof(Range) + sizeof(MorphBox));
}

Result<PlainPage> PageReader::read(std::uint32_t number) const {
    const PageRecord& record = hierarchy_.pages[number];
    std::vector<std::byte> bytes(record.bytes), decoded(pageLayout(record).bytes);
    RETURN_IF_ERROR(files_[record.file]->readAt(record.offset, bytes));
    ASSIGN_OR_RETURN(PageTable table, decodePage(bytes, record, decoded));
    PlainPage page;
    page.positions = latticePositions(table, decoded, record);
    page.indices.resize(record.indexCount);
    std::memcpy(page.indices.data(), decoded.data() + pageLayout(record).indices, 2 * page.indices.size());
    if (record.morphBytes > 0) {
        bytes.resize(record.morphBytes);
        RETURN_IF_ERROR(files_[record.morphFile]->readAt(record.morphOffset, bytes));
        ASSIGN_OR_RETURN(page.morph, decodeMorph(bytes, record, table));
    }
    page.targets = page.morph ? targetsOf(*page.morph, page.positions) : page.positions;
    page.origin = table.origin;
    page.ranges = std::move(table.ranges);
    return page;
}

Result<std::shared_ptr<const PlainPage>> PageReader::get(std::uint32_t number) {
    const auto found = std::ranges::find(kept_, number, &Kept::number);
    if (found != kept_.end()) {
        kept_.splice(kept_.begin(), kept_, found);
        return kept_.front().page;
    }
    ASSIGN_OR_RETURN(PlainPage page, read(number));
    keptBytes_ += page.bytes();
    kept_.push_front({number, std::make_shared<const PlainPage>(std::move(page))});
    while (keptBytes_ > kMostBytes && kept_.size() > 1) {
        keptBytes_ -= kept_.back().page->bytes();
        kept_.pop_back();
    }
    return kept_.front().page;
}

}  // namespace iwalk
