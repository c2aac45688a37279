#pragma once

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <vector>

#include "preprocess/build/distribute.hpp"
#include "preprocess/import/work_ring.hpp"

namespace iwalk {

// How many batches there are at once: enough to keep all threads busy. More than 8 would only wait, since one
// thread at a time puts them into bins.
inline std::size_t batchesAtOnce(unsigned threads) {
    return threads <= 1 ? 1 : std::min<std::size_t>(2 * std::size_t{threads}, 8);
}
inline constexpr std::size_t kBatchBytes = std::size_t{768} << 10;  // with its triangles as they are stored

// Hands batches from the thread that reads to a Distributor, which works on several at once. Their triangles
// come into the bins in the order in which they came. With one thread each batch is done at once.
class DistributeQueue {
  public:
    // To be used, up to its end, by one thread of the arena.
    DistributeQueue(Distributor& distributor, unsigned threads);

    // Takes the triangles and leaves another vector. Fails with the error of an earlier batch, if there was
    // one.
    Result<void> add(std::vector<Triangle>& triangles);
    // Waits for what was added.
    Result<void> finish();

  private:
    // Puts the batch into the bins, and all that wait for it, or leaves that to the thread that is at it.
    void appendPacked(std::size_t slot);
    void waitUntil(std::size_t appended);

    Distributor& distributor_;
    std::vector<PackedTriangles> slots_;
    std::size_t added_ = 0;  // batches
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<bool> packed_;  // by slot
    bool appending_ = false;    // some thread is
    std::size_t appended_ = 0;  // batches, whether they went well or not
    std::optional<Error> error_;
    WorkRing ring_;  // ends before what it works on
};

}  // namespace iwalk
