#include "preprocess/import/line_reader.hpp"

namespace iwalk {

Result<bool> LineReader::next(std::string_view& line) {
    while (!lines_.next(line)) {
        before_ += lines_.linesRead();
        ASSIGN_OR_RETURN(const bool more, blocks_.next(block_));
        lines_ = more ? Lines(block_) : Lines();
        if (!more) return false;
        if (block_.bad) return block_.bad->error(path_, before_);
    }
    return true;
}

Error LineReader::bad(std::string_view what) const {
    return BadLine{lines_.number(), std::string(what)}.error(path_, before_);
}

}  // namespace iwalk
