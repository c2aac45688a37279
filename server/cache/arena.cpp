#include "server/cache/arena.hpp"

#include <algorithm>

#include "common/check.hpp"

namespace iwalk {

Arena::Arena(std::vector<std::span<std::byte>> banks, std::uint64_t alignment)
    : banks_(std::move(banks)), alignment_(alignment), freeByOffset_(banks_.size()) {
    for (std::uint32_t bank = 0; bank < banks_.size(); ++bank) {
        CHECK_OP(banks_[bank].size() % alignment_, ==, 0u);
        addFree(bank, 0, banks_[bank].size());
    }
}

std::optional<ArenaPlace> Arena::allocate(std::uint64_t bytes) {
    bytes = (bytes + alignment_ - 1) / alignment_ * alignment_;
    const auto fit = freeBySize_.lower_bound(Size{bytes, 0, 0});
    if (fit == freeBySize_.end()) return std::nullopt;
    const Size part = *fit;
    removeFree(part.bank, freeByOffset_[part.bank].find(part.offset));
    if (part.bytes > bytes) addFree(part.bank, part.offset + bytes, part.bytes - bytes);
    return ArenaPlace{part.bank, part.offset, bytes};
}

void Arena::free(const ArenaPlace& place) {
    std::map<std::uint64_t, std::uint64_t>& parts = freeByOffset_[place.bank];
    std::uint64_t offset = place.offset, bytes = place.bytes;

    // Join with the free part behind, then with the one in front.
    if (const auto next = parts.find(offset + bytes); next != parts.end()) {
        bytes += next->second;
        removeFree(place.bank, next);
    }
    if (const auto after = parts.lower_bound(offset); after != parts.begin()) {
        const auto before = std::prev(after);
        CHECK_OP(before->first + before->second, <=, offset);
        if (before->first + before->second == offset) {
            offset = before->first;
            bytes += before->second;
            removeFree(place.bank, before);
        }
    }
    addFree(place.bank, offset, bytes);
}

std::span<std::byte> Arena::memory(const ArenaPlace& place) const {
    return banks_[place.bank].subspan(place.offset, place.bytes);
}

std::uint64_t Arena::largestBank() const {
    std::uint64_t largest = 0;
    for (const std::span<std::byte>& bank : banks_) largest = std::max<std::uint64_t>(largest, bank.size());
    return largest;
}

std::uint64_t Arena::freeBytes() const {
    std::uint64_t sum = 0;
    for (const Size& part : freeBySize_) sum += part.bytes;
    return sum;
}

void Arena::addFree(std::uint32_t bank, std::uint64_t offset, std::uint64_t bytes) {
    if (bytes == 0) return;
    freeByOffset_[bank].emplace(offset, bytes);
    freeBySize_.insert({bytes, bank, offset});
}

void Arena::removeFree(std::uint32_t bank, std::map<std::uint64_t, std::uint64_t>::iterator part) {
    freeBySize_.erase({part->second, bank, part->first});
    freeByOffset_[bank].erase(part);
}

}  // namespace iwalk
