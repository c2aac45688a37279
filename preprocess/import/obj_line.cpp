// Wavefront, "Object Files (.obj)", the polygonal part.
#include "preprocess/import/obj_line.hpp"

#include "preprocess/import/number.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

std::string_view skipBlanks(std::string_view text) {
    while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
    return text;
}

// A whole number, with sign, of at most 18 digits. Takes nothing and returns false when there is none.
bool takeInteger(std::string_view& text, std::int64_t& value) {
    const bool negative = text.starts_with('-');
    std::size_t at = negative || text.starts_with('+') ? 1 : 0;
    const std::size_t first = at;
    value = 0;
    for (; at < text.size() && text[at] >= '0' && text[at] <= '9'; ++at) {
        if (at - first == 18) return false;
        value = value * 10 + (text[at] - '0');
    }
    if (at == first) return false;
    if (negative) value = -value;
    text.remove_prefix(at);
    return true;
}

}  // namespace

ObjLine splitObjLine(std::string_view line) {
    line = skipBlanks(line);
    std::size_t end = 0;
    while (end < line.size() && !isBlank(line[end])) ++end;
    const std::string_view keyword = line.substr(0, end), rest = line.substr(end);
    if (keyword == "v") return {ObjKeyword::vertex, rest};
    if (keyword == "vn") return {ObjKeyword::normal, rest};
    if (keyword == "f") return {ObjKeyword::face, rest};
    if (keyword == "mtllib") return {ObjKeyword::materialLibrary, rest};
    if (keyword == "usemtl") return {ObjKeyword::useMaterial, rest};
    return {ObjKeyword::other, rest};
}

bool takeObjCorner(std::string_view& text, ObjCorner& corner) {
    text = skipBlanks(text);
    if (text.starts_with('#')) text = {};
    std::string_view rest = text;
    corner = {};
    if (!takeInteger(rest, corner.vertex)) return false;
    std::int64_t texture = 0;
    if (rest.starts_with('/')) {
        rest.remove_prefix(1);
        takeInteger(rest, texture);
        if (rest.starts_with('/')) {
            rest.remove_prefix(1);
            takeInteger(rest, corner.normal);
        }
    }
    if (!rest.empty() && !isBlank(rest.front()) && rest.front() != '#') return false;
    text = rest;
    return true;
}

std::size_t takeObjNumbers(std::string_view& text, double* values, std::size_t limit) {
    for (std::size_t count = 0; count < limit; ++count) {
        text = skipBlanks(text);
        if (text.empty() || text.front() == '#') return count;
        const char* const end = parseNumber(text.data(), values[count]);
        const char* const behind = text.data() + text.size();
        if (!end || end > behind || (end < behind && !isBlank(*end) && *end != '#')) return count;
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
    return limit;
}

std::uint64_t resolveObjIndex(std::int64_t number, std::uint64_t before, std::uint64_t total) {
    if (number > 0) return static_cast<std::uint64_t>(number) - 1;
    const auto back = static_cast<std::uint64_t>(-number);
    return number == 0 || back > before ? total : before - back;
}

}  // namespace iwalk
