#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "preprocess/import/spill_file.hpp"

namespace iwalk {

// Records of one fixed size: appended once, then read by index. They live in blocks of about 16 KiB; up to
// the memory limit all blocks stay in memory, beyond it the blocks used longest ago go to a spill file.
// Neighbours in index share a block, so a mesh whose faces use nearby vertices reads each block about once.
class RecordStore {
  public:
    // recordBytes in [1, 4096]; the limit counts the blocks, with a floor of 16 blocks, and a table of 4
    // bytes a block comes on top.
    RecordStore(std::size_t recordBytes, std::uint64_t memoryBytes, std::string spillDirectory);

    // Room for one more record, to be filled at once: the pointer is void after the next call.
    Result<std::byte*> append();
    std::uint64_t size() const { return size_; }  // records

    // Record `index` < size(), or null when its block is not in memory; void after the next load() or
    // append().
    const std::byte* find(std::uint64_t index) {
        const std::uint32_t slot = slotOf_[index >> shift_];
        if (slot == kNone) return nullptr;
        slots_[slot].used = true;
        return slots_[slot].bytes.get() + (index & mask_) * recordBytes_;
    }
    // The same, from the spill file where necessary.
    Result<const std::byte*> load(std::uint64_t index);

  private:
    static constexpr std::uint32_t kNone = 0xffffffff;
    struct Slot {
        std::unique_ptr<std::byte[]> bytes;
        std::uint64_t block = 0;
        bool used = true;    // since the clock's hand last came by
        bool dirty = false;  // not in the spill file yet
    };

    std::size_t blockBytes() const { return recordBytes_ << shift_; }
    Result<std::uint32_t> slotFor(std::uint64_t block);
    Result<std::uint32_t> evict();

    std::size_t recordBytes_;
    unsigned shift_ = 0;  // records in a block as a power of two
    std::uint64_t mask_ = 0, size_ = 0;
    std::size_t maxSlots_ = 0, hand_ = 0;
    std::vector<Slot> slots_;
    std::vector<std::uint32_t> slotOf_;  // by block
    std::string spillDirectory_;
    std::unique_ptr<SpillFile> spill_;  // made when the memory is first used up
};

}  // namespace iwalk
