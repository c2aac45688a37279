// 3D Systems, "StereoLithography Interface Specification", 1989. What writers make of it: binary headers that
// begin with "solid", counts that were never filled in, several solids in one text, names with blanks.
#include "preprocess/import/stl_importer.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstring>

#include "preprocess/import/byte_stream.hpp"
#include "preprocess/import/line_reader.hpp"
#include "preprocess/import/number.hpp"
#include "preprocess/import/progress_meter.hpp"
#include "preprocess/import/text.hpp"
#include "preprocess/import/triangle_output.hpp"
#include "preprocess/import/vertex_output.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {
namespace {

constexpr std::uint64_t kHeaderBytes = 84;  // 80 of text, then the number of triangles
constexpr std::size_t kRecordBytes = 50;    // normal and three corners as floats, two bytes of anything
constexpr std::size_t kCornersAt = 12;      // in a record
constexpr std::size_t kWindowRecords = 1280;

class StlImporter : public Importer {
  public:
    StlImporter(std::string path, std::unique_ptr<RandomAccessFile> file)
        : path_(std::move(path)), file_(std::move(file)) {}

    Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) override {
        VertexOutput output(vertices);
        ImportSummary summary;
        RETURN_IF_ERROR(eachTriangle(progress, [&](const Triangle& triangle) {
            for (const Corner& corner : triangle) output.add(corner.position);
            ++summary.triangleBound;
            return Result<void>();
        }));
        output.finish(summary);
        summary.precision = coordinateSpacing(summary.bounds, 23);
        return summary;
    }

    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override {
        TriangleOutput output(false, sink);
        RETURN_IF_ERROR(eachTriangle(progress, [&](const Triangle& triangle) {
            output.next() = triangle;
            return output.add();
        }));
        RETURN_IF_ERROR(output.flush());
        return output.counts();
    }
    bool needsScan() const override { return false; }

  protected:
    // In the order of the file.
    using Visit = std::function<Result<void>(const Triangle&)>;
    virtual Result<void> eachTriangle(const ProgressSink& progress, const Visit& visit) = 0;

    const std::string path_;
    const std::unique_ptr<RandomAccessFile> file_;
};

class BinaryStl : public StlImporter {
  public:
    BinaryStl(std::string path, std::unique_ptr<RandomAccessFile> file, std::uint64_t count)
        : StlImporter(std::move(path), std::move(file)), count_(count) {}

  private:
    // All of the records lie within the file: openBinary() has seen to it.
    Result<void> eachTriangle(const ProgressSink& progress, const Visit& visit) override {
        ByteStream stream(*file_, kHeaderBytes);
        ProgressMeter meter(progress, kHeaderBytes, file_->size());
        Triangle triangle;
        for (std::uint64_t done = 0; done < count_;) {
            const auto records =
                static_cast<std::size_t>(std::min<std::uint64_t>(count_ - done, kWindowRecords));
            RETURN_IF_ERROR(stream.fill(records * kRecordBytes));
            const char* at = stream.view().data() + kCornersAt;
            for (std::size_t i = 0; i < records; ++i, at += kRecordBytes) {
                std::array<float, 9> numbers;
                std::memcpy(numbers.data(), at, sizeof numbers);
                for (std::size_t corner = 0; corner < 3; ++corner) {
                    triangle[corner].position =
                        glm::dvec3(numbers[3 * corner], numbers[3 * corner + 1], numbers[3 * corner + 2]);
                }
                RETURN_IF_ERROR(visit(triangle));
            }
            stream.advance(records * kRecordBytes);
            done += records;
            meter.at(stream.offset());
        }
        meter.done();
        return {};
    }

    std::uint64_t count_;
};

class TextStl : public StlImporter {
  public:
    using StlImporter::StlImporter;

  private:
    // Only the words that matter are looked at: `vertex`, which brings a corner, and `endloop`, which says
    // that three have come. Facets of more corners are fanned.
    Result<void> eachTriangle(const ProgressSink& progress, const Visit& visit) override {
        LineReader lines(*file_, path_);
        ProgressMeter meter(progress, 0, file_->size());
        Triangle triangle;
        std::size_t corners = 0;  // of the loop under way
        bool ended = false;       // the solid that began last
        for (std::string_view line;;) {
            ASSIGN_OR_RETURN(const bool more, lines.next(line));
            if (!more) break;
            while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
            if (line.starts_with("vertex") || line.starts_with("VERTEX")) {
                if (corners == 3) triangle[1] = triangle[2];
                RETURN_IF_ERROR(readCorner(line, lines, triangle[std::min<std::size_t>(corners, 2)]));
                corners = std::min<std::size_t>(corners + 1, 3);
                if (corners == 3) RETURN_IF_ERROR(visit(triangle));
            } else if (line.starts_with("endloop") || line.starts_with("ENDLOOP")) {
                if (corners < 3) return lines.bad("a facet needs three corners");
                corners = 0;
            } else if (line.starts_with("solid") || line.starts_with("SOLID")) {
                ended = false;
            } else if (line.starts_with("endsolid") || line.starts_with("ENDSOLID")) {
                ended = true;
            }
            meter.at(lines.offset());
        }
        if (corners != 0) return lines.bad("the file ends within a facet, it is cut short");
        if (!ended) spdlog::warn("{}: has no endsolid: the file may be cut short", path_);
        meter.done();
        return {};
    }

    static Result<void> readCorner(std::string_view line, const LineReader& lines, Corner& corner) {
        std::string_view rest = line.substr(6);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::string_view word = takeWord(rest);
            double value = 0;
            if (word.empty() || parseNumber(word.data(), value) != word.data() + word.size())
                return lines.bad(fmt::format("a vertex needs three numbers, not {}", quote(line.substr(6))));
            corner.position[axis] = value;
        }
        return {};
    }
};

bool looksLikeText(std::string_view head) {
    const std::string_view begin = trim(head);
    const bool solid = begin.starts_with("solid") || begin.starts_with("SOLID");
    return solid && std::ranges::none_of(
                        head, [](char c) { return static_cast<unsigned char>(c) < 32 && !isSpace(c); });
}

Result<std::unique_ptr<Importer>> openBinary(const std::string& path, std::unique_ptr<RandomAccessFile> file,
                                             std::uint32_t written) {
    const std::uint64_t bytes = file->size() - kHeaderBytes, room = bytes / kRecordBytes;
    std::uint64_t count = written;
    // Writers that stream do not come back to the header.
    const bool unfilled = written == 0 || written == 0xffffffff || written == 0x80000000;
    if (unfilled && bytes % kRecordBytes == 0 && count != room) {
        spdlog::warn("{}: the header says {} triangles, the file has {}: these are read", path, count, room);
        count = room;
    }
    if (count > room) {
        return fail("{}: the header (byte 80) says {} triangles, the file has room for {}: it is cut short",
                    path, count, room);
    }
    if (bytes > count * kRecordBytes) {
        spdlog::warn("{}: {} bytes behind the {} triangles that the header says are not read", path,
                     bytes - count * kRecordBytes, count);
    }
    return std::unique_ptr<Importer>(std::make_unique<BinaryStl>(path, std::move(file), count));
}

}  // namespace

Result<std::unique_ptr<Importer>> openStl(const std::string& path, std::unique_ptr<RandomAccessFile> file) {
    std::array<char, 512> head{};
    const auto loaded = static_cast<std::size_t>(std::min<std::uint64_t>(head.size(), file->size()));
    RETURN_IF_ERROR(file->readAt(0, std::as_writable_bytes(std::span(head.data(), loaded))));
    std::uint32_t count = 0;
    std::memcpy(&count, head.data() + 80, sizeof count);
    // A size that fits the count to the byte is no accident, whatever the header begins with.
    const bool exact = file->size() >= kHeaderBytes && file->size() == kHeaderBytes + count * kRecordBytes;
    if (!exact && looksLikeText({head.data(), loaded}))
        return std::unique_ptr<Importer>(std::make_unique<TextStl>(path, std::move(file)));
    if (file->size() < kHeaderBytes) {
        return fail("{}: is no STL: it neither begins with 'solid' nor has the {} bytes of a binary header",
                    path, kHeaderBytes);
    }
    return openBinary(path, std::move(file), count);
}

}  // namespace iwalk
