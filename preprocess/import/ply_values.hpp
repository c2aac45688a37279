#pragma once

#include <memory>
#include <string>

#include "preprocess/import/byte_stream.hpp"
#include "preprocess/import/ply_header.hpp"

namespace iwalk {

// The data part of a PLY file as one sequence of values, whatever its format. Errors name the file, the
// element and the byte.
class PlyValues {
  public:
    virtual ~PlyValues() = default;
    // The next value. All types of PLY are exact as doubles.
    virtual Result<void> next(PlyType type, double& value) = 0;
    // Passes over `count` values.
    virtual Result<void> skip(PlyType type, std::uint64_t count) = 0;

    // The next value as a list's length: a whole number that the rest of the file has room for, in items of
    // `item`.
    Result<std::uint64_t> listLength(PlyType countType, PlyType item);
    // Passes over one property of a record.
    Result<void> skip(const PlyProperty& property);

    // What the values belong to from now on, for messages. `element` must outlive its use.
    void record(const PlyElement& element, std::uint64_t index) { element_ = &element, index_ = index; }
    // "PATH: element 'face' 17: WHAT (byte N)", where N is the place of the value last read.
    Error bad(std::string_view what) const { return bad(what, valueAt_); }
    Error bad(std::string_view what, std::uint64_t offset) const;

    std::uint64_t place() const { return valueAt_; }  // byte of the file
    ByteStream& stream() { return stream_; }

  protected:
    PlyValues(ByteStream& stream, const std::string& path) : stream_(stream), path_(path) {}
    virtual std::uint64_t leastItemBytes(PlyType type) const = 0;

    ByteStream& stream_;
    std::uint64_t valueAt_ = 0;  // of the value last read

  private:
    const std::string& path_;
    const PlyElement* element_ = nullptr;
    std::uint64_t index_ = 0;
};

// `stream` and `path` must outlive it.
std::unique_ptr<PlyValues> makePlyValues(PlyFormat format, ByteStream& stream, const std::string& path);

// Value of `type` at `bytes`, which has the other byte order when `swap`.
double loadPlyValue(PlyType type, bool swap, const char* bytes);

}  // namespace iwalk
