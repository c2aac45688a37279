#include "preprocess/build/order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

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

// Appends the ends of runs of keys[begin, end).
void split(std::span<const std::uint64_t> keys, std::size_t begin, std::size_t end,
           std::vector<std::size_t>& ends) {
    if (end - begin <= kMaxRangeTriangles) {
        ends.push_back(end);
        return;
    }
    const std::uint64_t difference = keys[begin] ^ keys[end - 1];
    if (difference == 0) {  // nothing to tell them apart
        const std::size_t middle = begin + (end - begin) / 2;
        split(keys, begin, middle, ends);
        split(keys, middle, end, ends);
        return;
    }
    const std::uint64_t bit = std::bit_floor(difference);
    const std::uint64_t border = (keys[end - 1] & ~(bit - 1));
    const auto middle = std::lower_bound(keys.begin() + static_cast<std::ptrdiff_t>(begin),
                                         keys.begin() + static_cast<std::ptrdiff_t>(end), border);
    const std::size_t at = static_cast<std::size_t>(middle - keys.begin());
    split(keys, begin, at, ends);
    split(keys, at, end, ends);
}

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

std::vector<std::size_t> cutRanges(std::span<const std::uint64_t> keys) {
    std::vector<std::size_t> ends;
    if (!keys.empty()) split(keys, 0, keys.size(), ends);
    std::vector<std::size_t> joined;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const bool last = i + 1 == ends.size();
        if (!last && ends[i + 1] - begin <= kMaxRangeTriangles) continue;
        joined.push_back(ends[i]);
        begin = ends[i];
    }
    return joined;
}

}  // namespace iwalk
