#pragma once

#include <oneapi/tbb/task_arena.h>

#include <vector>

#include "common/file.hpp"
#include "preprocess/build/page_job.hpp"
#include "preprocess/build/tree.hpp"

namespace iwalk {

// Builds pages side by side, and writes them in order.
class PageWriter {
  public:
    PageWriter(OutputFile& file, const Lattice& lattice, const RecordFormat& format, std::uint32_t attributes)
        : file_(file), lattice_(lattice), format_(format), attributes_(attributes) {}

    // Appends the pages, and tells the nodes which are theirs.
    Result<void> write(std::vector<PageJob> jobs, Tree& tree, tbb::task_arena& arena);

    std::vector<PageRecord> takeRecords() { return std::move(records_); }
    std::uint64_t vertices() const { return vertices_; }

  private:
    Result<void> append(BuiltPage& page, Tree& tree);

    OutputFile& file_;
    Lattice lattice_;
    RecordFormat format_;
    std::uint32_t attributes_;
    std::vector<PageRecord> records_;
    std::uint64_t vertices_ = 0;
};

}  // namespace iwalk
