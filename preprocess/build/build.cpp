// The whole of a build: look at the inputs, put their triangles on the lattice and into bins on disk, then
// turn bins into octree and pages, and commit. Reading knows nothing of pages, and building nothing of
// inputs.
#include "preprocess/build/build.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/dataset/level_summary.hpp"
#include "preprocess/build/assemble.hpp"
#include "preprocess/build/dataset_importer.hpp"
#include "preprocess/build/distribute.hpp"
#include "preprocess/build/grid.hpp"
#include "preprocess/build/output_directory.hpp"
#include "preprocess/build/pipeline.hpp"
#include "preprocess/build/survey.hpp"
#include "preprocess/levels/levels.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kMinLeafTriangles = 16, kMaxLeafTriangles = 65536;
// In memory a triangle also has its place in the order (twice), its bin, and a sort key while its node is
// sorted.
constexpr std::size_t kBatchOverheadBytes = 4 + 4 + 2 + 32;
constexpr std::size_t kTargetChunkBytes = std::size_t{64} << 10;  // of up to 512 bins

class Build {
  public:
    // `before`: what the first input, a dataset, was made of; empty when it is a model like the others.
    Build(const BuildOptions& options, const Budget& budget, const BuildParts& parts, OutputDirectory& output,
          Progress& progress, std::vector<Provenance> before = {})
        : options_(options),
          budget_(budget),
          parts_(parts),
          output_(output),
          progress_(progress),
          inputs_(options.inputs, budget, output.temporaryDirectory(), parts.openImporter) {
        manifest_.provenance = std::move(before);
    }

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
        const bool inserting = !manifest_.provenance.empty();
        for (std::size_t i = 0; i < options_.inputs.size(); ++i) {
            const auto done = [&](double inInput) {
                progress_.done((static_cast<double>(i) + inInput) /
                               static_cast<double>(options_.inputs.size()));
            };
            distributor.begin(options_.inputs[i], summaries_[i]);
            ASSIGN_OR_RETURN(const ImportCounts counts, inputs_.triangles(i, sink, done));
            manifest_.triangles += distributor.stored();
            if (inserting && i == 0) continue;
            manifest_.provenance.push_back({std::filesystem::path(options_.inputs[i]).filename().string(),
                                            distributor.stored(), counts.droppedNonFinite,
                                            distributor.degenerate()});
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
        ASSIGN_OR_RETURN(LevelModel model, buildPages(format, spill, std::move(bins), writer));
        setBounds(Hierarchy::box(model.nodes[0]));
        RETURN_IF_ERROR(buildLevels(model, pages.path(), writer));
        RETURN_IF_ERROR(pages.sync());
        manifest_.pageFiles = {{pagesName, pages.size()}};
        manifest_.vertices = writer.vertices();
        return finish(finishModel(std::move(model), writer.takeRecords()));
    }

    // The octree and the pages of full resolution.
    Result<LevelModel> buildPages(const RecordFormat& format, ChunkFile& spill, std::vector<Bin> bins,
                                  PageWriter& writer) {
        Assembler assembler(format, lattice_, assembleOptions(format), spill, writer);
        RETURN_IF_ERROR(assembler.run(std::move(bins)));
        Tree::Records tree = assembler.takeTree();
        return startModel(lattice_, std::move(tree.nodes), tree.entries, std::move(tree.finest));
    }

    Result<void> buildLevels(LevelModel& model, const std::string& pagesPath, PageWriter& writer) {
        malloc_trim(0);
        const RecordFormat format(lattice_.rootCellLog2, manifest_.colors, manifest_.normals, true);
        ASSIGN_OR_RETURN(ChunkFile spill, ChunkFile::create(output_.temporary("targets"), kTargetChunkBytes));
        const LevelOptions options{options_.leafTriangles, pagesPath, budget_.batchBytes / 5,
                                   budget_.threads};
        return makeLevels(model, format, options, writer, spill, progress_);
    }

    AssembleOptions assembleOptions(const RecordFormat& format) {
        const std::size_t fitting =
            static_cast<std::size_t>(budget_.batchBytes / (format.bytes() + kBatchOverheadBytes));
        return {options_.leafTriangles, parts_.batchTriangles != 0 ? parts_.batchTriangles : fitting,
                budget_.threads, part()};
    }

    Result<void> finish(const Hierarchy& hierarchy) {
        const std::string name = fmt::format("hierarchy-{}.bin", output_.generation());
        ASSIGN_OR_RETURN(const std::uint64_t bytes, saveHierarchy(output_.temporary(name), hierarchy));
        manifest_.hierarchy = {name, bytes};
        manifest_.generation = output_.generation();
        manifest_.nodes = hierarchy.nodes.size();
        manifest_.leaves = static_cast<std::uint64_t>(
            std::ranges::count(hierarchy.nodes, std::uint8_t{0}, &NodeRecord::childMask));
        manifest_.pages = hierarchy.pages.size();
        manifest_.leafTriangles = options_.leafTriangles;
        LevelSummaries levels = summariseLevels(hierarchy, lattice_.stepExponent);
        manifest_.levels = std::move(levels.levels);
        manifest_.full = levels.full;
        return {};
    }

    void setBounds(const LatticeBox& box) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            manifest_.bounds.min[axis] =
                std::ldexp(static_cast<double>(box.min[axis]), lattice_.stepExponent);
            manifest_.bounds.max[axis] =
                std::ldexp(static_cast<double>(box.max[axis]), lattice_.stepExponent);
        }
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

// The dataset's own triangles are the first input of a new generation on the same lattice.
Result<Manifest> insertIntoDataset(const BuildOptions& options, Progress& progress) {
    if (options.inputs.empty()) return fail("no inputs: name at least one model");
    ASSIGN_OR_RETURN(const Manifest before, loadManifest(options.output));
    ASSIGN_OR_RETURN(OutputDirectory output, OutputDirectory::open(options.output));
    BuildOptions all = options;
    all.inputs.insert(all.inputs.begin(), options.output);
    all.stepExponent = before.stepExponent;
    all.leafTriangles = static_cast<std::uint32_t>(before.leafTriangles);
    BuildParts parts;
    parts.openImporter = [&](const std::string& path, const ImportLimits& limits) {
        return path == options.output ? openDatasetImporter(path) : openImporter(path, limits);
    };
    ASSIGN_OR_RETURN(const Budget budget, makeBudget(all));
    return Build(all, budget, parts, output, progress, before.provenance).run();
}

Result<Manifest> buildDataset(const BuildOptions& options, Progress& progress) {
    return buildDatasetFrom(options, progress, {});
}

}  // namespace iwalk
