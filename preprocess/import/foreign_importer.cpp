#include "preprocess/import/foreign_importer.hpp"

#include <algorithm>
#include <cstring>

#include "preprocess/import/exchange.hpp"
#include "preprocess/import/height_grid.hpp"
#include "preprocess/import/import_process.hpp"
#include "preprocess/import/progress_meter.hpp"
#include "preprocess/import/triangle_output.hpp"
#include "preprocess/import/vertex_output.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {
namespace {

constexpr std::uint64_t kLeastMemoryBytes = std::uint64_t{128} << 20;  // the libraries want some
constexpr unsigned kLeastSeconds = 8;                                  // of a processor
constexpr std::uint64_t kBytesASecond = 1'000'000;                     // of a file: slower is given up
constexpr unsigned kClockFactor = 4;  // where others have most of the processor
// A triangle takes 120 bytes, in files 4 at least, compressed ones apart: with instances, more.
constexpr std::uint64_t kExpansion = 256, kLeastOutput = std::uint64_t{256} << 20;
// Heights become floats. Deflate packs up to 1032 bytes in one, which a sea or a hole does of 8-bit samples;
// then a byte of the file is some microseconds of work.
constexpr std::uint64_t kHeightExpansion = 4 * 1032, kHeightBytesASecond = 12'000;

// What both kinds share: the program's output.
class ForeignImporter : public Importer {
  public:
    ForeignImporter(std::string path, std::unique_ptr<SpillFile> file, const ExchangeHeader& header)
        : path_(std::move(path)), file_(std::move(file)), header_(header) {}

  protected:
    const std::string path_;
    const std::unique_ptr<SpillFile> file_;
    const ExchangeHeader header_;
};

class ForeignTriangles : public ForeignImporter {
  public:
    using ForeignImporter::ForeignImporter;

    Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) override {
        VertexOutput output(vertices);
        ImportSummary summary;
        RETURN_IF_ERROR(eachTriangle([&](const Triangle& triangle) {
            for (const Corner& corner : triangle) output.add(corner.position);
            ++summary.triangleBound;
            return Result<void>();
        }));
        output.finish(summary);
        summary.precision = coordinateSpacing(summary.bounds, 23);
        summary.colors = (header_.flags & ExchangeHeader::kColors) != 0;
        summary.normals = (header_.flags & ExchangeHeader::kNormals) != 0;
        if (progress) progress(1);
        return summary;
    }

    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override {
        const bool colors = (header_.flags & ExchangeHeader::kColors) != 0;
        const bool normals = (header_.flags & ExchangeHeader::kNormals) != 0;
        TriangleOutput output(normals, sink);
        RETURN_IF_ERROR(eachTriangle([&](const Triangle& triangle) {
            Triangle& next = output.next();
            next = triangle;
            for (Corner& corner : next) {
                if (!colors) corner.color = 0;
                corner.normal = normals ? unitOrZero(glm::dvec3(corner.normal)) : glm::vec3(0);
            }
            return output.add();
        }));
        RETURN_IF_ERROR(output.flush());
        if (progress) progress(1);
        return output.counts();
    }
    bool needsScan() const override { return false; }

  private:
    template <class Visit>
    Result<void> eachTriangle(const Visit& visit) {
        ExchangeReader reader(*file_, path_);
        if (auto header = reader.header(); !header) return header.error();
        for (;;) {
            ASSIGN_OR_RETURN(const std::span<const std::byte> block, reader.block());
            if (block.empty()) return {};
            for (std::size_t at = 0; at + sizeof(Triangle) <= block.size(); at += sizeof(Triangle)) {
                Triangle triangle;
                std::memcpy(&triangle, block.data() + at, sizeof triangle);
                RETURN_IF_ERROR(visit(triangle));
            }
        }
    }
};

class ForeignHeights : public ForeignImporter {
  public:
    ForeignHeights(std::string path, std::unique_ptr<SpillFile> file, const ExchangeHeader& header,
                   const ImportChoices& choices)
        : ForeignImporter(std::move(path), std::move(file), header),
          grid_(header.columns, header.rows, choices),
          seaLevel_(choices.seaLevel) {}

    Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) override {
        VertexOutput output(vertices);
        RETURN_IF_ERROR(eachRow(progress, [&](std::uint64_t row, std::span<const float> heights) {
            for (std::size_t column = 0; column < heights.size(); ++column)
                output.add(grid_.point(column, row, heights[column]));
            return Result<void>();
        }));
        ImportSummary summary;
        summary.triangleBound = 2 * (header_.columns - 1) * (header_.rows - 1);
        output.finish(summary);
        summary.precision = coordinateSpacing(summary.bounds, 23);
        summary.colors = seaLevel_.has_value();
        if (seaLevel_) ramp_.emplace(summary.bounds.min.z, *seaLevel_, summary.bounds.max.z);
        return summary;
    }

    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override {
        TriangleOutput output(false, sink);
        std::vector<float> above;
        const auto stripTo = [&](std::uint64_t row, std::span<const float> heights) -> Result<void> {
            if (row > 0) RETURN_IF_ERROR(grid_.strip(row, above, heights, ramp_ ? &*ramp_ : nullptr, output));
            above.assign(heights.begin(), heights.end());
            return {};
        };
        RETURN_IF_ERROR(eachRow(progress, stripTo));
        RETURN_IF_ERROR(output.flush());
        return output.counts();
    }
    // The lowest and the highest are what colours go by.
    bool needsScan() const override { return seaLevel_.has_value(); }

  private:
    template <class Visit>
    Result<void> eachRow(const ProgressSink& progress, const Visit& visit) {
        ExchangeReader reader(*file_, path_);
        if (auto header = reader.header(); !header) return header.error();
        ProgressMeter meter(progress, 0, header_.columns * header_.rows * sizeof(float));
        std::vector<float> heights(static_cast<std::size_t>(header_.columns));
        for (std::uint64_t row = 0; row < header_.rows; ++row) {
            ASSIGN_OR_RETURN(const std::span<const std::byte> block, reader.block());
            if (block.size() != heights.size() * sizeof(float))
                return fail("{}: row {} of what iwalk-import made of it is damaged: try again", path_, row);
            std::memcpy(heights.data(), block.data(), block.size());
            RETURN_IF_ERROR(visit(row, std::span<const float>(heights)));
            meter.at(reader.offset());
        }
        meter.done();
        return {};
    }

    const HeightGrid grid_;
    const std::optional<double> seaLevel_;  // model units
    std::optional<HeightRamp> ramp_;        // after scan()
};

}  // namespace

Result<std::unique_ptr<Importer>> openForeign(const std::string& path, ForeignKind kind,
                                              std::uint64_t fileBytes, const ImportLimits& limits) {
    const bool heights = kind == ForeignKind::heights;
    ASSIGN_OR_RETURN(std::unique_ptr<SpillFile> output, SpillFile::create(limits.spillDirectory));
    ImportProcessLimits process;
    process.memoryBytes = std::max(limits.memoryBytes, kLeastMemoryBytes);
    process.fileBytes = std::max(kLeastOutput, fileBytes * (heights ? kHeightExpansion : kExpansion));
    const std::uint64_t wanted = fileBytes / (heights ? kHeightBytesASecond : kBytesASecond);
    process.cpuSeconds = kLeastSeconds + static_cast<unsigned>(std::min<std::uint64_t>(wanted, 100'000));
    process.seconds = process.cpuSeconds * kClockFactor;
    RETURN_IF_ERROR(runImportProcess(path, heights, process, *output, limits.spillDirectory));

    ASSIGN_OR_RETURN(const ExchangeHeader header, ExchangeReader(*output, path).header());
    if (!heights && header.kind == ExchangeHeader::kTriangles)
        return std::unique_ptr<Importer>(std::make_unique<ForeignTriangles>(path, std::move(output), header));
    const bool sized = header.columns >= 2 && header.rows >= 2 && header.columns <= kMostColumns &&
                       header.rows <= kMostColumns;
    if (!heights || header.kind != ExchangeHeader::kHeights || !sized)
        return fail("{}: what iwalk-import made of it is damaged: try again", path);
    return std::unique_ptr<Importer>(
        std::make_unique<ForeignHeights>(path, std::move(output), header, limits.choices));
}

}  // namespace iwalk
