// How fast models are read, to the doors of the leaves: both passes, with the triangles put on the lattice
// and into the bins of a build. Times of a processor, so that other work on the machine does not count.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "preprocess/build/distribute.hpp"
#include "preprocess/build/grid.hpp"
#include "preprocess/build/inputs.hpp"
#include "preprocess/build/survey.hpp"
#include "tests/common/temp_directory.hpp"

namespace {

using namespace iwalk;

double processorSeconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Result<void> measure(const std::string& path) {
    const TempDirectory directory;
    BuildOptions options;
    options.inputs = {path};
    ASSIGN_OR_RETURN(const Budget budget, makeBudget(options));
    Inputs inputs(options, budget, directory.path(""), openImporter);
    const double began = processorSeconds();
    Sample sample;
    ASSIGN_OR_RETURN(const auto summaries, inputs.scan([&](auto points) { sample.add(points); }, {}));
    const double scanned = processorSeconds();
    ASSIGN_OR_RETURN(const Lattice lattice, chooseLattice(summaries, sample, {}));
    const RecordFormat format(lattice.rootCellLog2, summaries[0].colors, summaries[0].normals);
    ASSIGN_OR_RETURN(ChunkFile spill, ChunkFile::create(directory.path("triangles"), budget.chunkBytes));
    OldTree none;
    Distributor distributor(lattice, middleOf(sample, lattice.stepExponent), format, summaries[0].colors,
                            summaries[0].normals, spill, none);
    distributor.begin(path, summaries[0]);
    ASSIGN_OR_RETURN(const ImportCounts counts,
                     inputs.triangles(0, [&](auto triangles) { return distributor.add(triangles); }, {}));
    if (auto bins = distributor.finish(); !bins) return bins.error();
    const double done = processorSeconds();
    const double megabytes = static_cast<double>(std::filesystem::file_size(path)) / 1e6;
    fmt::print("{}: {:.1f} MB, {} triangles: scan {:.2f} s, triangles {:.2f} s; {:.0f} MB/s, {:.2f} Mtri/s\n",
               path, megabytes, counts.triangles, scanned - began, done - scanned, megabytes / (done - began),
               static_cast<double>(counts.triangles) / (done - began) / 1e6);
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        const auto measured = measure(argv[i]);
        if (!measured)
            return fmt::print(stderr, "iwalk-import-rates: {}\n", measured.error().message), EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
