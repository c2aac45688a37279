#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "common/result.hpp"

namespace iwalk {

// The diffuse colours of an OBJ's material libraries.
class Materials {
  public:
    // RGBA8 of what has no colour of its own: Wavefront's default of 0.8.
    static constexpr std::uint32_t kGrey = 0xffcccccc;

    // Reads the library or libraries that the text behind `mtllib` in the OBJ file `objPath` names. A model
    // without its colours is better than none: whatever is wrong with a library is a warning. Only files in
    // the OBJ's folder and below it are opened.
    void load(const std::string& objPath, std::string_view names);

    // RGBA8 of the material; grey where there is none of that name, or it has no Kd.
    std::uint32_t color(std::string_view name) const;
    bool anyColor() const { return !colors_.empty(); }

  private:
    Result<void> loadFile(const std::string& path);

    std::unordered_set<std::string> opened_;                 // names
    std::unordered_map<std::string, std::uint32_t> colors_;  // of the materials with a Kd
};

}  // namespace iwalk
