#pragma once

#include <string>
#include <string_view>

namespace iwalk {

// What a file says, made fit for a one-line message: in quotes, cut to 40 characters, control characters as
// '?'.
inline std::string quote(std::string_view text) {
    std::string out = "'";
    for (const char c : text.substr(0, 40)) out += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
    return out + (text.size() > 40 ? "...'" : "'");
}

inline bool isBlank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
inline bool isSpace(char c) {
    return isBlank(c) || c == '\n';
}

inline std::string_view trim(std::string_view text) {
    while (!text.empty() && isSpace(text.front())) text.remove_prefix(1);
    while (!text.empty() && isSpace(text.back())) text.remove_suffix(1);
    return text;
}

// Takes the next word off `text`; empty when there is none.
inline std::string_view takeWord(std::string_view& text) {
    text = trim(text);
    std::size_t end = 0;
    while (end < text.size() && !isSpace(text[end])) ++end;
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(end);
    return word;
}

}  // namespace iwalk
