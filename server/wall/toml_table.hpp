#pragma once

#include <toml++/toml.h>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

// Where in a file a value stands, for messages: FILE:LINE:COLUMN.
std::string placeOf(const std::string& path, const toml::source_region& region);

// One table of a wall file, read key by key. Errors name the place and what is wanted there.
class TomlTable {
  public:
    // `name` as people write it: "[wall]".
    TomlTable(const std::string& path, const toml::table& table, std::string name)
        : path_(path), table_(table), name_(std::move(name)) {}

    bool has(const char* key) const { return table_.get(key) != nullptr; }
    bool isText(const char* key) const { return table_.get_as<std::string>(key) != nullptr; }
    // A place in the file, of the table or one of its keys.
    std::string place() const { return placeOf(path_, table_.source()); }
    std::string place(const char* key) const;
    // A typo is an error, not ignored.
    Result<void> refuseOthersThan(std::initializer_list<std::string_view> known) const;

    Result<int> integer(const char* key, int low, int high) const;
    Result<double> real(const char* key, double low, double high) const;
    Result<glm::ivec2> integers(const char* key, int low, int high) const;
    Result<glm::dvec2> pair(const char* key, double low, double high) const;
    Result<glm::dvec3> point(const char* key, double limit) const;  // coordinates within +-limit

    // One value for each tile of a grid, row by row: the key has rows of values that lie as the tiles do, or
    // one value for all of them. No key: empty.
    Result<std::vector<std::string>> textsOf(const char* key, int rows, int columns) const;
    Result<std::vector<glm::ivec2>> placesOf(const char* key, int rows, int columns, int limit) const;

  private:
    Result<const toml::node*> find(const char* key) const;
    Result<std::vector<const toml::node*>> gridOf(const char* key, int rows, int columns, bool one) const;
    Result<double> number(const toml::node& node, const char* key, double low, double high) const;
    Result<int> whole(const toml::node& node, const char* key, int low, int high) const;
    Result<const toml::array*> numbers(const char* key, std::size_t count, const char* example) const;

    const std::string& path_;
    const toml::table& table_;
    std::string name_;
};

}  // namespace iwalk
