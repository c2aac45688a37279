#include "preprocess/import/ply_values.hpp"

#include <algorithm>
#include <cmath>

#include "preprocess/import/number.hpp"
#include "preprocess/import/ply_bytes.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

class BinaryValues : public PlyValues {
  public:
    BinaryValues(ByteStream& stream, const std::string& path, bool swap)
        : PlyValues(stream, path), swap_(swap) {}

    Result<void> next(PlyType type, double& value) override {
        const std::size_t bytes = plyTypeBytes(type);
        valueAt_ = stream_.offset();
        RETURN_IF_ERROR(stream_.fill(bytes));
        if (stream_.view().size() < bytes) return bad("the file ends, it is cut short");
        value = loadPlyValue(type, swap_, stream_.view().data());
        stream_.advance(bytes);
        return {};
    }

    Result<void> skip(PlyType type, std::uint64_t count) override {
        valueAt_ = stream_.offset();
        if (count > stream_.rest() / plyTypeBytes(type)) return bad("the file ends, it is cut short");
        stream_.seek(stream_.offset() + count * plyTypeBytes(type));
        return {};
    }

  private:
    std::uint64_t leastItemBytes(PlyType type) const override { return plyTypeBytes(type); }
    bool swap_;
};

class TextValues : public PlyValues {
  public:
    TextValues(ByteStream& stream, const std::string& path) : PlyValues(stream, path) {}

    Result<void> next(PlyType, double& value) override {
        RETURN_IF_ERROR(nextWord());
        const char* const word = stream_.view().data();
        const char* const end = parseNumber(word, value);
        if (!end || !isSpace(*end)) return badWord();
        const auto length = static_cast<std::size_t>(end - word);
        if (length >= kMaxWord) return badWord();
        stream_.advance(length);
        return {};
    }

    Result<void> skip(PlyType type, std::uint64_t count) override {
        double ignored = 0;
        for (; count > 0; --count) RETURN_IF_ERROR(next(type, ignored));
        return {};
    }

  private:
    static constexpr std::size_t kMaxWord = 512;  // characters

    // Passes over white space. Afterwards the whole next word is at hand, unless it is too long.
    Result<void> nextWord() {
        while (true) {
            RETURN_IF_ERROR(stream_.fill(kMaxWord));
            const std::string_view text = stream_.view();
            std::size_t blank = 0;
            while (blank < text.size() && isSpace(text[blank])) ++blank;
            stream_.advance(blank);
            valueAt_ = stream_.offset();
            if (blank == text.size() && stream_.allLoaded()) return bad("the file ends, it is cut short");
            if (blank == 0) return {};
        }
    }

    Error badWord() const {
        std::string_view text = stream_.view().substr(0, kMaxWord);
        return bad(quote(takeWord(text)) + " is not a number");
    }

    // A digit and a space.
    std::uint64_t leastItemBytes(PlyType) const override { return 2; }
};

}  // namespace

Result<std::uint64_t> PlyValues::listLength(PlyType countType, PlyType item) {
    double count = 0;
    RETURN_IF_ERROR(next(countType, count));
    if (!(count >= 0) || count != std::floor(count)) return bad(fmt::format("a list of length {}", count));
    // One byte more: the last number of a text need not be followed by anything.
    const std::uint64_t room = (stream_.rest() + 1) / leastItemBytes(item);
    if (count > static_cast<double>(room)) {
        return bad(fmt::format("a list of {} items in a file with {} bytes left", count, stream_.rest()));
    }
    return static_cast<std::uint64_t>(count);
}

Result<void> PlyValues::skip(const PlyProperty& property) {
    if (!property.list) return skip(property.type, 1);
    ASSIGN_OR_RETURN(const std::uint64_t count, listLength(property.countType, property.type));
    return skip(property.type, count);
}

Error PlyValues::bad(std::string_view what, std::uint64_t offset) const {
    return fail("{}: element {} {}: {} (byte {})", path_, quote(element_ ? element_->name : ""), index_, what,
                offset);
}

std::unique_ptr<PlyValues> makePlyValues(PlyFormat format, ByteStream& stream, const std::string& path) {
    if (format == PlyFormat::ascii) return std::make_unique<TextValues>(stream, path);
    return std::make_unique<BinaryValues>(stream, path, format == PlyFormat::bigEndian);
}

double loadPlyValue(PlyType type, bool swap, const char* bytes) {
    return withPlyType(type, [&]<class T>(T) {
        return static_cast<double>(swap ? loadBytes<T, true>(bytes) : loadBytes<T, false>(bytes));
    });
}

}  // namespace iwalk
