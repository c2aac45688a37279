#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "server/frame/last_state.hpp"
#include "server/frame/rank_tiles.hpp"
#include "server/gateway/gateway.hpp"
#include "server/present/tile_output.hpp"
#include "server/sync/sync.hpp"

namespace iwalk {

// What a rank's frame loop works with; all outlive it.
struct FrameLoopParts {
    Sync& sync;
    std::vector<std::size_t> numbers;                   // of the tiles that this rank draws
    RankTiles& tiles;                                   // in this order
    std::vector<std::unique_ptr<TileOutput>>& outputs;  // likewise
    Gateway* gateway = nullptr;                         // on rank 0
    std::string outputDirectory;  // --present file: where tiles are written; empty: nowhere
    LastState& last;              // rank 0's; others keep nothing
    std::optional<Camera> begin;  // rank 0: to be drawn before a client asks for anything
    const Dataset& dataset;
    const Wall& wall;
    Settings settings;              // to begin with
    const std::atomic<bool>& stop;  // rank 0 ends the wall when it is set
};

// The way of a frame, again and again: frame state from the gateway (rank 0) to all ranks, draw every tile,
// meet at the barrier, present, report. Nothing is drawn while no client asks for anything new.
void runFrames(const FrameLoopParts& parts);

}  // namespace iwalk
