// Regular walls as in config/wall-2x2.toml: rows x columns of equal tiles, bezels between neighbours.

#include "server/wall/wall.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "common/file.hpp"
#include "common/settings.hpp"

namespace iwalk {
namespace {

constexpr std::uint64_t kMaxWallFile = 1u << 20;
constexpr int kMaxTilesPerSide = 64;
constexpr int kMaxTilePx = 8192;  // so that a tile always fits in a window of half GL's largest viewport

// Where in the file a value stands, for messages.
std::string place(const std::string& path, const toml::source_region& region) {
    return fmt::format("{}:{}:{}", path, region.begin.line, region.begin.column);
}

// One table of the file.
class Table {
  public:
    Table(const std::string& path, const toml::table& table, std::string name)
        : path_(path), table_(table), name_(std::move(name)) {}

    Result<int> integer(const char* key, int low, int high) const {
        const toml::node* node = table_.get(key);
        if (!node) return fail("{}: [{}] has no '{}'", place(path_, table_.source()), name_, key);
        return checked(*node, key, low, high);
    }

    Result<glm::ivec2> pair(const char* key, int low, int high, const glm::ivec2* fallback) const {
        const toml::node* node = table_.get(key);
        if (!node && fallback) return *fallback;
        if (!node) return fail("{}: [{}] has no '{}'", place(path_, table_.source()), name_, key);
        const toml::array* array = node->as_array();
        if (!array || array->size() != 2)
            return fail("{}: '{}' wants two numbers, as in [1024, 768]", place(path_, node->source()), key);
        ASSIGN_OR_RETURN(const int x, checked(*array->get(0), key, low, high));
        ASSIGN_OR_RETURN(const int y, checked(*array->get(1), key, low, high));
        return glm::ivec2(x, y);
    }

    // A typo is an error, not ignored.
    Result<void> refuseOthersThan(std::initializer_list<std::string_view> known) const {
        for (const auto& [key, node] : table_)
            if (std::find(known.begin(), known.end(), key.str()) == known.end())
                return fail("{}: [{}] knows no '{}'", place(path_, key.source()), name_, key.str());
        return {};
    }

  private:
    Result<int> checked(const toml::node& node, const char* key, int low, int high) const {
        const std::optional<std::int64_t> value = node.value_exact<std::int64_t>();
        if (!value || *value < low || *value > high)
            return fail("{}: '{}' wants whole numbers from {} to {}", place(path_, node.source()), key, low,
                        high);
        return static_cast<int>(*value);
    }

    const std::string& path_;
    const toml::table& table_;
    std::string name_;
};

std::vector<Tile> regularTiles(const Wall& wall) {
    std::vector<Tile> tiles;
    for (int row = 0; row < wall.rows; ++row)
        for (int column = 0; column < wall.columns; ++column) {
            const PixelRect rect{column * (wall.tilePx.x + wall.bezelPx.x),
                                 row * (wall.tilePx.y + wall.bezelPx.y), wall.tilePx.x, wall.tilePx.y};
            tiles.push_back({fmt::format("tile-{}-{}", row, column), 0, rect, rect});
        }
    return tiles;
}

Result<Wall> regularWall(const std::string& path, const toml::table& table) {
    Table keys(path, table, "wall");
    RETURN_IF_ERROR(keys.refuseOthersThan({"rows", "columns", "tile_px", "bezel_px"}));
    Wall wall;
    const glm::ivec2 noBezel(0, 0);
    ASSIGN_OR_RETURN(wall.rows, keys.integer("rows", 1, kMaxTilesPerSide));
    ASSIGN_OR_RETURN(wall.columns, keys.integer("columns", 1, kMaxTilesPerSide));
    ASSIGN_OR_RETURN(wall.tilePx, keys.pair("tile_px", 1, kMaxTilePx, nullptr));
    ASSIGN_OR_RETURN(wall.bezelPx, keys.pair("bezel_px", 0, kMaxTilePx, &noBezel));
    wall.width = wall.columns * (wall.tilePx.x + wall.bezelPx.x) - wall.bezelPx.x;
    wall.height = wall.rows * (wall.tilePx.y + wall.bezelPx.y) - wall.bezelPx.y;
    wall.tiles = regularTiles(wall);
    return wall;
}

// Settings are kept as text: what they mean is the settings table's business.
Result<void> readSettings(const std::string& path, const toml::table& table, Wall& wall) {
    for (const auto& [key, node] : table) {
        if (node.is_table() || node.is_array())
            return fail("{}: '{}' wants one value", place(path, key.source()), key.str());
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
            return fail("{}: {}", place(path, key.source()), set.error().message);
        wall.settings.emplace_back(key.str(), text);
    }
    return {};
}

Result<Wall> interpret(const std::string& path, const toml::table& file) {
    const toml::table* wallTable = file["wall"].as_table();
    if (!wallTable) return fail("{}:1:1: a wall file begins with a [wall] table (see config/)", path);
    for (const auto& [key, node] : file)
        if ((key != "wall" && key != "settings") || !node.is_table())
            return fail("{}: a wall file has the tables [wall] and [settings], not '{}'",
                        place(path, key.source()), key.str());
    ASSIGN_OR_RETURN(Wall wall, regularWall(path, *wallTable));
    if (const toml::table* settings = file["settings"].as_table())
        RETURN_IF_ERROR(readSettings(path, *settings, wall));
    return wall;
}

}  // namespace

std::vector<Screen> Wall::screens(double fovY) const {
    const double y = std::tan(fovY * std::numbers::pi / 360);
    const double x = y * width / height;
    Screen screen;
    screen.topLeft = {-x, y, -1};
    screen.topRight = {x, y, -1};
    screen.bottomLeft = {-x, -y, -1};
    screen.width = width;
    screen.height = height;
    return {screen};
}

Result<Wall> loadWall(const std::string& path) {
    ASSIGN_OR_RETURN(const std::string text, readWholeFile(path, kMaxWallFile));
    try {
        return interpret(path, toml::parse(text, path));
    } catch (const toml::parse_error& error) {
        return fail("{}: {}", place(path, error.source()), error.description());
    }
}

}  // namespace iwalk
