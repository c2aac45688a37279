#pragma once

#include <cstdint>
#include <vector>

#include "common/settings.hpp"
#include "server/cache/page_cache.hpp"
#include "server/visibility/frustum_visibility.hpp"

namespace iwalk {

// What ranges are coloured by to be looked at (`--show ranges|levels|cache|priority`).
class Tints {
  public:
    Tints() = default;
    explicit Tints(const Hierarchy& hierarchy, Show show);

    explicit operator bool() const {
        return show_ != Show::none && show_ != Show::overdraw && show_ != Show::birdseye;
    }
    // Of a range of the page: RGBA8 in memory order, sRGB.
    std::uint32_t of(const ResidentPage& page, const DrawnRange& range) const;

  private:
    Show show_ = Show::none;
    std::vector<std::uint8_t> levels_;  // by page, for Show::levels
    unsigned finest_ = 0;               // of them
};

}  // namespace iwalk
