#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "preprocess/build/lattice.hpp"

namespace iwalk {

inline constexpr std::uint32_t kNoNumber = 0xffffffff;

inline std::uint64_t mixBits(std::uint64_t h) {
    h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
    h = (h ^ h >> 27) * 0x94d049bb133111ebu;
    return h ^ h >> 31;
}
inline std::uint64_t hashOf(const CellPoint& p) {
    return mixBits(p.x * 0x9e3779b97f4a7c15u ^ mixBits(p.y + 0x632be59bd9b4e019u) ^
                   p.z * 0xd6e8feb86659fd93u);
}
struct PointHash {
    std::size_t operator()(const CellPoint& p) const { return static_cast<std::size_t>(hashOf(p)); }
};

// Gives equal keys one number, in the order they come: a flat hash table with linear probing.
template <class Key, class Hash>
class Numbers {
  public:
    // The key's number, and whether it is new.
    std::pair<std::uint32_t, bool> add(const Key& key) {
        if (2 * keys_.size() >= table_.size()) grow();
        std::uint32_t& slot = table_[slotOf(key)];
        if (slot != kNoNumber) return {slot, false};
        slot = static_cast<std::uint32_t>(keys_.size());
        keys_.push_back(key);
        return {slot, true};
    }
    // Or kNoNumber.
    std::uint32_t find(const Key& key) const { return table_[slotOf(key)]; }
    const Key& operator[](std::uint32_t number) const { return keys_[number]; }
    std::size_t size() const { return keys_.size(); }
    void clear() {
        std::ranges::fill(table_, kNoNumber);
        keys_.clear();
    }

  private:
    // The key's, or the free one where it would go.
    std::size_t slotOf(const Key& key) const {
        const std::size_t mask = table_.size() - 1;
        std::size_t slot = Hash()(key) & mask;
        while (table_[slot] != kNoNumber && !(keys_[table_[slot]] == key)) slot = (slot + 1) & mask;
        return slot;
    }
    void grow() {
        table_.assign(4 * table_.size(), kNoNumber);
        for (std::uint32_t number = 0; number < keys_.size(); ++number)
            table_[slotOf(keys_[number])] = number;
    }

    std::vector<std::uint32_t> table_ = std::vector<std::uint32_t>(1024, kNoNumber);
    std::vector<Key> keys_;
};

}  // namespace iwalk
