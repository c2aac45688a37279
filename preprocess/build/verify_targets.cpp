#include "preprocess/build/verify_targets.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <bit>

namespace iwalk {
namespace {

constexpr std::size_t kMostSlots = std::size_t{1} << 23;

// Never 0. By the levels' numbers as seeds the same position at another level is another key.
std::uint64_t hashOf(const LatticePoint& point, unsigned seed) {
    return std::max<std::uint64_t>(XXH64(&point, sizeof(point), seed), 1);
}

std::size_t roomOf(std::size_t slots) {
    return slots / 4 * 3;
}

}  // namespace

TargetTable::TargetTable(std::uint64_t vertices) {
    while (vertices >> skip_ > roomOf(kMostSlots)) ++skip_;
    std::size_t slots = 16;
    while (slots < kMostSlots && vertices >> skip_ > roomOf(slots)) slots *= 2;
    slots_.resize(slots);
}

// Of the key, or the free one where it would be.
std::size_t TargetTable::find(std::uint64_t key) const {
    std::size_t at = key & (slots_.size() - 1);
    while (slots_[at].key != 0 && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
    return at;
}

bool TargetTable::add(unsigned level, const LatticePoint& position, const LatticePoint& target) {
    const std::uint64_t key = hashOf(position, level);
    if (!inSample(key)) return true;
    Slot& slot = slots_[find(key)];
    if (slot.key != 0) return slot.target == hashOf(target, 0);
    // Only hashes that were made to be in the sample could fill it.
    if (used_ >= slots_.size() / 8 * 7) return true;
    ++used_;
    slot = {key, hashOf(target, 0)};
    return true;
}

bool TargetTable::stays(unsigned level, const LatticePoint& position) const {
    const std::uint64_t key = hashOf(position, level);
    if (!inSample(key)) return true;
    const Slot& slot = slots_[find(key)];
    return slot.key == 0 || slot.target == hashOf(position, 0);
}

}  // namespace iwalk
