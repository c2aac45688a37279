#include "preprocess/import/ply_text.hpp"

#include <algorithm>

#include "preprocess/import/number.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kMaxWord = 512;  // characters

std::size_t skipSpace(std::string_view text, std::size_t at) {
    while (at < text.size() && isSpace(text[at])) ++at;
    return at;
}

// Bytes up to the last white space, with it.
std::size_t wholeWords(std::string_view text) {
    std::size_t size = text.size();
    while (size > 0 && !isSpace(text[size - 1])) --size;
    return size;
}

}  // namespace

Result<bool> PlyTextValues::fill(Block& block) {
    // Where there is no white space a longer block holds a whole word, or shows that it is too long.
    for (const std::size_t want : {blockBytes_, blockBytes_ + kMaxWord}) {
        RETURN_IF_ERROR(block.bytes.read(file_, offset_, want));
        if (block.bytes.text().empty()) return false;
        if (block.bytes.end() == file_.size()) break;
        const std::size_t size = wholeWords(block.bytes.text());
        if (size == 0) continue;
        block.bytes.cut(size);
        break;
    }
    offset_ = block.bytes.end();
    return true;
}

void PlyTextValues::parse(Block& block) {
    const std::string_view text = block.bytes.text();
    const std::size_t most = text.size() / 2 + 1;
    if (block.values.size() < most) block.values.resize(most), block.ends.resize(most);
    block.count = 0;
    for (std::size_t at = skipSpace(text, 0); at < text.size(); at = skipSpace(text, at)) {
        const char* const word = text.data() + at;
        const char* const end = parseNumber(word, block.values[block.count]);
        block.bad = !end || !isSpace(*end) || end - word >= static_cast<std::ptrdiff_t>(kMaxWord);
        if (block.bad) return;
        at = static_cast<std::size_t>(end - text.data());
        block.ends[block.count++] = static_cast<std::uint32_t>(at);
    }
    block.bad = false;
}

Result<void> PlyTextValues::next(PlyType, double& value) {
    if (!block_ || at_ == block_->count) RETURN_IF_ERROR(nextBlock());
    value = block_->values[at_++];
    return {};
}

Result<void> PlyTextValues::skip(PlyType type, std::uint64_t count) {
    double ignored = 0;
    for (; count > 0; --count) RETURN_IF_ERROR(next(type, ignored));
    return {};
}

// A block with a value to read.
Result<void> PlyTextValues::nextBlock() {
    if (!reading_) {
        reading_.emplace(
            blocks_, [this](Block& block) { return fill(block); }, parse);
    }
    do {
        if (block_ && block_->bad) return badWord();
        ASSIGN_OR_RETURN(block_, reading_->next());
        at_ = 0;
        if (!block_) return bad("the file ends, it is cut short");
    } while (block_->count == 0);
    return {};
}

Error PlyTextValues::badWord() const {
    const std::string_view text = block_->bytes.text();
    const std::size_t begin = skipSpace(text, block_->count == 0 ? 0 : block_->ends[block_->count - 1]);
    std::string_view word = text.substr(begin, kMaxWord);
    return bad(quote(takeWord(word)) + " is not a number", block_->bytes.offset() + begin);
}

std::uint64_t PlyTextValues::place() const {
    if (!block_) return offset_;
    const std::size_t before = at_ < 2 ? 0 : block_->ends[at_ - 2];
    return block_->bytes.offset() + skipSpace(block_->bytes.text(), before);
}

std::uint64_t PlyTextValues::offset() const {
    if (!block_) return offset_;
    return block_->bytes.offset() + (at_ == 0 ? 0 : block_->ends[at_ - 1]);
}

void PlyTextValues::seek(std::uint64_t offset) {
    reading_.reset();
    block_ = nullptr;
    offset_ = offset;
}

}  // namespace iwalk
