#pragma once

#include <unordered_map>
#include <vector>

#include "common/protocol.hpp"
#include "common/settings.hpp"
#include "server/cache/page_cache.hpp"
#include "server/visibility/plp_visibility.hpp"

namespace iwalk {

// What one tile draws in `--mode plp`, from frame to frame: keeps the range tables of the last frame's
// candidates, so that a page need not be read again to know that it is not drawn.
class PlpFrame {
  public:
    // References are kept.
    PlpFrame(const Hierarchy& hierarchy, const FrustumVisibility& frustum, const Settings& settings);

    // Chooses what a frame draws. Takes the pages of candidates from the cache where it does not know their
    // tables, between two frames of its; adds times and counters to `stats`.
    void choose(const Cut& cut, const TileSight& sight, PageCache& cache, protocol::TileStats& stats);

    // What was chosen and has a range that meets the frustum (in steps, of a part of the tile), front to
    // back.
    std::vector<VisibleRanges> visible(const Frustum& frustum, const LatticeEye& eye) const;

  private:
    void readTables(const std::vector<std::uint32_t>& pages, PageCache& cache, protocol::TileStats& stats);

    const PlpVisibility plp_;
    std::unordered_map<std::uint32_t, PageTable> tables_;  // by page
    std::vector<VisibleRanges> chosen_;
};

}  // namespace iwalk
