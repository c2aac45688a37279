#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/dataset/page.hpp"
#include "common/file.hpp"
#include "preprocess/build/lattice.hpp"

namespace iwalk {

// A page as preprocessing works with it.
struct SourcePage {
    CellPoint origin{0};                         // of the ranges' boxes; steps from the root's cell
    std::vector<CellPoint> positions;            // by vertex; steps from the root's cell
    std::vector<std::uint32_t> colors, normals;  // by vertex; empty when the model has none
    std::vector<std::uint16_t> indices;
    std::vector<Range> ranges;

    std::size_t bytes() const {
        return positions.size() * (sizeof(CellPoint) + 8) + indices.size() * 2 +
               ranges.size() * sizeof(Range);
    }
};

// Pages that were written, read again; the last ones used stay in memory up to a limit. For any thread.
class PageStore {
  public:
    // `paths`: of the files that page records name. Pages outside of the lattice's root cell are refused.
    static Result<std::unique_ptr<PageStore>> open(std::vector<std::string> paths, const Lattice& lattice,
                                                   std::size_t limitBytes);

    // `number` names the page for later calls.
    Result<std::shared_ptr<const SourcePage>> get(std::uint32_t number, const PageRecord& record);
    // Where the page's vertices go, by its morph block, which it has; steps from the root's cell.
    Result<std::vector<CellPoint>> targets(const PageRecord& record, const SourcePage& page) const;

  private:
    PageStore(std::vector<std::string> paths, const Lattice& lattice, std::size_t limitBytes)
        : paths_(std::move(paths)), lattice_(lattice), limit_(limitBytes) {}
    struct Entry {
        std::shared_ptr<const SourcePage> page;
        std::list<std::uint32_t>::iterator used;
    };
    Error damaged(std::size_t file, std::uint64_t offset, const Error& error) const;
    bool isInRoot(const std::vector<CellPoint>& points) const;
    Result<SourcePage> read(const PageRecord& record) const;
    void keep(std::uint32_t number, std::shared_ptr<const SourcePage> page);

    std::vector<std::string> paths_;
    std::vector<std::unique_ptr<RandomAccessFile>> files_;
    Lattice lattice_;
    std::size_t limit_, held_ = 0;
    std::mutex mutex_;
    std::unordered_map<std::uint32_t, Entry> pages_;
    std::list<std::uint32_t> used_;  // last used first
};

}  // namespace iwalk
