#pragma once

#include <optional>

#include "preprocess/import/memory_share.hpp"
#include "preprocess/import/ply_values.hpp"
#include "preprocess/import/read_ahead.hpp"
#include "preprocess/import/text_block.hpp"

namespace iwalk {

// The data of an ASCII PLY file: numbers between white space, whatever they mean. So blocks of the text are
// parsed by several threads before anyone knows which elements they belong to.
class PlyTextValues : public PlyValues {
  public:
    PlyTextValues(const RandomAccessFile& file, std::uint64_t offset, const std::string& path,
                  const ImportLimits& limits)
        : PlyValues(file, path),
          blocks_(blocksAtOnce(limits)),
          blockBytes_(limits.blockBytes),
          offset_(offset) {}

    Result<void> next(PlyType type, double& value) override;
    Result<void> skip(PlyType type, std::uint64_t count) override;
    std::uint64_t place() const override;
    std::uint64_t offset() const override;
    void seek(std::uint64_t offset) override;
    void pause() override { seek(offset()); }

  private:
    struct Block {
        TextBlock bytes;
        // The first `count` numbers, and where they end in the block. Behind them there are blanks, or a word
        // that is no number.
        std::vector<double> values;
        std::vector<std::uint32_t> ends;
        std::size_t count = 0;
        bool bad = false;
    };
    Result<bool> fill(Block& block);
    static void parse(Block& block);
    Result<void> nextBlock();
    Error badWord() const;
    // A digit and a space.
    std::uint64_t leastItemBytes(PlyType) const override { return 2; }

    std::size_t blocks_, blockBytes_;
    std::uint64_t offset_;                     // where the next block begins
    std::optional<ReadAhead<Block>> reading_;  // none between passes
    Block* block_ = nullptr;                   // null at the beginning and at the end
    std::size_t at_ = 0;                       // in the block: the next value
};

}  // namespace iwalk
