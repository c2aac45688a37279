#include "preprocess/build/compact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/dataset/hierarchy.hpp"
#include "common/dataset/page_files.hpp"
#include "preprocess/build/output_directory.hpp"
#include "preprocess/build/page_order.hpp"
#include "preprocess/levels/model.hpp"

namespace iwalk {
namespace {

// Pages by level, and pages whose morph blocks lead to a level; depth first.
struct Layout {
    std::array<std::vector<std::uint32_t>, kFullLevel + 1> pages, morphs;
};

Layout layOut(const Hierarchy& hierarchy) {
    Layout layout;
    std::vector<bool> placed(hierarchy.pages.size(), false);
    for (const std::uint32_t n : modelOf(hierarchy).depthFirst()) {
        const NodeRecord& node = hierarchy.nodes[n];
        int coarser = node.depth - 1;
        for (const LevelRecord& entry : hierarchy.entriesOf(node)) {
            for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page) {
                if (placed[page]) continue;  // it is shared
                placed[page] = true;
                layout.pages[entry.level].push_back(page);
                if (hierarchy.pages[page].morphBytes == 0) continue;
                layout.morphs[static_cast<std::size_t>(coarser)].push_back(page);
            }
            coarser = entry.level;
        }
    }
    return layout;
}

class Copier {
  public:
    Copier(Hierarchy& hierarchy, const PageFiles& files, OutputFile& out, Progress& progress)
        : hierarchy_(hierarchy), files_(files), out_(out), progress_(progress) {
        for (const PageRecord& page : hierarchy.pages) all_ += std::uint64_t{page.bytes} + page.morphBytes;
    }

    // Levels from fine to coarse, as a build makes them. Returns the pages' order.
    Result<std::vector<std::uint32_t>> run() {
        const Layout layout = layOut(hierarchy_);
        std::vector<std::uint32_t> order;
        for (std::size_t level = layout.pages.size(); level-- > 0;) {
            for (const std::uint32_t page : layout.morphs[level]) {
                PageRecord& record = hierarchy_.pages[page];
                RETURN_IF_ERROR(copy(record.morphFile, record.morphOffset, record.morphBytes));
            }
            for (const std::uint32_t page : layout.pages[level]) {
                PageRecord& record = hierarchy_.pages[page];
                RETURN_IF_ERROR(copy(record.file, record.offset, record.bytes));
                order.push_back(page);
            }
        }
        return order;
    }

  private:
    // Sets the place to that of the copy.
    Result<void> copy(std::uint16_t& file, std::uint64_t& offset, std::uint32_t bytes) {
        buffer_.resize(bytes);
        RETURN_IF_ERROR(files_[file]->readAt(offset, buffer_));
        file = 0;
        offset = out_.size();
        RETURN_IF_ERROR(out_.write(buffer_));
        progress_.done(static_cast<double>(out_.size()) / static_cast<double>(all_));
        return {};
    }

    Hierarchy& hierarchy_;
    const PageFiles& files_;
    OutputFile& out_;
    Progress& progress_;
    std::vector<std::byte> buffer_;
    std::uint64_t all_ = 0;
};

}  // namespace

Result<Manifest> compactDataset(const std::string& dataset, Progress& progress) {
    RETURN_IF_ERROR(loadManifest(dataset));  // before anything is made in what may be no dataset
    ASSIGN_OR_RETURN(OutputDirectory output, OutputDirectory::open(dataset));
    ASSIGN_OR_RETURN(Manifest manifest, loadManifest(dataset));
    ASSIGN_OR_RETURN(Hierarchy hierarchy, loadHierarchy(dataset, manifest));
    ASSIGN_OR_RETURN(const PageFiles files, openPageFiles(dataset, manifest));

    progress.phase("copying pages");
    const std::string pagesName = fmt::format("pages-{}.bin", output.generation());
    ASSIGN_OR_RETURN(OutputFile pages, OutputFile::create(output.temporary(pagesName)));
    ASSIGN_OR_RETURN(const std::vector<std::uint32_t> order, Copier(hierarchy, files, pages, progress).run());
    RETURN_IF_ERROR(pages.sync());
    keepPages(hierarchy, order);

    progress.phase("committing");
    const std::string name = fmt::format("hierarchy-{}.bin", output.generation());
    ASSIGN_OR_RETURN(const std::uint64_t bytes, saveHierarchy(output.temporary(name), hierarchy));
    manifest.hierarchy = {name, bytes};
    manifest.pageFiles = {{pagesName, pages.size()}};
    manifest.generation = output.generation();
    RETURN_IF_ERROR(output.commit(manifest));
    return manifest;
}

std::uint64_t bytesOnDisk(const Manifest& manifest) {
    std::uint64_t bytes = manifest.hierarchy.bytes;
    for (const DatasetFile& file : manifest.pageFiles) bytes += file.bytes;
    return bytes;
}

std::uint64_t garbageBytes(const Manifest& manifest) {
    std::uint64_t used = manifest.hierarchy.bytes + manifest.full.bytes;
    for (const LevelSummary& level : manifest.levels) used += level.bytes;
    const std::uint64_t all = bytesOnDisk(manifest);
    return all - std::min(all, used);
}

}  // namespace iwalk
