#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/protocol.hpp"
#include "common/result.hpp"
#include "server/frame/frame_state.hpp"

namespace iwalk {

// Keeps the ranks of a wall together. Collective calls are made by all ranks in the same order. Nothing in
// here spins. In broadcast() and barrier() ranks sleep until they are woken; every other wait is polled with
// sleeps that grow from 20 us to 1 ms. What setIdleWork() gave is done meanwhile.
class Sync {
  public:
    static constexpr std::size_t kMaxText = 1023;
    virtual ~Sync() = default;

    virtual int rank() const = 0;
    virtual int size() const = 0;

    // Called while a collective call waits; may call sendToRank0() and poll().
    virtual void setIdleWork(std::function<void()> work) = 0;

    // True when every rank says true. When one says nothing for as long as startMpi() was told, rank 0 names
    // it and ends all.
    virtual bool agree(bool mine) = 0;
    // The host of each rank, on every rank.
    virtual const std::vector<std::string>& hosts() const = 0;
    // Every rank's text (its first kMaxText bytes), by rank, on every rank.
    virtual std::vector<std::string> gatherText(const std::string& mine) = 0;
    // Gives each rank another number, from 0 to size() - 1 and each once; rank() says so from then on.
    // `tiles`, the same on all ranks: how many each draws, by its new number.
    virtual void renumber(int rank, std::vector<int> tiles) = 0;

    // Any rank: asks rank 0 to end the wall. Rank 0: whether one has asked. Neither waits.
    virtual void askToStop() = 0;
    virtual bool askedToStop() = 0;

    // Gives rank 0's frame state to all when all have come.
    virtual void broadcast(FrameState& state) = 0;
    // Returns when all ranks have come here; the result is how long this one waited, in ms.
    virtual double barrier() = 0;
    // The figures of every rank's tiles, by rank, on rank 0; empty elsewhere.
    virtual std::vector<protocol::TileStats> gather(const std::vector<protocol::TileStats>& mine) = 0;

    // Sends a captured tile to rank 0 without waiting; the bytes are kept until they are there.
    virtual void sendToRank0(protocol::TileImage tile) = 0;
    // Rank 0: the captured tiles that have come in. Other ranks: nothing. Both: lets transfers go on.
    virtual std::vector<protocol::TileImage> poll() = 0;
};

// Initialises MPI (Open MPI) for one drawing thread; finalises it when destroyed. Only once in a process. A
// rank that is here when others have not even started within `timeout` (s) says so and ends, and all with it.
Result<std::unique_ptr<Sync>> startMpi(int& argc, char**& argv, int timeout);

}  // namespace iwalk
