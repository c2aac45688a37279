#include "preprocess/import/line_blocks.hpp"

#include <algorithm>

#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

std::string_view withoutReturns(std::string_view line) {
    while (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

bool isContinued(std::string_view line) {
    return line.ends_with('\\') && !trim(line).starts_with('#');
}

// Bytes of the first line, and those joined with it, with its end; 0 when the text ends before it does.
std::size_t firstLine(std::string_view text) {
    std::size_t begin = 0, end = text.find('\n');
    bool joined = false;
    while (end != text.npos) {
        const std::string_view line = withoutReturns(text.substr(begin, end - begin));
        joined = joined ? line.ends_with('\\') : isContinued(line);
        if (!joined) return end + 1;
        begin = end + 1;
        end = text.find('\n', begin);
    }
    return 0;
}

// Bytes of all whole lines.
std::size_t wholeLines(std::string_view text) {
    const std::size_t last = text.rfind('\n');
    if (last == text.npos) return 0;
    if (!withoutReturns(text.substr(0, last)).ends_with('\\')) return last + 1;
    std::size_t end = 0;
    while (const std::size_t line = firstLine(text.substr(end))) end += line;
    return end;
}

}  // namespace

Error BadLine::error(const std::string& path, std::uint64_t before) const {
    return fail("{}: line {}: {}", path, before + line + 1, what);
}

Result<bool> LineBlocks::next(LineBlock& block) {
    block.bad.reset();
    RETURN_IF_ERROR(block.bytes.read(file_, offset_, blockBytes_));
    if (block.bytes.text().empty()) return false;
    if (block.bytes.end() < file_.size()) RETURN_IF_ERROR(cut(block));
    offset_ = block.bytes.end();
    return true;
}

Result<void> LineBlocks::cut(LineBlock& block) {
    if (const std::size_t size = wholeLines(block.bytes.text())) {
        block.bytes.cut(size);
        return {};
    }
    RETURN_IF_ERROR(block.bytes.read(file_, offset_, kMaxLine + 1));
    const std::string_view text = block.bytes.text();
    if (const std::size_t size = firstLine(text)) {
        block.bytes.cut(size);
    } else if (text.size() > kMaxLine) {
        const bool joined = text.find('\n') != text.npos;
        block.bad = {0, joined ? fmt::format("is longer than {} bytes, with those it goes on in", kMaxLine)
                               : fmt::format("does not end within {} bytes: not a text file?", kMaxLine)};
    }
    return {};
}

Lines::Lines(const LineBlock& block) : rest_(block.bad ? std::string_view() : block.bytes.text()) {
    if (block.bytes.offset() == 0 && rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
}

bool Lines::next(std::string_view& line) {
    line_ = linesRead_;
    if (!nextPhysical(line)) return false;
    if (isContinued(line)) join(line);
    return true;
}

bool Lines::nextPhysical(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line = withoutReturns(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++linesRead_;
    return true;
}

void Lines::join(std::string_view& line) {
    joined_.clear();
    while (line.ends_with('\\')) {
        line.remove_suffix(1);
        joined_.append(line).push_back(' ');
        if (!nextPhysical(line)) line = {};
    }
    joined_.append(line);
    line = joined_;
}

}  // namespace iwalk
