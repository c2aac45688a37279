// Greg Turk's PLY, with the type names of both its dialects (uchar and uint8).
#include "preprocess/import/ply_header.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kMaxElements = 256, kMaxProperties = 1024;

std::optional<PlyType> typeNamed(std::string_view name) {
    struct Name {
        std::string_view name;
        PlyType type;
    };
    static constexpr Name kNames[] = {
        {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
        {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
        {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
        {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
        {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
        {"float64", PlyType::float64}};
    for (const Name& known : kNames) {
        if (known.name == name) return known.type;
    }
    return {};
}

class HeaderParser {
  public:
    HeaderParser(std::string_view text, const std::string& path) : text_(text), path_(path) {
        // The first line says how lines end here. Only old Macintosh files end them with a bare CR.
        const std::size_t end = text.find_first_of("\r\n");
        const bool bareReturn = end != text.npos && text[end] == '\r' && text.substr(end + 1, 1) != "\n";
        lineEnd_ = bareReturn ? '\r' : '\n';
    }

    Result<PlyHeader> parse() {
        std::string_view line;
        if (!nextLine(line) || line != "ply")
            return fail("{}: does not begin with a line 'ply': not a PLY file", path_);
        while (nextLine(line)) {
            std::string_view rest = line;
            if (takeWord(rest) == "end_header") return finish();
            RETURN_IF_ERROR(parseLine(line));
        }
        if (text_.size() < kMaxPlyHeaderBytes) {
            return fail("{}: header without end_header (line {}): the file is cut short", path_, line_);
        }
        return fail("{}: no end_header in the first {} bytes: not a PLY file", path_, kMaxPlyHeaderBytes);
    }

  private:
    // A last line that the text does not end counts as missing: it may be cut short.
    bool nextLine(std::string_view& line) {
        const std::size_t end = text_.find(lineEnd_, begin_);
        if (end == text_.npos || end >= kMaxPlyHeaderBytes) return false;
        line = trim(text_.substr(begin_, end - begin_));
        begin_ = end + 1;
        ++line_;
        return true;
    }

    Result<void> parseLine(std::string_view line) {
        std::string_view rest = line;
        const std::string_view keyword = takeWord(rest);
        if (keyword.empty() || keyword == "comment" || keyword == "obj_info") return {};
        if (keyword == "format") return parseFormat(rest);
        if (keyword == "element") return parseElement(rest);
        if (keyword == "property") return parseProperty(rest);
        // Some exporters forget the word comment. Among elements such a line may be a damaged one that
        // matters.
        if (!header_.elements.empty()) return bad("unknown keyword {}", quote(keyword));
        spdlog::warn("{}: header line {}: unknown keyword {}: not read", path_, line_, quote(keyword));
        return {};
    }

    Result<void> parseFormat(std::string_view rest) {
        const std::string_view name = takeWord(rest), version = takeWord(rest);
        if (name == "ascii") {
            header_.format = PlyFormat::ascii;
        } else if (name == "binary_little_endian") {
            header_.format = PlyFormat::littleEndian;
        } else if (name == "binary_big_endian") {
            header_.format = PlyFormat::bigEndian;
        } else {
            return bad("unknown format {}: ascii, binary_little_endian and binary_big_endian are known",
                       quote(name));
        }
        if (version != "1.0") return bad("unknown format version {}: only 1.0 is known", quote(version));
        if (formatSeen_) return bad("a second format line");
        formatSeen_ = true;
        return {};
    }

    Result<void> parseElement(std::string_view rest) {
        const std::string_view name = takeWord(rest), count = takeWord(rest);
        PlyElement element;
        element.name = name;
        const auto [end, status] = std::from_chars(count.data(), count.data() + count.size(), element.count);
        if (count.empty() || status != std::errc() || end != count.data() + count.size()) {
            return bad("element {} has the count {}: a whole number from 0 on is wanted", quote(name),
                       quote(count));
        }
        if (header_.find(name)) return bad("a second element {}", quote(name));
        if (header_.elements.size() == kMaxElements) return bad("more than {} elements", kMaxElements);
        header_.elements.push_back(std::move(element));
        return {};
    }

    Result<void> parseProperty(std::string_view rest) {
        if (header_.elements.empty()) return bad("a property before the first element");
        PlyProperty property;
        std::string_view type = takeWord(rest);
        if (type == "list") {
            property.list = true;
            const std::string_view countType = takeWord(rest);
            ASSIGN_OR_RETURN(property.countType, parseType(countType));
            if (isFloat(property.countType))
                return bad("a list's length cannot be of type {}", quote(countType));
            type = takeWord(rest);
        }
        ASSIGN_OR_RETURN(property.type, parseType(type));
        property.name = takeWord(rest);
        if (property.name.empty()) return bad("a property without a name");

        auto& properties = header_.elements.back().properties;
        const auto sameName = [&](const PlyProperty& other) { return other.name == property.name; };
        if (std::ranges::any_of(properties, sameName))
            return bad("a second property {}", quote(property.name));
        if (properties.size() == kMaxProperties) return bad("more than {} properties", kMaxProperties);
        properties.push_back(std::move(property));
        return {};
    }

    Result<PlyType> parseType(std::string_view name) const {
        if (const auto type = typeNamed(name)) return *type;
        return bad("unknown type {}", quote(name));
    }

    Result<PlyHeader> finish() {
        if (!formatSeen_) return bad("no format line in the header");
        header_.bytes = begin_;
        return std::move(header_);
    }

    template <class... Args>
    Error bad(fmt::format_string<Args...> format, Args&&... args) const {
        return fail("{}: header line {}: {}", path_, line_, fmt::format(format, std::forward<Args>(args)...));
    }

    std::string_view text_;
    const std::string& path_;
    char lineEnd_ = '\n';
    std::size_t begin_ = 0;  // of the next line
    std::size_t line_ = 0;   // number of the line last read, from 1
    bool formatSeen_ = false;
    PlyHeader header_;
};

}  // namespace

std::size_t plyTypeBytes(PlyType type) {
    static constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return kBytes[static_cast<std::size_t>(type)];
}

bool PlyElement::hasLists() const {
    return std::ranges::any_of(properties, [](const PlyProperty& p) { return p.list; });
}

std::uint64_t PlyElement::leastBytes(PlyFormat format) const {
    if (format == PlyFormat::ascii) return 2 * properties.size();  // a digit and a space each
    std::uint64_t bytes = 0;
    for (const PlyProperty& p : properties) bytes += plyTypeBytes(p.list ? p.countType : p.type);
    return bytes;
}

const PlyElement* PlyHeader::find(std::string_view name) const {
    const auto found = std::ranges::find(elements, name, &PlyElement::name);
    return found == elements.end() ? nullptr : &*found;
}

Result<PlyHeader> parsePlyHeader(std::string_view text, const std::string& path) {
    return HeaderParser(text, path).parse();
}

Result<void> checkPlyCounts(const PlyHeader& header, std::uint64_t fileBytes, const std::string& path) {
    // The last number of a text need not be followed by anything.
    std::uint64_t left = fileBytes - header.bytes + (header.format == PlyFormat::ascii ? 1 : 0);
    for (const PlyElement& element : header.elements) {
        const std::uint64_t least = element.leastBytes(header.format);
        if (least == 0) continue;
        if (element.count > left / least) {
            return fail(
                "{}: header promises {} of element {}, the file has room for {}: it is cut short or damaged",
                path, element.count, quote(element.name), left / least);
        }
        left -= element.count * least;
    }
    return {};
}

}  // namespace iwalk
