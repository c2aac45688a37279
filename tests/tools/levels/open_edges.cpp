#include "tests/tools/levels/open_edges.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace iwalk::levels {
namespace {

// An edge by its ends in ascending order, and the way it is passed.
struct Passage {
    std::uint64_t edge;
    std::int64_t way;  // 1, -1; 0 where both ends are one
};

Passage passage(std::uint32_t from, std::uint32_t to) {
    const auto [low, high] = std::minmax(from, to);
    return {std::uint64_t{low} << 32 | high, from == to ? 0 : from < to ? 1 : -1};
}

// The passages of a triangle whose corners begin at i.
template <class Use>
void forSides(std::span<const std::uint32_t> corners, std::size_t i, const Use& use) {
    use(passage(corners[i], corners[i + 1]));
    use(passage(corners[i + 1], corners[i + 2]));
    use(passage(corners[i + 2], corners[i]));
}

// splitmix64's finalizer (Steele, Lea, Flood 2014).
std::uint64_t hashOf(std::uint64_t edge) {
    edge += 0x9e3779b97f4a7c15;
    edge = (edge ^ edge >> 30) * 0xbf58476d1ce4e5b9;
    edge = (edge ^ edge >> 27) * 0x94d049bb133111eb;
    return edge ^ edge >> 31;
}

bool isClosed(std::span<const std::uint32_t> corners) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        forSides(corners, i,
                 [&](const Passage& p) { sum += static_cast<std::uint64_t>(p.way) * hashOf(p.edge); });
    }
    return sum == 0;
}

}  // namespace

std::uint64_t openEdges(std::span<const std::uint32_t> corners) {
    if (isClosed(corners)) return 0;
    std::vector<Passage> passages;
    passages.reserve(corners.size());
    for (std::size_t i = 0; i < corners.size(); i += 3)
        forSides(corners, i, [&](const Passage& p) { passages.push_back(p); });
    std::ranges::sort(passages, {}, &Passage::edge);
    std::uint64_t open = 0;
    for (std::size_t begin = 0, end = 0; begin < passages.size(); begin = end) {
        std::int64_t balance = 0;
        for (; end < passages.size() && passages[end].edge == passages[begin].edge; ++end)
            balance += passages[end].way;
        open += balance != 0 ? 1 : 0;
    }
    return open;
}

}  // namespace iwalk::levels
