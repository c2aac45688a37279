#pragma once

#include <oneapi/tbb/task_arena.h>

#include <functional>
#include <span>
#include <vector>

#include "common/file.hpp"
#include "preprocess/build/page_job.hpp"
#include "preprocess/build/vertex_errors.hpp"

namespace iwalk {

// Builds pages side by side, and writes them in order.
class PageWriter {
  public:
    // `fileNumber`: the file's place among those that page records name. `old`: the pages of the dataset that
    // is inserted into; new ones get numbers behind them.
    PageWriter(OutputFile& file, std::uint16_t fileNumber, const Lattice& lattice, const RecordFormat& format,
               std::uint32_t attributes, VertexErrors errors, std::vector<PageRecord> old = {})
        : file_(file),
          fileNumber_(fileNumber),
          lattice_(lattice),
          format_(format),
          attributes_(attributes),
          records_(std::move(old)),
          olds_(records_.size()),
          errors_(std::move(errors)) {}

    // The entry that ranges of a page belong to, which is told so.
    using EntryOf = std::function<LevelRecord&(const NodeRanges&)>;

    // Appends the pages.
    Result<void> write(std::vector<PageJob> jobs, const EntryOf& entryOf, tbb::task_arena& arena);
    bool isNew(std::uint32_t number) const { return number >= olds_; }
    // Appends the morph block of page `number`, whose record has its size.
    Result<void> appendMorph(std::uint32_t number, std::span<const std::byte> bytes);
    // What was written can be read.
    Result<void> flush() { return file_.flush(); }
    // What follows are triangles of this kind.
    void setFormat(const RecordFormat& format) { format_ = format; }

    std::span<const PageRecord> records() const { return records_; }
    PageRecord& record(std::uint32_t number) { return records_[number]; }
    std::vector<PageRecord> takeRecords() { return std::move(records_); }
    // Of the vertices of new pages; none at full resolution.
    const VertexErrors& errors() const { return errors_; }

  private:
    Result<void> append(BuiltPage& page, const EntryOf& entryOf);

    OutputFile& file_;
    std::uint16_t fileNumber_;
    Lattice lattice_;
    RecordFormat format_;
    std::uint32_t attributes_;
    std::vector<PageRecord> records_;
    std::size_t olds_;
    VertexErrors errors_;
};

}  // namespace iwalk
