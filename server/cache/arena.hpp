#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

namespace iwalk {

// A place in the arena: bank and byte offset.
struct ArenaPlace {
    std::uint32_t bank = 0;
    std::uint64_t offset = 0, bytes = 0;
};

// Hands out parts of memory that somebody else owns (GPU buffers mapped by draw, in banks because one GL
// buffer may not be as large as the cache). Best fit; freed neighbours join. Not for several threads at once.
class Arena {
  public:
    // Every bank's size must be a multiple of `alignment` bytes, and places are.
    Arena(std::vector<std::span<std::byte>> banks, std::uint64_t alignment);

    // Nothing when no free part is large enough.
    std::optional<ArenaPlace> allocate(std::uint64_t bytes);
    void free(const ArenaPlace& place);

    std::span<std::byte> memory(const ArenaPlace& place) const;
    std::uint64_t largestBank() const;  // bytes: nothing larger can ever be allocated
    std::uint64_t freeBytes() const;

  private:
    struct Size {
        std::uint64_t bytes;
        std::uint32_t bank;
        std::uint64_t offset;
        auto operator<=>(const Size&) const = default;
    };
    void addFree(std::uint32_t bank, std::uint64_t offset, std::uint64_t bytes);
    void removeFree(std::uint32_t bank, std::map<std::uint64_t, std::uint64_t>::iterator part);

    std::vector<std::span<std::byte>> banks_;
    std::uint64_t alignment_;
    std::vector<std::map<std::uint64_t, std::uint64_t>> freeByOffset_;  // a bank: offset to bytes
    std::set<Size> freeBySize_;                                         // the same parts
};

}  // namespace iwalk
