#pragma once

#include <optional>
#include <vector>

#include "common/result.hpp"
#include "preprocess/import/work_ring.hpp"

namespace iwalk {

// Blocks of a file that are read in order by the thread that asks for them, parsed by all, and handed out in
// order: what comes out does not depend on the number of threads.
template <class Block>
class ReadAhead {
  public:
    // So many blocks are in memory at once; with one there is no reading ahead. `fill(Block&)` returns a
    // Result<bool>, false when there are no more; `parse(Block&)` is called by any thread.
    template <class Fill, class Parse>
    ReadAhead(std::size_t blocks, Fill fill, Parse parse)
        : fill_(std::move(fill)),
          slots_(blocks),
          ring_(blocks, [this, parse = std::move(parse)](std::size_t slot) { parse(slots_[slot].block); }) {}

    // The next block, parsed; null when there is none. The one before is void.
    Result<Block*> next() {
        if (handedOut_) ++taken_;
        handedOut_ = false;
        while (!ended_ && filled_ - taken_ < slots_.size()) fillNext();
        if (taken_ == filled_) return nullptr;
        const std::size_t at = taken_ % slots_.size();
        if (slots_[at].error) return *slots_[at].error;
        ring_.finish(at);
        handedOut_ = true;
        return &slots_[at].block;
    }

  private:
    struct Slot {
        Block block;
        std::optional<Error> error;  // when it could not be read
    };

    void fillNext() {
        const std::size_t at = filled_ % slots_.size();
        const Result<bool> more = fill_(slots_[at].block);
        ended_ = !more || !*more;
        if (!more) slots_[at].error = more.error();
        if (more && !*more) return;
        ++filled_;
        if (more) ring_.start(at);
    }

    std::function<Result<bool>(Block&)> fill_;
    std::vector<Slot> slots_;
    std::size_t filled_ = 0, taken_ = 0;  // blocks
    bool ended_ = false, handedOut_ = false;
    WorkRing ring_;  // ends before what it works on
};

}  // namespace iwalk
