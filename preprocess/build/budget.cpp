#include "preprocess/build/budget.hpp"

#include <algorithm>
#include <bit>
#include <thread>

#include "common/settings.hpp"
#include "preprocess/build/distribute_queue.hpp"
#include "preprocess/build/grid.hpp"

namespace iwalk {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
// The program itself, its libraries, the hierarchy as it grows, and what malloc keeps.
constexpr std::uint64_t kBaseBytes = 20 * kMiB;
// A thread that decides about a cell of levels, at worst: its mesh, what lies around each point, targets. One
// that builds pages takes half as much.
constexpr std::uint64_t kThreadBytes = 16 * kMiB;
constexpr std::uint64_t kMinBatchBytes = 12 * kMiB;
constexpr std::uint64_t kSinkBytes = 4 * kMiB;  // batches of triangles on their way

}  // namespace

Result<Budget> makeBudget(const BuildOptions& options) {
    if (options.memoryBytes < kMinMemoryBytes) {
        return fail("--memory {} is too little: at least {} are needed", formatBytes(options.memoryBytes),
                    formatBytes(kMinMemoryBytes));
    }
    // A twentieth stays free for what nobody foresaw.
    const std::uint64_t work = options.memoryBytes - options.memoryBytes / 20 - kBaseBytes;
    Budget budget;
    const std::uint64_t spillBytes = std::clamp<std::uint64_t>(work / 8, 4 * kMiB, 40 * kMiB);
    budget.chunkBytes = std::bit_floor(spillBytes / kGridBins);
    const unsigned wanted =
        options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    const std::uint64_t affordable = (work - kMinBatchBytes) / kThreadBytes;
    budget.threads = static_cast<unsigned>(std::clamp<std::uint64_t>(affordable, 1, wanted));
    budget.importerBytes =
        work - kGridBins * budget.chunkBytes - kSinkBytes - (batchesAtOnce(budget.threads) - 1) * kBatchBytes;
    budget.batchBytes = work - budget.threads * kThreadBytes;
    return budget;
}

}  // namespace iwalk
