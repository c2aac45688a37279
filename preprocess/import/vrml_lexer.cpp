// ISO/IEC 14772-1:1997, 5.1.1 and annex A.
#include "preprocess/import/vrml_lexer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "preprocess/import/number.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kMaxWord = 1024;  // bytes, of a name or number

bool isGap(char c) {
    return isSpace(c) || c == ',';
}
bool endsWord(char c) {
    return isGap(c) || c == '#' || c == '"' || c == '[' || c == ']' || c == '{' || c == '}';
}

}  // namespace

// A whole word in view, if the file has one.
Result<void> VrmlLexer::need() {
    return stream_.view().size() < kMaxWord && !stream_.allLoaded() ? stream_.fill(kMaxWord) : Result<void>();
}

Result<void> VrmlLexer::skipBlanks() {
    for (;;) {
        RETURN_IF_ERROR(need());
        const std::string_view text = stream_.view();
        std::size_t at = 0;
        for (; at < text.size() && isGap(text[at]); ++at) line_ += text[at] == '\n';
        stream_.advance(at);
        if (at == text.size()) {
            if (stream_.allLoaded()) return {};
        } else if (text[at] == '#') {
            RETURN_IF_ERROR(skipComment());
        } else {
            return need();
        }
    }
}

Result<void> VrmlLexer::skipComment() {
    for (;;) {
        RETURN_IF_ERROR(stream_.fill(1));
        const std::string_view text = stream_.view();
        if (text.empty()) return {};
        const std::size_t end = std::min(text.find('\n'), text.size());
        stream_.advance(end);
        if (end < text.size()) return {};
    }
}

// Behind the quote that opens it.
Result<void> VrmlLexer::skipString() {
    for (bool escaped = false;;) {
        RETURN_IF_ERROR(stream_.fill(1));
        const std::string_view text = stream_.view();
        if (text.empty()) return bad("the file ends within a string, it is cut short");
        for (std::size_t at = 0; at < text.size(); ++at) {
            line_ += text[at] == '\n';
            if (text[at] == '"' && !escaped) {
                stream_.advance(at + 1);
                return {};
            }
            escaped = text[at] == '\\' && !escaped;
        }
        stream_.advance(text.size());
    }
}

Result<std::string_view> VrmlLexer::word() {
    const std::string_view text = stream_.view();
    std::size_t end = 0;
    while (end < text.size() && end <= kMaxWord && !endsWord(text[end])) ++end;
    if (end > kMaxWord) return bad(fmt::format("a word does not end within {} bytes", kMaxWord));
    stream_.advance(end);
    return text.substr(0, end);
}

Result<VrmlLexer::Token> VrmlLexer::next() {
    RETURN_IF_ERROR(skipBlanks());
    if (stream_.view().empty()) return Token{};
    const auto mark = [&](Kind kind) {
        stream_.advance(1);
        return Token{kind, {}};
    };
    switch (stream_.view().front()) {
        case '{':
            return mark(Kind::openBrace);
        case '}':
            return mark(Kind::closeBrace);
        case '[':
            return mark(Kind::openBracket);
        case ']':
            return mark(Kind::closeBracket);
        case '"':
            stream_.advance(1);
            RETURN_IF_ERROR(skipString());
            return Token{Kind::string, {}};
        default:
            ASSIGN_OR_RETURN(const std::string_view text, word());
            return Token{Kind::word, text};
    }
}

Result<bool> VrmlLexer::number(double& value) {
    RETURN_IF_ERROR(skipBlanks());
    const std::string_view text = stream_.view();
    if (text.empty()) return false;
    const char* const end = parseNumber(text.data(), value);
    // Behind the view stands a line's end, which ends a number as well.
    if (!end || !endsWord(*end)) return false;
    stream_.advance(static_cast<std::size_t>(end - text.data()));
    return true;
}

Result<bool> VrmlLexer::integer(std::int32_t& value) {
    RETURN_IF_ERROR(skipBlanks());
    const char* const text = stream_.view().data();
    const char* at = text;
    const bool negative = *at == '-';
    if (*at == '-' || *at == '+') ++at;
    const char* const digits = at;
    std::int64_t magnitude = 0;
    for (; *at >= '0' && *at <= '9' && at - digits < 10; ++at) magnitude = magnitude * 10 + (*at - '0');
    if (stream_.view().empty() || at == digits || magnitude > 0x7fffffff || !endsWord(*at)) return false;
    value = static_cast<std::int32_t>(negative ? -magnitude : magnitude);
    stream_.advance(static_cast<std::size_t>(at - text));
    return true;
}

Result<bool> VrmlLexer::closeBracket() {
    RETURN_IF_ERROR(skipBlanks());
    if (!stream_.view().starts_with(']')) return false;
    stream_.advance(1);
    return true;
}

Result<void> VrmlLexer::skipNested(Definitions& definitions) {
    for (std::uint64_t depth = 1; depth > 0;) {
        ASSIGN_OR_RETURN(Token token, next());
        switch (token.kind) {
            case Kind::end:
                return bad("the file ends within brackets, it is cut short");
            case Kind::openBrace:
            case Kind::openBracket:
                ++depth;
                break;
            case Kind::closeBrace:
            case Kind::closeBracket:
                --depth;
                break;
            case Kind::word:
                if (token.text == "DEF") {
                    ASSIGN_OR_RETURN(token, next());
                    if (token.kind == Kind::word) definitions.define(token.text, place());
                }
                break;
            case Kind::string:
                break;
        }
    }
    return {};
}

}  // namespace iwalk
