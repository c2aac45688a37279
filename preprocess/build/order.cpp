#include "preprocess/build/order.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "common/dataset/page.hpp"
#include "preprocess/build/grid.hpp"

namespace iwalk {
namespace {

struct Item {
    std::uint64_t key;
    std::uint32_t record;
};

constexpr unsigned kDigitBits = 8;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
constexpr std::size_t kSmall = 256;  // below, comparing is faster

// One stable counting pass; false when all digits are equal and nothing had to move.
bool countingPass(std::span<const Item> from, std::span<Item> to, unsigned shift) {
    std::array<std::size_t, kDigits> starts{};
    const auto digit = [shift](const Item& item) { return item.key >> shift & (kDigits - 1); };
    for (const Item& item : from) ++starts[digit(item)];
    if (starts[digit(from[0])] == from.size()) return false;
    std::size_t sum = 0;
    for (std::size_t& start : starts) sum += std::exchange(start, sum);
    for (const Item& item : from) to[starts[digit(item)]++] = item;
    return true;
}

void sortItems(std::vector<Item>& items) {
    if (items.size() < kSmall) {
        std::ranges::stable_sort(items, {}, &Item::key);
        return;
    }
    std::vector<Item> other(items.size());
    for (unsigned shift = 0; shift < kKeyBits; shift += kDigitBits) {
        if (countingPass(items, other, shift)) items.swap(other);
    }
}

class RangeCutter {
  public:
    RangeCutter(std::span<const std::uint64_t> keys, unsigned edgeLog2, unsigned leastLevels,
                const KeysAround& around)
        : keys_(keys),
          around_(around),
          axisBits_(std::min(edgeLog2, kMortonKeyBits / 3)),
          leastLevels_(leastLevels) {}

    void cut(std::size_t begin, std::size_t end) {
        const unsigned levels = commonLevels(keys_[begin], keys_[end - 1]);
        const std::uint32_t path = pathAt(keys_[begin], levels);
        if (levels == mostLevels()) return cutEvenly(begin, end, path);
        const auto outside = [&](const std::optional<std::uint64_t>& key) {
            return !key || pathAt(*key, levels) != path;
        };
        const bool fits = !isTooLarge(end - begin, levels, leastLevels_);
        if (fits && outside(around_.before) && outside(around_.after)) {
            runs_.push_back({end, path});
            return;
        }
        for (std::size_t from = begin; from < end;) {
            const std::uint32_t octant = pathAt(keys_[from], levels + 1);
            std::size_t to = from;
            while (to < end && pathAt(keys_[to], levels + 1) == octant) ++to;
            cut(from, to);
            from = to;
        }
    }
    std::vector<CellRun> take() { return std::move(runs_); }

  private:
    unsigned mostLevels() const { return std::min(axisBits_, kMaxPathLevels); }

    std::uint32_t pathAt(std::uint64_t key, unsigned levels) const {
        const std::uint64_t code = key >> (kKeyBits - kMortonKeyBits) >> 3 * (axisBits_ - levels);
        return static_cast<std::uint32_t>(std::uint64_t{1} << 3 * levels | code);
    }
    unsigned commonLevels(std::uint64_t a, std::uint64_t b) const {
        unsigned levels = mostLevels();
        while (pathAt(a, levels) != pathAt(b, levels)) --levels;
        return levels;
    }
    // Nothing tells these apart.
    void cutEvenly(std::size_t begin, std::size_t end, std::uint32_t path) {
        const std::size_t parts = (end - begin + kMaxRangeTriangles - 1) / kMaxRangeTriangles;
        for (std::size_t i = 1; i <= parts; ++i) runs_.push_back({begin + (end - begin) * i / parts, path});
    }

    std::span<const std::uint64_t> keys_;
    const KeysAround& around_;
    const unsigned axisBits_;  // of a key, in each axis
    const unsigned leastLevels_;
    std::vector<CellRun> runs_;
};

}  // namespace

void sortByKey(const RecordFormat& format, const std::uint32_t* records, unsigned edgeLog2,
               std::span<std::uint32_t> order) {
    std::vector<Item> items;
    items.reserve(order.size());
    for (const std::uint32_t record : order) {
        items.push_back({sortKey(format.place(records + record * format.words()), edgeLog2), record});
    }
    sortItems(items);
    std::ranges::transform(items, order.begin(), &Item::record);
}

std::vector<CellRun> cutRanges(std::span<const std::uint64_t> keys, unsigned edgeLog2, unsigned leastLevels,
                               const KeysAround& around) {
    RangeCutter cutter(keys, edgeLog2, leastLevels, around);
    if (!keys.empty()) cutter.cut(0, keys.size());
    return cutter.take();
}

}  // namespace iwalk
