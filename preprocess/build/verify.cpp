// Two passes: pages by themselves, in the order of the file; then, where there are levels, each entry against
// those of the next finer level that turn into it, node by node. Memory does not grow with pages: what has to
// be known of all of them is a sample of bounded size.
#include "preprocess/build/verify.hpp"

#include <algorithm>
#include <optional>

#include "preprocess/build/verify_levels.hpp"
#include "preprocess/build/verify_places.hpp"
#include "preprocess/build/verify_reader.hpp"
#include "preprocess/build/verify_targets.hpp"

namespace iwalk {
namespace {

std::uint64_t movingVertices(const Hierarchy& hierarchy) {
    std::uint64_t vertices = 0;
    for (const PageRecord& page : hierarchy.pages) vertices += page.morphBytes > 0 ? page.vertexCount : 0;
    return vertices;
}

// A node before its children.
std::vector<std::uint32_t> depthFirst(const Hierarchy& hierarchy) {
    std::vector<std::uint32_t> order, open{0};
    while (!open.empty()) {
        const std::uint32_t n = open.back();
        open.pop_back();
        order.push_back(n);
        const NodeRecord& node = hierarchy.nodes[n];
        const auto children = static_cast<std::uint32_t>(Hierarchy::childCount(node));
        for (std::uint32_t child = children; child-- > 0;) open.push_back(node.firstChild + child);
    }
    return order;
}

class Verifier {
  public:
    Verifier(const std::string& dataset, const Manifest& manifest, const Hierarchy& hierarchy,
             const PageFiles& files, Progress& progress)
        : dataset_(dataset),
          manifest_(manifest),
          hierarchy_(hierarchy),
          progress_(progress),
          reader_(hierarchy, files),
          places_(hierarchy),
          targets_(movingVertices(hierarchy)) {}

    Result<Verification> run() {
        checkPages();
        // Levels would say the same again, and could not read pages that are damaged.
        if (found_.problems.empty() && hierarchy_.hasLevels()) RETURN_IF_ERROR(checkLevels());
        return std::move(found_);
    }

  private:
    void checkPages() {
        progress_.phase("checking pages");
        const std::vector<Share> shares = sharesOf(hierarchy_);
        std::size_t next = 0;
        for (std::uint32_t p = 0; p < hierarchy_.pages.size(); ++p) {
            const std::size_t first = next;
            while (next < shares.size() && shares[next].page == p) ++next;
            const PageRecord& record = hierarchy_.pages[p];
            const auto problem = checkPage(p, std::span(shares).subspan(first, next - first));
            if (problem) add(p, *problem);
            ++found_.pages;
            found_.triangles += record.indexCount / 3;
            found_.bytes += std::uint64_t{record.bytes} + record.morphBytes;
            progress_.done(static_cast<double>(p + 1) / static_cast<double>(hierarchy_.pages.size()));
        }
        if (!found_.problems.empty() || places_.fullTriangles() == manifest_.triangles) return;
        found_.problems.push_back(fmt::format("{}: {} triangles at full resolution of {}", dataset_,
                                              places_.fullTriangles(), manifest_.triangles));
    }

    std::optional<std::string> checkPage(std::uint32_t p, std::span<const Share> shares) {
        const auto page = reader_.read(p);
        if (!page) return page.error().message;
        const std::optional<std::string> problem = places_.check(*page, shares);
        if (problem || !page->morph) return problem;
        const unsigned level = coarserLevel(shares[0]);
        for (std::size_t v = 0; v < page->positions.size(); ++v) {
            if (targets_.add(level, page->positions[v], page->targets[v])) continue;
            return fmt::format("vertex {} goes elsewhere than in another page", v);
        }
        return std::nullopt;
    }

    // That the share's vertices move to; loadHierarchy() has seen to it that a page has one.
    unsigned coarserLevel(const Share& share) const {
        const NodeRecord& node = hierarchy_.nodes[share.node];
        return share.entry == node.firstEntry ? node.depth - 1u : hierarchy_.entries[share.entry - 1].level;
    }

    Result<void> checkLevels() {
        progress_.phase("checking levels");
        LevelChecker checker(hierarchy_, reader_, targets_);
        std::vector<LevelProblem> problems;
        const std::vector<std::uint32_t> order = depthFirst(hierarchy_);
        for (std::size_t i = 0; i < order.size(); ++i) {
            RETURN_IF_ERROR(checker.check(order[i], problems));
            progress_.done(static_cast<double>(i + 1) / static_cast<double>(order.size()));
        }
        for (const LevelProblem& problem : problems) add(problem.page, problem.what);
        return {};
    }

    void add(std::uint32_t page, const std::string& problem) {
        const PageRecord& record = hierarchy_.pages[page];
        found_.problems.push_back(fmt::format("{}/{}: page {} at byte {}: {}", dataset_,
                                              manifest_.pageFiles[record.file].name, page, record.offset,
                                              problem));
    }

    const std::string& dataset_;
    const Manifest& manifest_;
    const Hierarchy& hierarchy_;
    Progress& progress_;
    PageReader reader_;
    PlaceChecker places_;
    TargetTable targets_;
    Verification found_;
};

}  // namespace

Result<Verification> verifyDataset(const std::string& dataset, Progress& progress) {
    progress.phase("checking hierarchy");
    ASSIGN_OR_RETURN(const Manifest manifest, loadManifest(dataset));
    ASSIGN_OR_RETURN(const Hierarchy hierarchy, loadHierarchy(dataset, manifest));
    ASSIGN_OR_RETURN(const PageFiles files, openPageFiles(dataset, manifest));
    return Verifier(dataset, manifest, hierarchy, files, progress).run();
}

}  // namespace iwalk
