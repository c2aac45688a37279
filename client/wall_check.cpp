#include "client/wall_check.hpp"

#include <algorithm>
#include <set>
#include <string_view>

namespace iwalk::client {
namespace {

using protocol::TileInfo;

constexpr std::int64_t kMaxWallPixels = std::int64_t{1} << 30;
constexpr std::size_t kMaxNameBytes = 200;  // file names end at 255, and ours get a suffix

// Not std::isalnum: that depends on the locale.
bool safeCharacter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.' || c == '-';
}

bool safeName(std::string_view name) {
    return !name.empty() && name.size() <= kMaxNameBytes && name.front() != '.' && name != "wall" &&
           std::all_of(name.begin(), name.end(), safeCharacter);
}

bool inside(std::int64_t begin, std::int64_t length, std::int64_t end) {
    return begin >= 0 && begin + length <= end;
}

}  // namespace

Result<void> checkWall(const protocol::Welcome& welcome) {
    if (welcome.tiles.empty()) return fail("the server's wall has no tiles");
    if (std::int64_t{welcome.wallWidth} * welcome.wallHeight > kMaxWallPixels) {
        return fail("the server's wall of {} x {} px is too large", welcome.wallWidth, welcome.wallHeight);
    }
    const bool common = welcome.wallWidth > 0 && welcome.wallHeight > 0;
    std::set<std::string_view> names;
    for (const TileInfo& tile : welcome.tiles) {
        if (!safeName(tile.name))
            return fail("the server's tile name '{}' is not a safe file name", tile.name);
        if (!names.insert(tile.name).second) return fail("the server has two tiles named '{}'", tile.name);
        const bool fits =
            inside(tile.x, tile.width, welcome.wallWidth) && inside(tile.y, tile.height, welcome.wallHeight);
        if (common && !fits) return fail("the server's tile '{}' is not inside its wall", tile.name);
    }
    return {};
}

}  // namespace iwalk::client
