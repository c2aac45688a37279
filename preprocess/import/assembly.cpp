#include "preprocess/import/assembly.hpp"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_map>

#include "common/settings.hpp"
#include "preprocess/import/importer_list.hpp"
#include "preprocess/import/text.hpp"
#include "preprocess/import/triangle_output.hpp"
#include "preprocess/import/vertex_output.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {
namespace {

using nlohmann::json;

constexpr unsigned kMaxNesting = 8;
constexpr std::uint64_t kMaxCopies = 1'000'000'000;  // of a file, through all assemblies
constexpr std::uint64_t kBytesForText = 48;          // of memory, for a byte of text

Result<glm::dmat4> parseMatrix(const json& value, const std::string& where) {
    if (!value.is_array() || value.size() != 16)
        return fail("{}: \"matrix\" must be 16 numbers, row by row", where);
    glm::dmat4 matrix;
    for (std::size_t i = 0; i < 16; ++i) {
        if (!value[i].is_number() || !std::isfinite(value[i].get<double>()))
            return fail("{}: \"matrix\" must be 16 numbers, row by row", where);
        matrix[i % 4][i / 4] = value[i].get<double>();
    }
    if (matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] != 1)
        return fail("{}: the last row of \"matrix\" must be 0 0 0 1", where);
    return matrix;
}

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

Result<std::uint32_t> parseColor(const json& value, const std::string& where) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    std::uint32_t color = 0xff000000;
    bool good = text.size() == 7 && text[0] == '#';
    for (std::size_t i = 0; i < 3 && good; ++i) {
        const int high = hexDigit(text[1 + 2 * i]), low = hexDigit(text[2 + 2 * i]);
        good = high >= 0 && low >= 0;
        if (good) color |= static_cast<std::uint32_t>(16 * high + low) << 8 * i;
    }
    if (!good) return fail("{}: \"color\" must be \"#rrggbb\", not {}", where, quote(text));
    return color;
}

struct Part {
    std::string file;
    glm::dmat4 matrix{1};
    std::optional<std::uint32_t> color;
};

Result<Part> parsePart(const json& value, const std::string& where) {
    if (!value.is_object()) return fail("{}: must be an object with \"file\"", where);
    Part part;
    for (const auto& [key, entry] : value.items()) {
        if (key == "file" && entry.is_string()) {
            part.file = entry.get<std::string>();
        } else if (key == "matrix") {
            ASSIGN_OR_RETURN(part.matrix, parseMatrix(entry, where));
        } else if (key == "color") {
            ASSIGN_OR_RETURN(part.color, parseColor(entry, where));
        } else if (key != "file") {
            return fail("{}: {} means nothing here: \"file\", \"matrix\" and \"color\" do", where,
                        quote(key));
        }
    }
    if (part.file.empty() || part.file.find('\0') != std::string::npos)
        return fail("{}: \"file\" must name a file", where);
    return part;
}

class AssemblyImporter : public Importer {
  public:
    AssemblyImporter(Assembly assembly, const ImportLimits& limits)
        : assembly_(std::move(assembly)), files_(assembly_.files, limits, openImporter) {}

    Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) override {
        VertexOutput output(vertices);
        ImportSummary summary;
        summary.colors = assembly_.colors;
        for (std::size_t i = 0; i < files_.size(); ++i) {
            const std::vector<Placement>& placements = assembly_.placements[i];
            const VertexSink place = [&](std::span<const glm::dvec3> points) {
                for (const Placement& placement : placements) {
                    for (const glm::dvec3& point : points) output.add(placement.point(point));
                }
            };
            ASSIGN_OR_RETURN(const ImportSummary part,
                             files_.scan(i, place, partOf(progress, i, files_.size())));
            add(part, placements, summary);
            parts_.push_back(part);
        }
        output.finish(summary);
        if (unknownBound_) summary.triangleBound = 0;
        if (!(summary.precision > 0)) summary.precision = textPrecision(summary.bounds);
        summary_ = summary;
        return summary;
    }

    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override {
        TriangleOutput output(summary_.normals, sink);
        std::uint64_t lost = 0;
        std::vector<Triangle> moved;
        for (std::size_t i = 0; i < files_.size(); ++i) {
            const auto place = [&](std::span<const Triangle> triangles) -> Result<void> {
                for (const Placement& placement : assembly_.placements[i]) {
                    moved.clear();
                    lost += placement.append(triangles, moved);
                    RETURN_IF_ERROR(handOn(moved, parts_[i], output));
                }
                return {};
            };
            ASSIGN_OR_RETURN(const ImportCounts counts,
                             files_.triangles(i, place, partOf(progress, i, files_.size())));
            lost += counts.droppedNonFinite * assembly_.placements[i].size();
        }
        RETURN_IF_ERROR(output.flush());
        return ImportCounts{output.counts().triangles, output.counts().droppedNonFinite + lost};
    }

  private:
    void add(const ImportSummary& part, const std::vector<Placement>& placements, ImportSummary& all) {
        all.triangleBound += part.triangleBound * placements.size();
        unknownBound_ = unknownBound_ || (part.triangleBound == 0 && part.vertices > 0);
        all.colors = all.colors || part.colors;
        all.normals = all.normals || part.normals;
        for (const Placement& placement : placements) {
            const double precision = part.precision * placement.leastScale();
            if (precision > 0 && (all.precision == 0 || precision < all.precision)) all.precision = precision;
        }
    }

    // What a file does not have itself, but the assembly, it gets here.
    Result<void> handOn(std::span<const Triangle> triangles, const ImportSummary& part,
                        TriangleOutput& output) {
        for (const Triangle& triangle : triangles) {
            Triangle& next = output.next();
            next = triangle;
            for (Corner& corner : next) {
                if (summary_.colors && !part.colors && corner.color == 0) corner.color = kPlainColor;
            }
            RETURN_IF_ERROR(output.add());
        }
        return {};
    }

    Assembly assembly_;
    ImporterList files_;
    ImportSummary summary_;
    std::vector<ImportSummary> parts_;  // by file
    bool unknownBound_ = false;
};

}  // namespace

Result<Assembly> parseAssembly(std::string_view text, const std::string& path) {
    const json document = json::parse(text, nullptr, false);
    if (document.is_discarded()) return fail("{}: is no JSON text", path);
    if (!document.is_object() || !document.contains("parts") || !document["parts"].is_array())
        return fail("{}: is no assembly: it has no list \"parts\"", path);
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    Assembly assembly;
    std::unordered_map<std::string, std::size_t> numbers;
    for (const json& value : document["parts"]) {
        ASSIGN_OR_RETURN(const Part part, parsePart(value, fmt::format("{}: part {}", path, assembly.count)));
        const std::string file = (folder / part.file).lexically_normal().string();
        const auto [at, added] = numbers.try_emplace(file, assembly.files.size());
        if (added) assembly.files.push_back(file), assembly.placements.emplace_back();
        assembly.placements[at->second].emplace_back(part.matrix, part.color);
        assembly.colors = assembly.colors || part.color;
        ++assembly.count;
    }
    if (assembly.count == 0) return fail("{}: has no parts", path);
    return assembly;
}

Result<std::unique_ptr<Importer>> openAssembly(const std::string& path,
                                               std::unique_ptr<RandomAccessFile> file,
                                               const ImportLimits& limits) {
    if (limits.nesting == kMaxNesting) {
        return fail("{}: assemblies stand in one another more than {} deep: does one name itself?", path,
                    kMaxNesting);
    }
    // While it is understood, a text takes many times its size.
    const std::uint64_t most = limits.memoryBytes / kBytesForText;
    if (file->size() > most) {
        return fail("{}: is larger than {}: give more --memory, or split it into assemblies of assemblies",
                    path, formatBytes(most));
    }
    ASSIGN_OR_RETURN(const std::string text, readWholeFile(path, most));
    ASSIGN_OR_RETURN(Assembly assembly, parseAssembly(text, path));
    ImportLimits inner = limits;
    ++inner.nesting;
    inner.memoryBytes -= assembly.count * sizeof(Placement);
    inner.copies *= assembly.count;
    if (inner.copies > kMaxCopies) return fail("{}: places more than {} parts", path, kMaxCopies);
    return std::unique_ptr<Importer>(std::make_unique<AssemblyImporter>(std::move(assembly), inner));
}

}  // namespace iwalk
