#include "server/wall/toml_table.hpp"

#include <algorithm>
#include <cmath>

namespace iwalk {

std::string placeOf(const std::string& path, const toml::source_region& region) {
    return fmt::format("{}:{}:{}", path, region.begin.line, region.begin.column);
}

std::string TomlTable::place(const char* key) const {
    const toml::node* node = table_.get(key);
    return node ? placeOf(path_, node->source()) : place();
}

Result<void> TomlTable::refuseOthersThan(std::initializer_list<std::string_view> known) const {
    for (const auto& [key, node] : table_)
        if (std::find(known.begin(), known.end(), key.str()) == known.end())
            return fail("{}: {} knows no '{}'", placeOf(path_, key.source()), name_, key.str());
    return {};
}

Result<const toml::node*> TomlTable::find(const char* key) const {
    const toml::node* node = table_.get(key);
    if (!node) return fail("{}: {} has no '{}'", place(), name_, key);
    return node;
}

Result<int> TomlTable::whole(const toml::node& node, const char* key, int low, int high) const {
    const std::optional<std::int64_t> value = node.value_exact<std::int64_t>();
    if (!value || *value < low || *value > high)
        return fail("{}: '{}' wants whole numbers from {} to {}", placeOf(path_, node.source()), key, low,
                    high);
    return static_cast<int>(*value);
}

Result<double> TomlTable::number(const toml::node& node, const char* key, double low, double high) const {
    const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !(*value >= low && *value <= high))
        return fail("{}: '{}' wants numbers from {} to {}", placeOf(path_, node.source()), key, low, high);
    return *value;
}

Result<const toml::array*> TomlTable::numbers(const char* key, std::size_t count, const char* example) const {
    ASSIGN_OR_RETURN(const toml::node* const node, find(key));
    const toml::array* array = node->as_array();
    if (!array || array->size() != count)
        return fail("{}: '{}' wants {} numbers, as in {}", placeOf(path_, node->source()), key, count,
                    example);
    return array;
}

Result<int> TomlTable::integer(const char* key, int low, int high) const {
    ASSIGN_OR_RETURN(const toml::node* const node, find(key));
    return whole(*node, key, low, high);
}

Result<double> TomlTable::real(const char* key, double low, double high) const {
    ASSIGN_OR_RETURN(const toml::node* const node, find(key));
    return number(*node, key, low, high);
}

Result<glm::ivec2> TomlTable::integers(const char* key, int low, int high) const {
    ASSIGN_OR_RETURN(const toml::array* const array, numbers(key, 2, "[1024, 768]"));
    ASSIGN_OR_RETURN(const int x, whole(*array->get(0), key, low, high));
    ASSIGN_OR_RETURN(const int y, whole(*array->get(1), key, low, high));
    return glm::ivec2(x, y);
}

Result<glm::dvec2> TomlTable::pair(const char* key, double low, double high) const {
    ASSIGN_OR_RETURN(const toml::array* const array, numbers(key, 2, "[0.52, 0.29]"));
    ASSIGN_OR_RETURN(const double x, number(*array->get(0), key, low, high));
    ASSIGN_OR_RETURN(const double y, number(*array->get(1), key, low, high));
    return glm::dvec2(x, y);
}

Result<glm::dvec3> TomlTable::point(const char* key, double limit) const {
    ASSIGN_OR_RETURN(const toml::array* const array, numbers(key, 3, "[-1.5, 3, -1.5]"));
    glm::dvec3 point(0);
    for (std::size_t i = 0; i < 3; ++i) {
        ASSIGN_OR_RETURN(point[static_cast<glm::length_t>(i)], number(*array->get(i), key, -limit, limit));
    }
    return point;
}

// The nodes of a grid. `one`: what stands there is a single value.
Result<std::vector<const toml::node*>> TomlTable::gridOf(const char* key, int rows, int columns,
                                                         bool one) const {
    std::vector<const toml::node*> nodes;
    const toml::node* node = table_.get(key);
    const auto count = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
    if (one) return std::vector(count, node);
    const toml::array* lines = node->as_array();
    const auto refuse = [&](const toml::node& at) {
        return fail("{}: '{}' wants one value for all tiles, or {} rows of {}", placeOf(path_, at.source()),
                    key, rows, columns);
    };
    if (!lines || lines->size() != static_cast<std::size_t>(rows)) return refuse(*node);
    for (const toml::node& line : *lines) {
        const toml::array* values = line.as_array();
        if (!values || values->size() != static_cast<std::size_t>(columns)) return refuse(line);
        for (const toml::node& value : *values) nodes.push_back(&value);
    }
    return nodes;
}

Result<std::vector<std::string>> TomlTable::textsOf(const char* key, int rows, int columns) const {
    const toml::node* all = table_.get(key);
    if (!all) return std::vector<std::string>();
    ASSIGN_OR_RETURN(const std::vector<const toml::node*> nodes,
                     gridOf(key, rows, columns, all->is_string()));
    std::vector<std::string> texts;
    for (const toml::node* node : nodes) {
        const std::optional<std::string> text = node->value_exact<std::string>();
        const auto printable = [](char c) { return c > ' ' && c < 0x7f; };
        if (!text || text->empty() || text->size() > 200 ||
            !std::all_of(text->begin(), text->end(), printable))
            return fail("{}: '{}' wants texts of 1 to 200 letters without spaces",
                        placeOf(path_, node->source()), key);
        texts.push_back(*text);
    }
    return texts;
}

Result<std::vector<glm::ivec2>> TomlTable::placesOf(const char* key, int rows, int columns, int limit) const {
    const toml::node* all = table_.get(key);
    if (!all) return std::vector<glm::ivec2>();
    const bool one = all->is_array() && !all->as_array()->empty() && all->as_array()->get(0)->is_number();
    ASSIGN_OR_RETURN(const std::vector<const toml::node*> nodes, gridOf(key, rows, columns, one));
    std::vector<glm::ivec2> places;
    for (const toml::node* node : nodes) {
        const toml::array* numbers = node->as_array();
        if (!numbers || numbers->size() != 2)
            return fail("{}: '{}' wants places on a display, as in [1920, 0]", placeOf(path_, node->source()),
                        key);
        ASSIGN_OR_RETURN(const int x, whole(*numbers->get(0), key, -limit, limit));
        ASSIGN_OR_RETURN(const int y, whole(*numbers->get(1), key, -limit, limit));
        places.emplace_back(x, y);
    }
    return places;
}

}  // namespace iwalk
