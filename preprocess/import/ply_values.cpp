#include "preprocess/import/ply_values.hpp"

#include <cmath>

#include "preprocess/import/ply_bytes.hpp"
#include "preprocess/import/ply_text.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

class BinaryValues : public PlyValues {
  public:
    BinaryValues(const RandomAccessFile& file, std::uint64_t offset, const std::string& path, bool swap)
        : PlyValues(file, path), stream_(file, offset), swap_(swap) {}

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

    std::uint64_t place() const override { return valueAt_; }
    std::uint64_t offset() const override { return stream_.offset(); }
    void seek(std::uint64_t offset) override { stream_.seek(offset); }
    ByteStream* stream() override { return &stream_; }

  private:
    std::uint64_t leastItemBytes(PlyType type) const override { return plyTypeBytes(type); }

    ByteStream stream_;
    std::uint64_t valueAt_ = 0;
    bool swap_;
};

}  // namespace

Result<std::uint64_t> PlyValues::listLength(PlyType countType, PlyType item) {
    double count = 0;
    RETURN_IF_ERROR(next(countType, count));
    if (!(count >= 0) || count != std::floor(count)) return bad(fmt::format("a list of length {}", count));
    // One byte more: the last number of a text need not be followed by anything.
    const std::uint64_t room = (rest() + 1) / leastItemBytes(item);
    if (count > static_cast<double>(room)) {
        return bad(fmt::format("a list of {} items in a file with {} bytes left", count, rest()));
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

std::unique_ptr<PlyValues> makePlyValues(PlyFormat format, const RandomAccessFile& file, std::uint64_t offset,
                                         const std::string& path, const ImportLimits& limits) {
    if (format == PlyFormat::ascii) return std::make_unique<PlyTextValues>(file, offset, path, limits);
    return std::make_unique<BinaryValues>(file, offset, path, format == PlyFormat::bigEndian);
}

double loadPlyValue(PlyType type, bool swap, const char* bytes) {
    return withPlyType(type, [&]<class T>(T) {
        return static_cast<double>(swap ? loadBytes<T, true>(bytes) : loadBytes<T, false>(bytes));
    });
}

}  // namespace iwalk
