#include "server/wall/assign.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace iwalk {
namespace {

using Numbers = std::vector<std::size_t>;

// What the wall file wants on one host, and who is there.
struct Host {
    std::string name;
    Numbers tiles, ranks;
};

std::string firstLabel(const std::string& host) {
    return host.substr(0, host.find('.'));
}

bool sameHost(const std::string& a, const std::string& b) {
    const bool whole = a.find('.') != std::string::npos && b.find('.') != std::string::npos;
    return whole ? a == b : firstLabel(a) == firstLabel(b);
}

Host* hostNamed(const std::string& name, std::vector<Host>& hosts) {
    const auto found =
        std::find_if(hosts.begin(), hosts.end(), [&](const Host& host) { return sameHost(host.name, name); });
    return found == hosts.end() ? nullptr : &*found;
}

std::vector<Host> hostsWanted(const Wall& wall, const std::vector<std::string>& ranks) {
    std::vector<Host> hosts;
    for (std::size_t tile = 0; tile < wall.tiles.size(); ++tile) {
        const std::string& name = wall.tiles[tile].host;
        if (name.empty()) continue;
        Host* known = hostNamed(name, hosts);
        (known ? *known : hosts.emplace_back(Host{name, {}, {}})).tiles.push_back(tile);
    }
    for (std::size_t rank = 0; rank < ranks.size(); ++rank)
        if (Host* host = hostNamed(ranks[rank], hosts)) host->ranks.push_back(rank);
    return hosts;
}

std::string countsOf(const std::vector<std::string>& hosts) {
    std::map<std::string, int> counts;
    for (const std::string& host : hosts) ++counts[host];
    std::string text;
    for (const auto& [host, count] : counts)
        text += fmt::format("{}{} on {}", text.empty() ? "" : ", ", count, host);
    return text;
}

// Contiguous parts of the tiles; where they are not even, the last ranks have one more: the first has the
// clients, too.
void share(const Numbers& tiles, const Numbers& ranks, std::vector<Numbers>& shares) {
    const std::size_t parts = std::min(tiles.size(), ranks.size());
    for (std::size_t i = 0; i < parts; ++i)
        for (std::size_t t = tiles.size() * i / parts; t < tiles.size() * (i + 1) / parts; ++t)
            shares[ranks[i]].push_back(tiles[t]);
}

}  // namespace

Result<std::vector<Numbers>> tilesOfRanks(const Wall& wall, const std::vector<std::string>& hosts) {
    CHECK_OP(hosts.size(), <=, wall.tiles.size());
    std::vector<Numbers> shares(hosts.size());
    for (const Host& host : hostsWanted(wall, hosts)) {
        if (host.ranks.empty())
            return fail(
                "the wall file wants tile '{}' on host '{}', where no rank is (ranks: {}): see mpirun's "
                "--hostfile",
                wall.tiles[host.tiles[0]].name, host.name, countsOf(hosts));
        share(host.tiles, host.ranks, shares);
    }

    Numbers anywhere, all(hosts.size()), left;
    for (std::size_t tile = 0; tile < wall.tiles.size(); ++tile)
        if (wall.tiles[tile].host.empty()) anywhere.push_back(tile);
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::copy_if(all.begin(), all.end(), std::back_inserter(left),
                 [&](std::size_t rank) { return shares[rank].empty(); });
    share(anywhere, left.empty() ? all : left, shares);

    for (std::size_t rank = 0; rank < shares.size(); ++rank) {
        if (shares[rank].empty())
            return fail(
                "the wall file has no tile for rank {} on host '{}' (ranks: {}): start fewer there, see "
                "mpirun's --hostfile",
                rank, hosts[rank], countsOf(hosts));
        std::sort(shares[rank].begin(), shares[rank].end());
    }
    return shares;
}

}  // namespace iwalk
