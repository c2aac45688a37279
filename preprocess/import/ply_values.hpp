#pragma once

#include <memory>
#include <string>

#include "preprocess/import/byte_stream.hpp"
#include "preprocess/import/importer.hpp"
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
    Error bad(std::string_view what) const { return bad(what, place()); }
    Error bad(std::string_view what, std::uint64_t offset) const;

    virtual std::uint64_t place() const = 0;   // of the value last read, byte of the file
    virtual std::uint64_t offset() const = 0;  // behind it
    std::uint64_t rest() const { return file_.size() - offset(); }
    virtual void seek(std::uint64_t offset) = 0;
    // Lets go of what was read ahead: for a while nothing is wanted.
    virtual void pause() {}
    // Of a binary file, for who reads whole records; null of a text.
    virtual ByteStream* stream() { return nullptr; }

  protected:
    PlyValues(const RandomAccessFile& file, const std::string& path) : file_(file), path_(path) {}
    virtual std::uint64_t leastItemBytes(PlyType type) const = 0;

    const RandomAccessFile& file_;

  private:
    const std::string& path_;
    const PlyElement* element_ = nullptr;
    std::uint64_t index_ = 0;
};

// From byte `offset` of `file` on, which must outlive it as `path` must.
std::unique_ptr<PlyValues> makePlyValues(PlyFormat format, const RandomAccessFile& file, std::uint64_t offset,
                                         const std::string& path, const ImportLimits& limits);

// Value of `type` at `bytes`, which has the other byte order when `swap`.
double loadPlyValue(PlyType type, bool swap, const char* bytes);

}  // namespace iwalk
