#pragma once

#include <cstdint>

namespace iwalk {

// Colours of heights, as in an atlas: blues below the sea's level, the darker the deeper; green, yellow,
// brown and white above it. They spread over what the map has, from its lowest to its highest.
class HeightRamp {
  public:
    // Of one unit; lowest <= highest, the sea's level anywhere.
    HeightRamp(double lowest, double seaLevel, double highest)
        : lowest_(lowest), seaLevel_(seaLevel), highest_(highest) {}

    // RGBA8; what lies at the sea's level is water.
    std::uint32_t color(double height) const;

  private:
    double lowest_, seaLevel_, highest_;
};

}  // namespace iwalk
