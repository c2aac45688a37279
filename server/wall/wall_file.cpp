// Wall files as in config/: a regular wall is a grid of equal tiles; free screens are flat rectangles
// anywhere around the eye, each a grid of its own. docs/running-a-wall.md has every key.

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>
#include <sstream>

#include "common/file.hpp"
#include "common/protocol.hpp"
#include "common/settings.hpp"
#include "server/wall/toml_table.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {
namespace {

constexpr std::uint64_t kMaxWallFile = 1u << 20;
constexpr int kMaxTilesPerSide = 64;
constexpr int kMaxTilePx = 8192;    // so that a tile always fits in a window of half GL's largest viewport
constexpr int kMaxPlace = 1 << 16;  // px of an X display
constexpr double kMaxMetres = 1e4;
constexpr double kNearestScreen = 0.01;  // metres from the eye
constexpr double kRightAngle = 0.0175;   // cosine of 89 degrees

// How a flat screen is cut into equal tiles.
struct Grid {
    int rows = 1, columns = 1;
    glm::ivec2 tilePx{0};
    glm::ivec2 gap{0};  // px between neighbours, less than 0 where they overlap
    double gamma = 2.2;

    glm::ivec2 size() const { return glm::ivec2(columns, rows) * (tilePx + gap) - gap; }
    glm::dvec2 count() const { return {columns, rows}; }
};

// `tileMetres(bezelMetres)`: what a tile's picture measures, once the bezels are known.
template <class TileMetres>
Result<void> readGaps(const TomlTable& keys, Grid& grid, const TileMetres& tileMetres) {
    const int given = keys.has("bezel_px") + keys.has("bezel_m") + keys.has("overlap_px");
    const char* const last = keys.has("overlap_px") ? "overlap_px" : "bezel_m";
    if (given > 1) return fail("{}: one of bezel_px, bezel_m and overlap_px is enough", keys.place(last));
    if (keys.has("gamma") && !keys.has("overlap_px"))
        return fail("{}: 'gamma' goes with 'overlap_px'", keys.place("gamma"));
    if (keys.has("bezel_px")) {
        ASSIGN_OR_RETURN(grid.gap, keys.integers("bezel_px", 0, kMaxTilePx));
    }
    if (keys.has("bezel_m")) {
        ASSIGN_OR_RETURN(const glm::dvec2 bezel, keys.pair("bezel_m", 0, kMaxMetres));
        const glm::dvec2 px = bezel * glm::dvec2(grid.tilePx) / tileMetres(bezel);
        if (!(px.x >= 0 && px.y >= 0 && px.x <= kMaxTilePx && px.y <= kMaxTilePx))
            return fail("{}: such bezels leave no room for the tiles, or hide more than {} px",
                        keys.place("bezel_m"), kMaxTilePx);
        grid.gap = {std::lround(px.x), std::lround(px.y)};
    }
    if (keys.has("overlap_px")) {
        ASSIGN_OR_RETURN(const glm::ivec2 overlap, keys.integers("overlap_px", 0, kMaxTilePx));
        if (2 * overlap.x > grid.tilePx.x || 2 * overlap.y > grid.tilePx.y)
            return fail("{}: neighbours overlap by half a tile at most", keys.place("overlap_px"));
        grid.gap = -overlap;
    }
    if (keys.has("gamma")) {
        ASSIGN_OR_RETURN(grid.gamma, keys.real("gamma", 1, 3));
    }
    return {};
}

Result<void> readTileSize(const TomlTable& keys, Grid& grid) {
    ASSIGN_OR_RETURN(grid.tilePx, keys.integers("tile_px", 1, kMaxTilePx));
    return {};
}

Tile tileAt(const Grid& grid, int row, int column) {
    const glm::ivec2 at = glm::ivec2(column, row) * (grid.tilePx + grid.gap);
    Tile tile;
    tile.onScreen = {at.x, at.y, grid.tilePx.x, grid.tilePx.y};
    tile.blend.gamma = grid.gamma;
    if (column > 0) tile.blend.left = std::max(0, -grid.gap.x);
    if (column + 1 < grid.columns) tile.blend.right = std::max(0, -grid.gap.x);
    if (row > 0) tile.blend.top = std::max(0, -grid.gap.y);
    if (row + 1 < grid.rows) tile.blend.bottom = std::max(0, -grid.gap.y);
    return tile;
}

// A text names a screen's only tile, or with row and column each of several; rows of texts name each.
Result<std::vector<std::string>> namesOf(const TomlTable& keys, const Grid& grid) {
    ASSIGN_OR_RETURN(std::vector<std::string> names, keys.textsOf("name", grid.rows, grid.columns));
    if (keys.has("name") && !keys.isText("name")) return names;
    const std::string base = names.empty() ? "tile" : names[0];
    if (!names.empty() && grid.rows * grid.columns == 1) return names;
    names.clear();
    for (int row = 0; row < grid.rows; ++row)
        for (int column = 0; column < grid.columns; ++column)
            names.push_back(fmt::format("{}-{}-{}", base, row, column));
    return names;
}

// Names become file names.
Result<void> checkNames(const TomlTable& keys, const std::vector<std::string>& names) {
    const auto safe = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '.' || c == '-';
    };
    for (const std::string& name : names)
        if (name[0] == '.' || name == "wall" || !std::all_of(name.begin(), name.end(), safe))
            return fail(
                "{}: '{}' is no name for a tile: letters, digits, '_', '.' and '-', no '.' first, and not "
                "'wall'",
                keys.place("name"), name);
    return {};
}

// Adds the tiles of a screen to the wall. `keys` may say of each tile what it is called and where it is
// shown.
Result<void> addTiles(const TomlTable& keys, const Grid& grid, std::size_t screen, int left, Wall& wall) {
    ASSIGN_OR_RETURN(const std::vector<std::string> names, namesOf(keys, grid));
    RETURN_IF_ERROR(checkNames(keys, names));
    ASSIGN_OR_RETURN(const auto hosts, keys.textsOf("host", grid.rows, grid.columns));
    ASSIGN_OR_RETURN(const auto displays, keys.textsOf("display", grid.rows, grid.columns));
    ASSIGN_OR_RETURN(const auto monitors, keys.textsOf("monitor", grid.rows, grid.columns));
    ASSIGN_OR_RETURN(const auto windows, keys.placesOf("window", grid.rows, grid.columns, kMaxPlace));
    if (!monitors.empty() && !windows.empty())
        return fail("{}: a tile fills a 'monitor' or has a 'window', not both", keys.place("window"));
    for (std::size_t i = 0; i < names.size(); ++i) {
        const int at = static_cast<int>(i);
        Tile tile = tileAt(grid, at / grid.columns, at % grid.columns);
        tile.name = names[i];
        tile.screen = screen;
        tile.onWall = tile.onScreen;
        tile.onWall.x += left;
        if (!hosts.empty()) tile.host = hosts[i];
        if (!displays.empty()) tile.display = displays[i];
        if (!monitors.empty()) tile.monitor = monitors[i];
        if (!windows.empty()) tile.window = windows[i];
        wall.tiles.push_back(std::move(tile));
    }
    return {};
}

Result<void> regularWall(const TomlTable& keys, Wall& wall) {
    RETURN_IF_ERROR(
        keys.refuseOthersThan({"rows", "columns", "tile_px", "tile_m", "bezel_px", "bezel_m", "overlap_px",
                               "gamma", "name", "host", "display", "monitor", "window"}));
    Grid grid;
    ASSIGN_OR_RETURN(grid.rows, keys.integer("rows", 1, kMaxTilesPerSide));
    ASSIGN_OR_RETURN(grid.columns, keys.integer("columns", 1, kMaxTilesPerSide));
    RETURN_IF_ERROR(readTileSize(keys, grid));
    glm::dvec2 tileMetres(grid.tilePx);
    if (keys.has("tile_m")) {
        ASSIGN_OR_RETURN(tileMetres, keys.pair("tile_m", 1e-3, kMaxMetres));
    } else if (keys.has("bezel_m")) {
        return fail("{}: 'bezel_m' wants 'tile_m', the size of a tile's picture in metres",
                    keys.place("bezel_m"));
    }
    RETURN_IF_ERROR(readGaps(keys, grid, [&](const glm::dvec2&) { return tileMetres; }));
    const glm::dvec2 pixel = tileMetres / glm::dvec2(grid.tilePx);
    wall.pixelAspect = pixel.x / pixel.y;
    if (!(wall.pixelAspect > 0.1 && wall.pixelAspect < 10))
        return fail("{}: pixels of {:.3g} x {:.3g} mm are hardly meant", keys.place("tile_m"), 1000 * pixel.x,
                    1000 * pixel.y);
    wall.width = grid.size().x;
    wall.height = grid.size().y;
    return addTiles(keys, grid, 0, 0, wall);
}

// Corners in metres, seen from the eye.
Result<Screen> placeScreen(const TomlTable& keys, const glm::dvec3& eye) {
    Screen screen;
    ASSIGN_OR_RETURN(screen.topLeft, keys.point("top_left", kMaxMetres));
    ASSIGN_OR_RETURN(screen.topRight, keys.point("top_right", kMaxMetres));
    ASSIGN_OR_RETURN(screen.bottomLeft, keys.point("bottom_left", kMaxMetres));
    for (glm::dvec3* corner : {&screen.topLeft, &screen.topRight, &screen.bottomLeft}) *corner -= eye;
    const glm::dvec3 right = screen.topRight - screen.topLeft, up = screen.topLeft - screen.bottomLeft;
    const double width = glm::length(right), height = glm::length(up);
    if (!(width > 1e-3 && height > 1e-3))
        return fail("{}: the screen's corners lie together", keys.place("top_left"));
    if (std::abs(glm::dot(right, up)) > kRightAngle * width * height)
        return fail("{}: the screen's corners make no right angle", keys.place("top_left"));
    const double distance = -glm::dot(glm::normalize(glm::cross(right, up)), screen.topLeft);
    if (distance < kNearestScreen)
        return fail("{}: the eye stands {}: are the screen's left and right exchanged?",
                    keys.place("top_left"),
                    distance < 0 ? fmt::format("{:.3g} m behind the screen", -distance)
                                 : fmt::format("nearer to the screen's plane than {} m", kNearestScreen));
    return screen;
}

Result<void> addFreeScreen(const TomlTable& keys, const glm::dvec3& eye, Wall& wall) {
    RETURN_IF_ERROR(keys.refuseOthersThan({"name", "top_left", "top_right", "bottom_left", "rows", "columns",
                                           "tile_px", "bezel_px", "bezel_m", "overlap_px", "gamma", "host",
                                           "display", "monitor", "window"}));
    if (!keys.has("name")) return fail("{}: [[screen]] has no 'name'", keys.place());
    ASSIGN_OR_RETURN(Screen screen, placeScreen(keys, eye));
    Grid grid;
    if (keys.has("rows")) {
        ASSIGN_OR_RETURN(grid.rows, keys.integer("rows", 1, kMaxTilesPerSide));
    }
    if (keys.has("columns")) {
        ASSIGN_OR_RETURN(grid.columns, keys.integer("columns", 1, kMaxTilesPerSide));
    }
    RETURN_IF_ERROR(readTileSize(keys, grid));
    const glm::dvec2 metres(glm::distance(screen.topLeft, screen.topRight),
                            glm::distance(screen.topLeft, screen.bottomLeft));
    RETURN_IF_ERROR(readGaps(keys, grid, [&](const glm::dvec2& bezel) {
        return (metres - (grid.count() - 1.0) * bezel) / grid.count();
    }));
    screen.width = grid.size().x;
    screen.height = grid.size().y;
    const int left = wall.width;
    wall.width += screen.width;
    wall.height = std::max(wall.height, screen.height);
    wall.freeScreens.push_back(screen);
    return addTiles(keys, grid, wall.freeScreens.size() - 1, left, wall);
}

Result<void> freeWall(const std::string& path, const TomlTable& keys, const toml::node& node, Wall& wall) {
    const toml::array* screens = node.as_array();
    if (!screens || screens->empty() || !screens->is_homogeneous<toml::table>())
        return fail("{}: screens are tables: [[screen]]", placeOf(path, node.source()));
    RETURN_IF_ERROR(keys.refuseOthersThan({"eye"}));
    ASSIGN_OR_RETURN(const glm::dvec3 eye, keys.point("eye", kMaxMetres));
    for (const toml::node& screen : *screens) {
        const TomlTable table(path, *screen.as_table(), "[[screen]]");
        RETURN_IF_ERROR(addFreeScreen(table, eye, wall));
        if (wall.tiles.size() > protocol::kMaxTiles || wall.width > protocol::kMaxWallPx)
            return fail("{}: a wall has {} tiles and {} px side by side at most", table.place(),
                        protocol::kMaxTiles, protocol::kMaxWallPx);
    }
    return {};
}

// Settings are kept as text: what they mean is the settings table's business.
Result<void> readSettings(const std::string& path, const toml::table& table, Wall& wall) {
    for (const auto& [key, node] : table) {
        if (node.is_table() || node.is_array())
            return fail("{}: '{}' wants one value", placeOf(path, key.source()), key.str());
        std::string text;
        if (const auto* string = node.as_string()) {
            text = string->get();
        } else {
            std::ostringstream out;
            node.visit([&out](const auto& value) { out << value; });
            text = out.str();
        }
        Settings scratch;
        if (Result<void> set = setSetting(scratch, std::string(key.str()), text); !set)
            return fail("{}: {}", placeOf(path, key.source()), set.error().message);
        wall.settings.emplace_back(key.str(), text);
    }
    return {};
}

Result<Wall> interpret(const std::string& path, const toml::table& file) {
    const toml::table* wallTable = file["wall"].as_table();
    if (!wallTable) return fail("{}:1:1: a wall file begins with a [wall] table (see config/)", path);
    for (const auto& [key, node] : file)
        if ((key != "wall" && key != "settings" && key != "screen") || (key != "screen" && !node.is_table()))
            return fail("{}: a wall file has the tables [wall], [[screen]] and [settings], not '{}'",
                        placeOf(path, key.source()), key.str());
    Wall wall;
    const TomlTable keys(path, *wallTable, "[wall]");
    const toml::node* screens = file.get("screen");
    RETURN_IF_ERROR(screens ? freeWall(path, keys, *screens, wall) : regularWall(keys, wall));
    std::set<std::string> names;
    for (const Tile& tile : wall.tiles)
        if (!names.insert(tile.name).second)
            return fail("{}: two tiles are named '{}'", keys.place(), tile.name);
    if (const toml::table* settings = file["settings"].as_table())
        RETURN_IF_ERROR(readSettings(path, *settings, wall));
    return wall;
}

}  // namespace

Result<Wall> loadWall(const std::string& path) {
    ASSIGN_OR_RETURN(const std::string text, readWholeFile(path, kMaxWallFile));
    try {
        return interpret(path, toml::parse(text, path));
    } catch (const toml::parse_error& error) {
        return fail("{}: {}", placeOf(path, error.source()), error.description());
    }
}

}  // namespace iwalk
