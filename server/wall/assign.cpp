#include "server/wall/assign.hpp"

#include <map>

namespace iwalk {
namespace {

constexpr std::size_t kFree = static_cast<std::size_t>(-1);

std::string firstLabel(const std::string& host) {
    return host.substr(0, host.find('.'));
}

bool sameHost(const std::string& a, const std::string& b) {
    const bool whole = a.find('.') != std::string::npos && b.find('.') != std::string::npos;
    return whole ? a == b : firstLabel(a) == firstLabel(b);
}

std::string countsOf(const std::vector<std::string>& hosts) {
    std::map<std::string, int> counts;
    for (const std::string& host : hosts) ++counts[host];
    std::string text;
    for (const auto& [host, count] : counts)
        text += fmt::format("{}{} on {}", text.empty() ? "" : ", ", count, host);
    return text;
}

}  // namespace

Result<std::vector<std::size_t>> tilesOfRanks(const Wall& wall, const std::vector<std::string>& hosts) {
    CHECK_OP(wall.tiles.size(), ==, hosts.size());
    std::vector<std::size_t> tiles(hosts.size(), kFree);
    for (std::size_t tile = 0; tile < wall.tiles.size(); ++tile) {
        const std::string& wanted = wall.tiles[tile].host;
        if (wanted.empty()) continue;
        std::size_t rank = 0;
        while (rank < hosts.size() && (tiles[rank] != kFree || !sameHost(hosts[rank], wanted))) ++rank;
        if (rank == hosts.size())
            return fail(
                "the wall file wants tile '{}' on host '{}', where no rank is left for it (ranks: {}): see "
                "mpirun's "
                "--hostfile",
                wall.tiles[tile].name, wanted, countsOf(hosts));
        tiles[rank] = tile;
    }
    std::size_t rank = 0;
    for (std::size_t tile = 0; tile < wall.tiles.size(); ++tile) {
        if (!wall.tiles[tile].host.empty()) continue;
        while (tiles[rank] != kFree) ++rank;
        tiles[rank] = tile;
    }
    return tiles;
}

}  // namespace iwalk
