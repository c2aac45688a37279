#include "preprocess/import/line_reader.hpp"

#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kMaxLine = std::size_t{1} << 20;  // bytes

bool isContinued(std::string_view line) {
    if (!line.ends_with('\\')) return false;
    return !trim(line).starts_with('#');
}

}  // namespace

Result<bool> LineReader::next(std::string_view& line) {
    line_ = linesRead_ + 1;
    ASSIGN_OR_RETURN(const bool more, nextPhysical(line));
    if (!more || !isContinued(line)) return more;
    return join(line);
}

Result<bool> LineReader::nextPhysical(std::string_view& line) {
    std::size_t end = stream_.view().find('\n');
    // First the rest of a usual buffer, then all that a line may take.
    for (const std::size_t want : {stream_.view().size() + 1, kMaxLine + 1}) {
        if (end != std::string_view::npos) break;
        RETURN_IF_ERROR(stream_.fill(want));
        end = stream_.view().find('\n');
    }
    const std::string_view text = stream_.view();
    if (end == std::string_view::npos) {
        if (!stream_.allLoaded() || text.size() > kMaxLine) {
            return bad(fmt::format("does not end within {} bytes: not a text file?", kMaxLine));
        }
        if (text.empty()) return false;
        end = text.size();
    }
    line = text.substr(0, end);
    stream_.advance(end == text.size() ? end : end + 1);
    if (linesRead_++ == 0 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    while (line.ends_with('\r')) line.remove_suffix(1);
    return true;
}

Result<bool> LineReader::join(std::string_view& line) {
    joined_.clear();
    while (line.ends_with('\\')) {
        line.remove_suffix(1);
        joined_.append(line).push_back(' ');
        if (joined_.size() > kMaxLine)
            return bad(fmt::format("is longer than {} bytes, with those it goes on in", kMaxLine));
        ASSIGN_OR_RETURN(const bool more, nextPhysical(line));
        if (!more) line = {};
    }
    joined_.append(line);
    line = joined_;
    return true;
}

Error LineReader::bad(std::string_view what) const {
    return fail("{}: line {}: {}", path_, line_, what);
}

}  // namespace iwalk
