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
    PageStore(std::unique_ptr<RandomAccessFile> file, const Lattice& lattice, std::size_t limitBytes)
        : file_(std::move(file)), lattice_(lattice), limit_(limitBytes) {}

    // `number` names the page for later calls.
    Result<std::shared_ptr<const SourcePage>> get(std::uint32_t number, const PageRecord& record);

  private:
    struct Entry {
        std::shared_ptr<const SourcePage> page;
        std::list<std::uint32_t>::iterator used;
    };
    Result<SourcePage> read(const PageRecord& record) const;
    void keep(std::uint32_t number, std::shared_ptr<const SourcePage> page);

    std::unique_ptr<RandomAccessFile> file_;
    Lattice lattice_;
    std::size_t limit_, held_ = 0;
    std::mutex mutex_;
    std::unordered_map<std::uint32_t, Entry> pages_;
    std::list<std::uint32_t> used_;  // last used first
};

}  // namespace iwalk
