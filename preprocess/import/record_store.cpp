// Blocks are replaced by the clock algorithm (second chance), the usual cheap stand-in for least recently
// used: a hit costs one store, where a true LRU list would cost six.
#include "preprocess/import/record_store.hpp"

#include <algorithm>
#include <span>

namespace iwalk {
namespace {
// Larger blocks read sequential data in fewer calls; smaller ones waste less when faces jump about.
constexpr std::size_t kBlockBytes = std::size_t{16} << 10;
constexpr std::size_t kMinSlots = 16;
}  // namespace

RecordStore::RecordStore(std::size_t recordBytes, std::uint64_t memoryBytes, std::string spillDirectory)
    : recordBytes_(recordBytes), spillDirectory_(std::move(spillDirectory)) {
    CHECK_OP(recordBytes, >, 0u);
    CHECK_OP(recordBytes, <=, 4096u);
    while ((recordBytes_ << (shift_ + 1)) <= kBlockBytes) ++shift_;
    mask_ = (std::uint64_t{1} << shift_) - 1;
    maxSlots_ = std::max(kMinSlots, static_cast<std::size_t>(memoryBytes / (blockBytes() + sizeof(Slot))));
}

Result<std::byte*> RecordStore::append() {
    const std::uint64_t block = size_ >> shift_;
    if (block == slotOf_.size()) {
        ASSIGN_OR_RETURN(const std::uint32_t fresh, slotFor(block));
        slotOf_.push_back(fresh);
    }
    // The last block can only have left memory through reads between appends.
    if (slotOf_[block] == kNone) {
        if (auto tail = load(size_); !tail) return tail.error();
    }
    Slot& slot = slots_[slotOf_[block]];
    slot.dirty = true;
    return slot.bytes.get() + (size_++ & mask_) * recordBytes_;
}

Result<const std::byte*> RecordStore::load(std::uint64_t index) {
    if (const std::byte* record = find(index)) return record;
    const std::uint64_t block = index >> shift_;
    ASSIGN_OR_RETURN(const std::uint32_t slot, slotFor(block));
    RETURN_IF_ERROR(spill_->readAt(block * blockBytes(), std::span(slots_[slot].bytes.get(), blockBytes())));
    slotOf_[block] = slot;
    return find(index);
}

// A slot for a block that is not in memory: a new one below the limit, else the one used longest ago.
Result<std::uint32_t> RecordStore::slotFor(std::uint64_t block) {
    auto slot = static_cast<std::uint32_t>(slots_.size());
    if (slots_.size() < maxSlots_) {
        slots_.push_back({std::make_unique<std::byte[]>(blockBytes())});
    } else {
        ASSIGN_OR_RETURN(slot, evict());
    }
    slots_[slot].block = block;
    slots_[slot].used = true;
    return slot;
}

Result<std::uint32_t> RecordStore::evict() {
    while (slots_[hand_].used) {
        slots_[hand_].used = false;
        hand_ = (hand_ + 1) % slots_.size();
    }
    Slot& slot = slots_[hand_];
    if (slot.dirty) {
        if (!spill_) {
            ASSIGN_OR_RETURN(spill_, SpillFile::create(spillDirectory_));
        }
        RETURN_IF_ERROR(
            spill_->writeAt(slot.block * blockBytes(), std::span(slot.bytes.get(), blockBytes())));
        slot.dirty = false;
    }
    slotOf_[slot.block] = kNone;
    const auto freed = static_cast<std::uint32_t>(hand_);
    hand_ = (hand_ + 1) % slots_.size();
    return freed;
}

}  // namespace iwalk
