#pragma once

#include <string>
#include <string_view>

#include "preprocess/import/byte_stream.hpp"

namespace iwalk {

// The words, brackets and numbers of a VRML97 text. Commas are blanks, '#' begins a comment.
class VrmlLexer {
  public:
    enum class Kind { end, word, string, openBrace, closeBrace, openBracket, closeBracket };
    struct Token {
        Kind kind = Kind::end;
        std::string_view text;  // of a word; void after the next call
    };
    // A place in the file to come back to.
    struct Place {
        std::uint64_t offset = 0, line = 1;
    };
    // What skipValue() tells of the names that nodes get on the way: `DEF name` stands before the place.
    class Definitions {
      public:
        virtual ~Definitions() = default;
        virtual void define(std::string_view name, const Place& place) = 0;
    };

    // `file` and `path` must outlive the lexer.
    VrmlLexer(const RandomAccessFile& file, const std::string& path) : stream_(file), path_(path) {}

    Result<Token> next();
    // The next number; false when there is none there, and nothing is taken.
    Result<bool> number(double& value);
    // The same for whole numbers that fit in 32 bits.
    Result<bool> integer(std::int32_t& value);
    // Takes a ']' if that is next.
    Result<bool> closeBracket();
    // Behind a '{' or '[': goes behind the bracket that closes it.
    Result<void> skipNested(Definitions& definitions);

    Place place() const { return {stream_.offset(), line_}; }
    void seek(const Place& place) { stream_.seek(place.offset), line_ = place.line; }
    std::uint64_t offset() const { return stream_.offset(); }
    // "PATH: line N: WHAT".
    Error bad(std::string_view what) const { return badAt(place(), what); }
    Error badAt(const Place& place, std::string_view what) const {
        return fail("{}: line {}: {}", path_, place.line, what);
    }

  private:
    Result<void> skipBlanks();
    Result<void> skipComment();
    Result<void> skipString();
    Result<void> need();
    Result<std::string_view> word();

    ByteStream stream_;
    const std::string& path_;
    std::uint64_t line_ = 1;
};

}  // namespace iwalk
