// The whole of a build: look at the inputs, put their triangles on the lattice and into bins on disk, then
// turn bins into octree and pages, and commit. Reading knows nothing of pages, and building nothing of
// inputs.
#include "preprocess/build/build.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "preprocess/build/assemble.hpp"
#include "preprocess/build/distribute.hpp"
#include "preprocess/build/grid.hpp"
#include "preprocess/build/output_directory.hpp"
#include "preprocess/build/pipeline.hpp"
#include "preprocess/build/survey.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kMinLeafTriangles = 16, kMaxLeafTriangles = 65536;
// In memory a triangle also has its place in the order (twice), its bin, and a sort key while its node is
// sorted.
constexpr std::size_t kBatchOverheadBytes = 4 + 4 + 2 + 32;

class Build {
  public:
    Build(const BuildOptions& options, const Budget& budget, const BuildParts& parts, OutputDirectory& output,
          Progress& progress)
        : options_(options),
          budget_(budget),
          parts_(parts),
          output_(output),
          progress_(progress),
          inputs_(options.inputs, budget, output.temporaryDirectory(), parts.openImporter) {}

    Result<Manifest> run() {
        RETURN_IF_ERROR(scan());
        const RecordFormat format(lattice_.rootCellLog2, manifest_.colors, manifest_.normals);
        const std::size_t chunkBytes = parts_.chunkBytes != 0 ? parts_.chunkBytes : budget_.chunkBytes;
        ASSIGN_OR_RETURN(ChunkFile spill, ChunkFile::create(output_.temporary("triangles"), chunkBytes));
        ASSIGN_OR_RETURN(std::vector<Bin> bins, distribute(format, spill));
        RETURN_IF_ERROR(assemble(format, spill, std::move(bins)));
        progress_.phase("committing");
        RETURN_IF_ERROR(output_.commit(manifest_));
        return manifest_;
    }

  private:
    ProgressSink part() {
        return [this](double done) { progress_.done(done); };
    }

    Result<void> scan() {
        progress_.phase("scanning vertices");
        Sample sample;
        const auto look = [&](std::span<const glm::dvec3> positions) { sample.add(positions); };
        ASSIGN_OR_RETURN(summaries_, inputs_.scan(look, part()));
        ASSIGN_OR_RETURN(lattice_, chooseLattice(summaries_, sample, options_.stepExponent));
        manifest_.stepExponent = lattice_.stepExponent;
        for (const ImportSummary& input : summaries_) {
            manifest_.colors = manifest_.colors || input.colors;
            manifest_.normals = manifest_.normals || input.normals;
        }
        return {};
    }

    Result<std::vector<Bin>> distribute(const RecordFormat& format, ChunkFile& spill) {
        progress_.phase("reading triangles");
        Distributor distributor(lattice_, format, manifest_.colors, manifest_.normals, spill);
        const auto sink = [&](std::span<const Triangle> triangles) { return distributor.add(triangles); };
        for (std::size_t i = 0; i < options_.inputs.size(); ++i) {
            const auto done = [&](double inInput) {
                progress_.done((static_cast<double>(i) + inInput) /
                               static_cast<double>(options_.inputs.size()));
            };
            distributor.begin(options_.inputs[i], summaries_[i]);
            ASSIGN_OR_RETURN(const ImportCounts counts, inputs_.triangles(i, sink, done));
            manifest_.provenance.push_back({std::filesystem::path(options_.inputs[i]).filename().string(),
                                            distributor.stored(), counts.droppedNonFinite,
                                            distributor.degenerate()});
            manifest_.triangles += distributor.stored();
        }
        if (manifest_.triangles > 0) return distributor.finish();
        return fail(
            "the inputs have no triangles of three distinct lattice positions: there is nothing to build");
    }

    Result<void> assemble(const RecordFormat& format, ChunkFile& spill, std::vector<Bin> bins) {
        progress_.phase("building pages");
        malloc_trim(0);  // what reading took is building's now
        const std::string pagesName = fmt::format("pages-{}.bin", output_.generation());
        ASSIGN_OR_RETURN(OutputFile pages, OutputFile::create(output_.temporary(pagesName)));
        const std::uint32_t attributes =
            (manifest_.colors ? kPageColors : 0u) | (manifest_.normals ? kPageNormals : 0u);
        PageWriter writer(pages, lattice_, format, attributes);
        Assembler assembler(format, lattice_, assembleOptions(format), spill, writer);
        RETURN_IF_ERROR(assembler.run(std::move(bins)));
        RETURN_IF_ERROR(pages.sync());
        manifest_.pageFiles = {{pagesName, pages.size()}};
        manifest_.vertices = writer.vertices();
        return finish(assembler, writer);
    }

    AssembleOptions assembleOptions(const RecordFormat& format) {
        const std::size_t fitting =
            static_cast<std::size_t>(budget_.batchBytes / (format.bytes() + kBatchOverheadBytes));
        return {options_.leafTriangles, parts_.batchTriangles != 0 ? parts_.batchTriangles : fitting,
                budget_.threads, part()};
    }

    Result<void> finish(Assembler& assembler, PageWriter& writer) {
        Hierarchy hierarchy;
        hierarchy.rootCell = lattice_.rootCell;
        hierarchy.rootCellLog2 = lattice_.rootCellLog2;
        hierarchy.nodes = assembler.takeNodes();
        hierarchy.pages = writer.takeRecords();
        const std::string name = fmt::format("hierarchy-{}.bin", output_.generation());
        ASSIGN_OR_RETURN(const std::uint64_t bytes, saveHierarchy(output_.temporary(name), hierarchy));
        manifest_.hierarchy = {name, bytes};
        manifest_.generation = output_.generation();
        manifest_.nodes = hierarchy.nodes.size();
        manifest_.leaves = static_cast<std::uint64_t>(
            std::ranges::count(hierarchy.nodes, std::uint8_t{0}, &NodeRecord::childMask));
        manifest_.pages = hierarchy.pages.size();
        const LatticeBox box = Hierarchy::box(hierarchy.nodes[0]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            manifest_.bounds.min[axis] =
                std::ldexp(static_cast<double>(box.min[axis]), lattice_.stepExponent);
            manifest_.bounds.max[axis] =
                std::ldexp(static_cast<double>(box.max[axis]), lattice_.stepExponent);
        }
        return {};
    }

    const BuildOptions& options_;
    const Budget& budget_;
    const BuildParts& parts_;
    OutputDirectory& output_;
    Progress& progress_;
    Inputs inputs_;
    std::vector<ImportSummary> summaries_;
    Lattice lattice_;
    Manifest manifest_;
};

}  // namespace

Result<Manifest> buildDatasetFrom(const BuildOptions& options, Progress& progress, const BuildParts& parts) {
    if (options.inputs.empty()) return fail("no inputs: name at least one model");
    if (options.leafTriangles < kMinLeafTriangles || options.leafTriangles > kMaxLeafTriangles) {
        return fail("--leaf-triangles {} is out of range: give {} to {}", options.leafTriangles,
                    kMinLeafTriangles, kMaxLeafTriangles);
    }
    ASSIGN_OR_RETURN(const Budget budget, makeBudget(options));
    ASSIGN_OR_RETURN(OutputDirectory output, OutputDirectory::open(options.output));
    return Build(options, budget, parts, output, progress).run();
}

Result<Manifest> buildDataset(const BuildOptions& options, Progress& progress) {
    return buildDatasetFrom(options, progress, {});
}

}  // namespace iwalk
