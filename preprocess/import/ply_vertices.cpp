#include "preprocess/import/ply_vertices.hpp"

#include <algorithm>

#include "preprocess/import/ply_bytes.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kWindowBytes = std::size_t{64} << 10;  // of records converted at a time

VertexColumn columnNamed(std::string_view name) {
    static constexpr std::string_view kNames[] = {"x",  "y",   "z",     "nx",   "ny",
                                                  "nz", "red", "green", "blue", "alpha"};
    if (name.starts_with("diffuse_")) name.remove_prefix(8);
    const auto* const found = std::ranges::find(kNames, name);
    return found == std::end(kNames) ? kNoColumn : static_cast<VertexColumn>(found - std::begin(kNames));
}

// To 0..255: bytes as they are, 16 bits scaled, floats from 0..1.
double colorFactor(PlyType type) {
    if (isFloat(type)) return 255;
    return type == PlyType::uint16 ? 1 / 257.0 : 1;
}

// Reads one field of many records: the type is looked at once for all of them.
template <class T, bool swap>
void loadColumn(const char* from, std::size_t stride, std::size_t rows, double factor, double* to) {
    for (std::size_t row = 0; row < rows; ++row, from += stride) {
        to[row] = static_cast<double>(loadBytes<T, swap>(from)) * factor;
    }
}

void loadColumns(const PlyElement& element, const PlyVertexPlan& plan, bool swap, const char* records,
                 std::size_t stride, VertexBatch& batch) {
    for (std::size_t i = 0; i < plan.fields.size(); ++i) {
        const PlyVertexPlan::Field& field = plan.fields[i];
        if (field.column == kNoColumn) continue;
        double* const to = batch.columns[static_cast<std::size_t>(field.column)].data();
        const char* const from = records + field.offset;
        withPlyType(element.properties[i].type, [&]<class T>(T) {
            swap ? loadColumn<T, true>(from, stride, batch.rows, field.factor, to)
                 : loadColumn<T, false>(from, stride, batch.rows, field.factor, to);
        });
    }
}

class VertexReader {
  public:
    VertexReader(const PlyElement& element, const PlyVertexPlan& plan, PlyValues& values)
        : element_(element), plan_(plan), values_(values) {}

    // A binary file without lists: records of one size.
    Result<void> readFixed(std::uint64_t first, std::uint64_t rows, bool swap) {
        ByteStream& stream = *values_.stream();
        const auto stride = static_cast<std::size_t>(element_.leastBytes(PlyFormat::littleEndian));
        const std::uint64_t window =
            std::min<std::uint64_t>(VertexBatch::kRows, std::max<std::size_t>(kWindowBytes / stride, 1));
        batch_.rows = static_cast<std::size_t>(std::min(rows, window));
        RETURN_IF_ERROR(stream.fill(batch_.rows * stride));
        if (stream.view().size() < batch_.rows * stride) {
            const std::size_t whole = stream.view().size() / stride;
            values_.record(element_, first + whole);
            return values_.bad("the file ends, it is cut short", stream.offset() + whole * stride);
        }
        loadColumns(element_, plan_, swap, stream.view().data(), stride, batch_);
        stream.advance(batch_.rows * stride);
        return {};
    }

    // Any other file, value by value.
    Result<void> readValues(std::uint64_t first, std::uint64_t rows) {
        batch_.rows = static_cast<std::size_t>(std::min<std::uint64_t>(rows, VertexBatch::kRows));
        for (std::size_t row = 0; row < batch_.rows; ++row) {
            values_.record(element_, first + row);
            RETURN_IF_ERROR(readRecord(row));
        }
        return {};
    }

    const VertexBatch& batch() const { return batch_; }

  private:
    Result<void> readRecord(std::size_t row) {
        for (std::size_t i = 0; i < plan_.fields.size(); ++i) {
            const PlyVertexPlan::Field& field = plan_.fields[i];
            if (field.column == kNoColumn) {
                RETURN_IF_ERROR(values_.skip(element_.properties[i]));
                continue;
            }
            double value = 0;
            RETURN_IF_ERROR(values_.next(element_.properties[i].type, value));
            batch_.columns[static_cast<std::size_t>(field.column)][row] = value * field.factor;
        }
        return {};
    }

    const PlyElement& element_;
    const PlyVertexPlan& plan_;
    PlyValues& values_;
    VertexBatch batch_;
};

bool hasColumns(const PlyVertexPlan& plan, VertexColumn first) {
    const auto has = [&](int column) {
        return std::ranges::any_of(plan.fields, [=](const auto& field) { return field.column == column; });
    };
    return has(first) && has(first + 1) && has(first + 2);
}

}  // namespace

Result<PlyVertexPlan> planPlyVertices(const PlyElement& element, const std::string& path) {
    PlyVertexPlan plan;
    std::size_t offset = 0;
    for (const PlyProperty& property : element.properties) {
        PlyVertexPlan::Field field{columnNamed(property.name), offset};
        offset += plyTypeBytes(property.list ? property.countType : property.type);
        const auto same = [&](const PlyVertexPlan::Field& other) { return other.column == field.column; };
        // Of red and diffuse_red the first counts.
        if (property.list || std::ranges::any_of(plan.fields, same)) field.column = kNoColumn;
        if (field.column >= kRed) field.factor = colorFactor(property.type);
        if (field.column >= kX && field.column <= kZ && isFloat(property.type)) {
            plan.precisionBits = std::max(plan.precisionBits, property.type == PlyType::float64 ? 52 : 23);
        }
        // 32-bit integers do not fit in a float.
        if (field.column >= kX && field.column <= kZ)
            plan.format.doubles |= plyTypeBytes(property.type) >= 4 && property.type != PlyType::float32;
        plan.fields.push_back(field);
    }
    if (!hasColumns(plan, kX))
        return fail("{}: element 'vertex' lacks a number x, y or z: no positions to read", path);
    plan.format.normals = hasColumns(plan, kNormalX);
    plan.format.colors = hasColumns(plan, kRed);
    return plan;
}

Result<void> readPlyVertices(const PlyElement& element, PlyFormat format, const PlyVertexPlan& plan,
                             PlyValues& values, VertexStore& store, const VertexSink& sink,
                             ProgressMeter& progress) {
    // On the heap: a batch is 80 KiB.
    const auto reader = std::make_unique<VertexReader>(element, plan, values);
    const bool fixed = values.stream() && !element.hasLists();
    for (std::uint64_t done = 0; done < element.count; done += reader->batch().rows) {
        const std::uint64_t rows = element.count - done;
        RETURN_IF_ERROR(fixed ? reader->readFixed(done, rows, format == PlyFormat::bigEndian)
                              : reader->readValues(done, rows));
        RETURN_IF_ERROR(store.add(reader->batch(), sink));
        progress.at(values.offset());
    }
    return {};
}

}  // namespace iwalk
