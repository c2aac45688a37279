#pragma once

#include <cstdint>
#include <string_view>

namespace iwalk {

enum class ObjKeyword { vertex, normal, face, materialLibrary, useMaterial, other };

// A line of an OBJ file: what it is about, and the rest of it.
struct ObjLine {
    ObjKeyword keyword = ObjKeyword::other;
    std::string_view rest;
};
ObjLine splitObjLine(std::string_view line);

// A corner of a face as written: numbers from 1 on, or backwards from -1; 0 where there is none.
struct ObjCorner {
    std::int64_t vertex = 0, normal = 0;
};
// Takes the next corner, v or v/vt or v//vn or v/vt/vn, off `text`. False when there is none or it is
// malformed: `text` is blank in the first case only.
bool takeObjCorner(std::string_view& text, ObjCorner& corner);

// Takes up to `limit` numbers off `text` into `values`, up to the end or a comment; returns how many. What
// follows stays in `text`. Behind `text` stands a character that no number holds.
std::size_t takeObjNumbers(std::string_view& text, double* values, std::size_t limit);

// The index from 0 on that `number` means when `before` items of its kind came before and there are `total`
// in the file; `total` or more when it means none.
std::uint64_t resolveObjIndex(std::int64_t number, std::uint64_t before, std::uint64_t total);

}  // namespace iwalk
