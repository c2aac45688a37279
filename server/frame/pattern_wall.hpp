#pragma once

#include <atomic>
#include <string>

#include "common/image.hpp"
#include "server/present/tile_output.hpp"
#include "server/sync/sync.hpp"

namespace iwalk {

struct PatternWallParts {
    Sync& sync;
    TileOutput& output;
    ColorImage picture;  // this tile's
    std::string file;    // --present file: where it is written; empty: it is in a window, and stays
    const std::atomic<bool>& stop;  // rank 0 ends the wall when it is set
};

// A wall that shows one picture: a test pattern. No dataset, no clients. Errors are of the file.
Result<void> showPattern(const PatternWallParts& parts);

}  // namespace iwalk
