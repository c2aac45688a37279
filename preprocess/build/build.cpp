// The whole of a build: look at the inputs, put their triangles on the lattice and into bins on disk, then
// turn bins into octree and pages, and commit. Reading knows nothing of pages, and building nothing of
// inputs.
#include "preprocess/build/build.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/dataset/level_summary.hpp"
#include "common/settings.hpp"
#include "preprocess/build/assemble.hpp"
#include "preprocess/build/distribute_queue.hpp"
#include "preprocess/build/grid.hpp"
#include "preprocess/build/old_dataset.hpp"
#include "preprocess/build/output_directory.hpp"
#include "preprocess/build/page_order.hpp"
#include "preprocess/build/pipeline.hpp"
#include "preprocess/build/reading_threads.hpp"
#include "preprocess/build/survey.hpp"
#include "preprocess/levels/levels.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kMinLeafTriangles = 16, kMaxLeafTriangles = 65536;
// In memory a triangle also has its place in the order (twice), its bin, and a sort key while its node is
// sorted.
constexpr std::size_t kBatchOverheadBytes = 4 + 4 + 2 + 32;
constexpr std::size_t kTargetChunkBytes = std::size_t{64} << 10;  // of up to 512 bins
constexpr unsigned kMostRootLog2 = 61;
constexpr std::uint64_t kAnnouncedBytes = std::uint64_t{64} << 20;  // less is not worth a word
constexpr std::size_t kMostOldFiles = 65535;                        // page records name files by 16 bits

class Build {
  public:
    // `old`: the dataset that the inputs go into; nullptr: a new one is made.
    Build(const BuildOptions& options, const Budget& budget, const BuildParts& parts, OutputDirectory& output,
          Progress& progress, const OldDataset* old)
        : options_(options),
          budget_(budget),
          parts_(parts),
          output_(output),
          progress_(progress),
          old_(old),
          threads_(budget.threads),
          inputs_(options, budget, output.temporaryDirectory(), parts.openImporter) {
        if (old_ != nullptr) manifest_ = old_->manifest;
    }

    Result<Manifest> run() {
        RETURN_IF_ERROR(threads_.lead([&] { return scan(); }));
        const RecordFormat format(lattice_.rootCellLog2, manifest_.colors, manifest_.normals);
        const std::size_t chunkBytes = parts_.chunkBytes != 0 ? parts_.chunkBytes : budget_.chunkBytes;
        announceSpace(format.bytes());
        ASSIGN_OR_RETURN(ChunkFile spill, ChunkFile::create(output_.temporary("triangles"), chunkBytes));
        ASSIGN_OR_RETURN(std::vector<Bin> bins, threads_.lead([&] { return distribute(format, spill); }));
        progress_.triangles(manifest_.triangles);
        RETURN_IF_ERROR(assemble(format, std::move(spill), std::move(bins)));
        progress_.phase("committing");
        RETURN_IF_ERROR(output_.commit(manifest_));
        return manifest_;
    }

  private:
    ProgressSink part() {
        return [this](double done) { progress_.done(done); };
    }

    // Before it is taken: what is on its way to the dataset lies in files that go when the build does.
    void announceSpace(std::size_t triangleBytes) {
        std::uint64_t most = 0;
        // Meshes have twice as many triangles as vertices, soups a third of that.
        for (const ImportSummary& input : summaries_)
            most += std::min(input.triangleBound, 2 * input.vertices) * triangleBytes;
        if (most >= kAnnouncedBytes) {
            progress_.note(fmt::format("temporary files will take about {} in {}, or less", formatBytes(most),
                                       output_.temporaryDirectory()));
        }
    }

    Result<void> scan() {
        progress_.phase("scanning vertices");
        Sample sample;
        const auto look = [&](std::span<const glm::dvec3> positions) { sample.add(positions); };
        ASSIGN_OR_RETURN(summaries_, inputs_.scan(look, part()));
        if (old_ != nullptr) return growRoot();
        ASSIGN_OR_RETURN(lattice_, chooseLattice(summaries_, sample, options_.stepExponent));
        if (parts_.lattice) lattice_ = *parts_.lattice;
        middle_ = middleOf(sample, lattice_.stepExponent);
        manifest_.stepExponent = lattice_.stepExponent;
        for (const ImportSummary& input : summaries_) {
            manifest_.colors = manifest_.colors || input.colors;
            manifest_.normals = manifest_.normals || input.normals;
        }
        return {};
    }

    Result<void> growRoot() {
        const LatticeBox bounds = boundsOnLattice(summaries_, manifest_.stepExponent);
        if (bounds.empty()) return fail("the inputs have no vertices: there is nothing to insert");
        lattice_ = grownRoot(old_->model.lattice, bounds);
        lattice_.stepExponent = manifest_.stepExponent;
        if (lattice_.rootCellLog2 > kMostRootLog2 || !fitsSparse(*old_, lattice_.rootCellLog2)) {
            return fail("the inputs lie too far from what the dataset has: build another dataset of them");
        }
        middle_ = middleOf(old_->model);
        tree_ = OldTree(old_->model, lattice_);
        for (std::size_t i = 0; i < summaries_.size(); ++i) {
            const auto noteDropped = [&](bool has, bool stays, const char* what) {
                if (has && !stays) {
                    progress_.note(fmt::format("{}: its {} are dropped, as the dataset has none",
                                               options_.inputs[i], what));
                }
            };
            noteDropped(summaries_[i].colors, manifest_.colors, "colours");
            noteDropped(summaries_[i].normals, manifest_.normals, "normals");
        }
        return {};
    }

    Result<std::vector<Bin>> distribute(const RecordFormat& format, ChunkFile& spill) {
        progress_.phase("reading triangles");
        Distributor distributor(lattice_, middle_, format, manifest_.colors, manifest_.normals, spill, tree_);
        DistributeQueue queue(distributor, budget_.threads);
        const auto sink = [&](std::vector<Triangle>& triangles) { return queue.add(triangles); };
        std::uint64_t stored = 0;
        for (std::size_t i = 0; i < options_.inputs.size(); ++i) {
            const auto done = [&](double inInput) {
                progress_.done((static_cast<double>(i) + inInput) /
                               static_cast<double>(options_.inputs.size()));
            };
            distributor.begin(options_.inputs[i], summaries_[i]);
            const Result<ImportCounts> read = inputs_.triangles(i, sink, done);
            RETURN_IF_ERROR(queue.finish());  // what went wrong there came before what did in reading
            ASSIGN_OR_RETURN(const ImportCounts counts, read);
            stored += distributor.stored();
            manifest_.provenance.push_back(
                {std::filesystem::path(options_.inputs[i]).filename().string(), distributor.stored(),
                 counts.droppedNonFinite, distributor.degenerate(), distributor.split(), distributor.cut()});
        }
        if (stored == 0) {
            return fail(
                "the inputs have no triangles of three distinct lattice positions: there is nothing to {}",
                old_ != nullptr ? "insert" : "build");
        }
        manifest_.triangles += stored;
        if (old_ != nullptr) RETURN_IF_ERROR(readOld(distributor));
        return distributor.finish();
    }

    // What the dataset has in nodes that get new triangles, or share a page with one.
    Result<void> readOld(Distributor& distributor) {
        progress_.phase("reading the dataset");
        tree_.touchSharers();
        ASSIGN_OR_RETURN(const auto store,
                         PageStore::open(pagePaths(options_.output, old_->manifest), lattice_, 0));
        const auto add = [&](const TriangleRecord& record) { return distributor.addOld(record); };
        return readTouched(*old_, tree_, *store, add, part());
    }

    Result<void> assemble(const RecordFormat& format, ChunkFile spill, std::vector<Bin> bins) {
        progress_.phase("building pages");
        malloc_trim(0);  // what reading took is building's now
        const std::string pagesName = fmt::format("pages-{}.bin", output_.generation());
        ASSIGN_OR_RETURN(OutputFile pages, OutputFile::create(output_.temporary(pagesName)));
        const std::uint32_t attributes =
            (manifest_.colors ? kPageColors : 0u) | (manifest_.normals ? kPageNormals : 0u);
        const std::size_t files = manifest_.pageFiles.size();
        if (files > kMostOldFiles) return fail("{}: has {} files: compact it first", options_.output, files);
        ASSIGN_OR_RETURN(VertexErrors errors, VertexErrors::create(output_.temporaryDirectory()));
        PageWriter writer(pages, static_cast<std::uint16_t>(files), lattice_, format, attributes,
                          std::move(errors), old_ != nullptr ? old_->pages : std::vector<PageRecord>());
        ASSIGN_OR_RETURN(LevelModel model, buildPages(format, std::move(spill), std::move(bins), writer));
        setBounds(Hierarchy::box(model.nodes[0]));
        RETURN_IF_ERROR(buildLevels(model, pages.path(), writer));
        RETURN_IF_ERROR(pages.sync());
        manifest_.pageFiles.push_back({pagesName, pages.size()});
        Hierarchy hierarchy = finishModel(std::move(model), writer.takeRecords());
        keepPages(hierarchy, usedPages(hierarchy));
        keepFiles(manifest_.pageFiles, hierarchy.pages);
        return finish(hierarchy);
    }

    // The octree and the pages of full resolution. What was spilled is gone afterwards: levels need the room.
    Result<LevelModel> buildPages(const RecordFormat& format, ChunkFile spill, std::vector<Bin> bins,
                                  PageWriter& writer) {
        Assembler assembler(format, lattice_, assembleOptions(format), spill, writer, tree_);
        RETURN_IF_ERROR(assembler.run(std::move(bins)));
        return startModel(lattice_, assembler.takeTree(), tree_);
    }

    Result<void> buildLevels(LevelModel& model, const std::string& pagesPath, PageWriter& writer) {
        malloc_trim(0);
        const RecordFormat format(lattice_.rootCellLog2, manifest_.colors, manifest_.normals, true);
        ASSIGN_OR_RETURN(ChunkFile spill, ChunkFile::create(output_.temporary("targets"), kTargetChunkBytes));
        std::vector<std::string> paths = pagePaths(options_.output, manifest_);
        paths.push_back(pagesPath);
        RETURN_IF_ERROR(writer.flush());
        ASSIGN_OR_RETURN(const auto store,
                         PageStore::open(std::move(paths), lattice_, budget_.batchBytes / 5));
        const LevelOptions options{options_.leafTriangles, budget_.threads, parts_.levels};
        return makeLevels(model, format, options, tree_, *store, writer, spill, progress_);
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
        manifest_.vertices = 0;
        for (const PageRecord& page : hierarchy.pages) manifest_.vertices += page.vertexCount;
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
    const OldDataset* old_;
    ReadingThreads threads_;
    Inputs inputs_;
    std::vector<ImportSummary> summaries_;
    Lattice lattice_;
    LatticePoint middle_{0, 0, 0};  // of the model, strays apart
    OldTree tree_;
    Manifest manifest_;
};

Result<void> checkInputs(const BuildOptions& options) {
    if (options.inputs.empty()) return fail("no inputs: name at least one model");
    if (options.leafTriangles >= kMinLeafTriangles && options.leafTriangles <= kMaxLeafTriangles) return {};
    return fail("--leaf-triangles {} is out of range: give {} to {}", options.leafTriangles,
                kMinLeafTriangles, kMaxLeafTriangles);
}

// What is inserted is no part of the dataset itself.
Result<void> checkOutside(const BuildOptions& options) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path dataset = fs::weakly_canonical(options.output, ignored);
    for (const std::string& input : options.inputs) {
        const fs::path path = fs::weakly_canonical(input, ignored);
        if (std::ranges::mismatch(dataset, path).in1 != dataset.end()) continue;
        return fail("{}: is the dataset that is inserted into, or lies in it: name models to add", input);
    }
    return {};
}

}  // namespace

Result<Manifest> buildDatasetFrom(const BuildOptions& options, Progress& progress, const BuildParts& parts) {
    RETURN_IF_ERROR(checkInputs(options));
    ASSIGN_OR_RETURN(const Budget budget, makeBudget(options));
    ASSIGN_OR_RETURN(OutputDirectory output, OutputDirectory::open(options.output));
    return Build(options, budget, parts, output, progress, nullptr).run();
}

Result<Manifest> insertIntoDatasetFrom(const BuildOptions& options, Progress& progress,
                                       const BuildParts& parts) {
    RETURN_IF_ERROR(checkOutside(options));
    RETURN_IF_ERROR(loadManifest(options.output));  // before anything is made in what may be no dataset
    ASSIGN_OR_RETURN(OutputDirectory output, OutputDirectory::open(options.output));
    ASSIGN_OR_RETURN(const OldDataset old, loadOldDataset(options.output));
    BuildOptions all = options;
    all.leafTriangles = static_cast<std::uint32_t>(std::min<std::uint64_t>(old.manifest.leafTriangles, ~0u));
    RETURN_IF_ERROR(checkInputs(all));
    ASSIGN_OR_RETURN(const Budget budget, makeBudget(all));
    return Build(all, budget, parts, output, progress, &old).run();
}

Result<Manifest> buildDataset(const BuildOptions& options, Progress& progress) {
    return buildDatasetFrom(options, progress, {});
}

Result<Manifest> insertIntoDataset(const BuildOptions& options, Progress& progress) {
    return insertIntoDatasetFrom(options, progress, {});
}

}  // namespace iwalk
