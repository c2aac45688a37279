#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "common/image.hpp"
#include "server/present/tile_output.hpp"
#include "server/sync/sync.hpp"

namespace iwalk {

struct PatternTile {
    TileOutput& output;
    ColorImage picture;
    std::string file;  // --present file: where it is written; empty: all are in windows, and stay
};

struct PatternWallParts {
    Sync& sync;
    std::vector<PatternTile> tiles;  // this rank's
    const std::atomic<bool>& stop;   // rank 0 ends the wall when it is set
};

// A wall that shows one picture: a test pattern. No dataset, no clients. Errors are of the file.
Result<void> showPattern(const PatternWallParts& parts);

}  // namespace iwalk
