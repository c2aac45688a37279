#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>

#include "common/settings.hpp"
#include "preprocess/build/compact.hpp"
#include "preprocess/build/inputs.hpp"
#include "preprocess/command/commands.hpp"
#include "preprocess/command/progress_bar.hpp"

namespace iwalk {
namespace {

std::uint64_t peakMemory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

void printSummary(const Manifest& manifest, double seconds) {
    const std::uint64_t bytes = bytesOnDisk(manifest);
    const double triangles = static_cast<double>(manifest.triangles);
    fmt::print("{} triangles in {:.1f} s: {:.2f} Mtri/s, {:.2f} bytes/triangle ({}), peak memory {}\n",
               manifest.triangles, seconds, triangles / seconds / 1e6, static_cast<double>(bytes) / triangles,
               formatBytes(bytes), formatBytes(peakMemory()));
    std::uint64_t nonFinite = 0, degenerate = 0, split = 0, cut = 0;
    for (const Provenance& input : manifest.provenance) {
        nonFinite += input.droppedNonFinite;
        degenerate += input.droppedDegenerate;
        split += input.split;
        cut += input.cut;
    }
    if (nonFinite + degenerate > 0) {
        fmt::print(
            "left out: {} triangles with a corner that is not finite, {} with fewer than three distinct "
            "positions\n",
            nonFinite, degenerate);
    }
    if (split + cut > 0) {
        fmt::print(
            "too long for a page: {} triangles split; {} cut off far from the middle of the model (a coarser "
            "--step keeps more)\n",
            split, cut);
    }
}

// Does the work under a progress bar, and says what came of it.
template <class Work>
Result<void> run(Work work) {
    const auto began = std::chrono::steady_clock::now();
    Result<Manifest> manifest = [&] {
        ProgressBar progress;
        return work(progress);
    }();
    if (!manifest) return manifest.error();
    printSummary(*manifest, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    return {};
}

}  // namespace

Result<void> runBuild(BuildOptions options) {
    ASSIGN_OR_RETURN(options.inputs, findInputs(options.inputs));
    return run([&](Progress& progress) { return buildDataset(options, progress); });
}

Result<void> runInsert(BuildOptions options) {
    ASSIGN_OR_RETURN(options.inputs, findInputs(options.inputs));
    return run([&](Progress& progress) { return insertIntoDataset(options, progress); });
}

Result<void> runCompact(const std::string& dataset) {
    ASSIGN_OR_RETURN(const Manifest before, loadManifest(dataset));
    ProgressBar progress;
    ASSIGN_OR_RETURN(const Manifest after, compactDataset(dataset, progress));
    fmt::print("{} before, {} now\n", formatBytes(bytesOnDisk(before)), formatBytes(bytesOnDisk(after)));
    return {};
}

}  // namespace iwalk
