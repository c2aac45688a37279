// How fast models are read, to the doors of the leaves: both passes, with the triangles put on the lattice
// and into the bins of a build. Times of all processors together, in which other work on the machine does not
// count, and times by the clock.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <thread>

#include "preprocess/build/distribute_queue.hpp"
#include "preprocess/build/grid.hpp"
#include "preprocess/build/inputs.hpp"
#include "preprocess/build/reading_threads.hpp"
#include "preprocess/build/survey.hpp"
#include "tests/common/temp_directory.hpp"

namespace {

using namespace iwalk;

double processorSeconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Both kinds of seconds since it was made.
class Times {
  public:
    double processor() const { return processorSeconds() - processor_; }
    double clock() const { return std::chrono::duration<double>(Clock::now() - clock_).count(); }

  private:
    using Clock = std::chrono::steady_clock;
    double processor_ = processorSeconds();
    Clock::time_point clock_ = Clock::now();
};

// As a build reads, up to where it begins to build pages.
Result<void> measure(const std::string& path, unsigned threads) {
    const TempDirectory directory;
    BuildOptions options;
    options.inputs = {path};
    options.threads = threads;
    ASSIGN_OR_RETURN(const Budget budget, makeBudget(options));
    Inputs inputs(options, budget, directory.path(""), openImporter);
    const Times all;
    Sample sample;
    ASSIGN_OR_RETURN(const auto summaries, inputs.scan([&](auto points) { sample.add(points); }, {}));
    const double scanned = all.clock();
    ASSIGN_OR_RETURN(const Lattice lattice, chooseLattice(summaries, sample, {}));
    const RecordFormat format(lattice.rootCellLog2, summaries[0].colors, summaries[0].normals);
    ASSIGN_OR_RETURN(ChunkFile spill, ChunkFile::create(directory.path("triangles"), budget.chunkBytes));
    OldTree none;
    Distributor distributor(lattice, middleOf(sample, lattice.stepExponent), format, summaries[0].colors,
                            summaries[0].normals, spill, none);
    DistributeQueue queue(distributor, budget.threads);
    distributor.begin(path, summaries[0]);
    ASSIGN_OR_RETURN(const ImportCounts counts,
                     inputs.triangles(0, [&](auto& triangles) { return queue.add(triangles); }, {}));
    RETURN_IF_ERROR(queue.finish());
    if (auto bins = distributor.finish(); !bins) return bins.error();
    const double processor = all.processor(), clock = all.clock();
    const double megabytes = static_cast<double>(std::filesystem::file_size(path)) / 1e6;
    const double millions = static_cast<double>(counts.triangles) / 1e6;
    fmt::print("{}: {:.1f} MB, {} triangles, {} threads: ", path, megabytes, counts.triangles,
               budget.threads);
    fmt::print("processor {:.3f} s, {:.0f} MB/s, {:.2f} Mtri/s; ", processor, megabytes / processor,
               millions / processor);
    fmt::print("clock {:.3f} s ({:.3f} scanning), {:.0f} MB/s, {:.2f} Mtri/s\n", clock, scanned,
               megabytes / clock, millions / clock);
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("How fast models are read, to the doors of the leaves.");
    unsigned threads = 1;
    std::vector<std::string> files;
    app.add_option("--threads", threads, "that read; 0: as many as there are cores")->capture_default_str();
    app.add_option("files", files)->required();
    CLI11_PARSE(app, argc, argv);
    for (const std::string& file : files) {
        const unsigned all = std::max(1u, std::thread::hardware_concurrency());
        ReadingThreads readers(threads != 0 ? threads : all);
        const auto measured = readers.lead([&] { return measure(file, threads); });
        if (!measured)
            return fmt::print(stderr, "iwalk-import-rates: {}\n", measured.error().message), EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
