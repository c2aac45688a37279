#include "preprocess/import/ply_faces.hpp"

#include <algorithm>
#include <cmath>

#include "preprocess/import/ply_bytes.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

class FaceReader {
  public:
    FaceReader(const PlyElement& element, std::size_t indices, PlyValues& values, VertexStore& store,
               TriangleOutput& output)
        : element_(element), indices_(indices), values_(values), store_(store), output_(output) {}

    // Records that are one list of at most 255 indices of 4 bytes: looked at in place. Reads some, from face
    // `face` on, and returns how many.
    template <bool swap>
    Result<std::uint64_t> readPlain(std::uint64_t face) {
        ByteStream& stream = *values_.stream();
        RETURN_IF_ERROR(stream.fill(kPlainWindow));
        const std::string_view window = stream.view().substr(0, kPlainWindow);
        const char* at = window.data();
        const char* const end = at + window.size();
        const std::uint64_t limit = element_.count - face;
        std::uint64_t done = 0;
        for (; done < limit && at != end; ++done) {
            const std::size_t corners = static_cast<unsigned char>(*at);
            if (static_cast<std::size_t>(end - at) < 1 + 4 * corners) break;
            values_.record(element_, face + done);
            RETURN_IF_ERROR(readPlainPolygon<swap>(at + 1, corners));
            at += 1 + 4 * corners;
        }
        stream.advance(static_cast<std::size_t>(at - window.data()));
        if (done > 0) return done;
        values_.record(element_, face);
        return values_.bad("the file ends, it is cut short", stream.offset());
    }

    Result<void> readRecord(std::uint64_t face) {
        values_.record(element_, face);
        for (std::size_t i = 0; i < element_.properties.size(); ++i) {
            RETURN_IF_ERROR(i == indices_ ? readPolygon() : values_.skip(element_.properties[i]));
        }
        return {};
    }

  private:
    static constexpr std::size_t kPlainWindow = std::size_t{64} << 10;

    // Indices in the stream's view.
    template <bool swap>
    Result<void> readPlainPolygon(const char* indices, std::size_t corners) {
        if (corners == 3) {
            Triangle& triangle = output_.next();
            for (std::size_t i = 0; i < 3; ++i) {
                RETURN_IF_ERROR(readPlainCorner<swap>(indices + 4 * i, triangle[i]));
            }
            return output_.add();
        }
        output_.begin();
        for (std::size_t i = 0; i < corners; ++i) {
            Corner corner;
            RETURN_IF_ERROR(readPlainCorner<swap>(indices + 4 * i, corner));
            RETURN_IF_ERROR(output_.corner(corner));
        }
        return {};
    }

    template <bool swap>
    Result<void> readPlainCorner(const char* at, Corner& corner) {
        const auto index = loadBytes<std::uint32_t, swap>(at);
        if (index < store_.size()) return store_.get(index, corner);
        const ByteStream& stream = *values_.stream();
        return badIndex(signedAsWritten(index),
                        stream.offset() + static_cast<std::uint64_t>(at - stream.view().data()));
    }

    Result<void> readPolygon() {
        const PlyProperty& list = element_.properties[indices_];
        ASSIGN_OR_RETURN(std::uint64_t corners, values_.listLength(list.countType, list.type));
        output_.begin();
        for (; corners > 0; --corners) {
            double index = 0;
            RETURN_IF_ERROR(values_.next(list.type, index));
            if (!(index >= 0) || index != std::floor(index) || index >= static_cast<double>(store_.size())) {
                return badIndex(index, values_.place());
            }
            Corner corner;
            RETURN_IF_ERROR(store_.get(static_cast<std::uint64_t>(index), corner));
            RETURN_IF_ERROR(output_.corner(corner));
        }
        return {};
    }

    double signedAsWritten(std::uint32_t index) const {
        const bool isSigned = element_.properties[indices_].type == PlyType::int32;
        return isSigned ? static_cast<std::int32_t>(index) : static_cast<double>(index);
    }

    Error badIndex(double index, std::uint64_t place) const {
        return values_.bad(fmt::format("vertex index {}, but there are {} vertices", index, store_.size()),
                           place);
    }

    const PlyElement& element_;
    std::size_t indices_;  // the property
    PlyValues& values_;
    VertexStore& store_;
    TriangleOutput& output_;
};

bool isPlain(const PlyElement& element) {
    const PlyProperty& p = element.properties[0];
    return element.properties.size() == 1 && p.countType == PlyType::uint8 &&
           (p.type == PlyType::int32 || p.type == PlyType::uint32);
}

}  // namespace

bool isPlyIndices(const PlyProperty& property) {
    return property.name == "vertex_indices" || property.name == "vertex_index";
}

Result<std::size_t> findPlyIndices(const PlyElement& element, const std::string& path) {
    const auto found = std::ranges::find_if(element.properties, isPlyIndices);
    if (found == element.properties.end()) {
        return fail("{}: element {} has no list vertex_indices: no triangles to read", path,
                    quote(element.name));
    }
    if (!found->list || isFloat(found->type)) {
        return fail("{}: {} is not a list of whole numbers: no triangles to read", path, quote(found->name));
    }
    return static_cast<std::size_t>(found - element.properties.begin());
}

Result<void> readPlyFaces(const PlyElement& element, PlyFormat format, PlyValues& values,
                          const std::string& path, VertexStore& store, TriangleOutput& output,
                          ProgressMeter& progress) {
    ASSIGN_OR_RETURN(const std::size_t indices, findPlyIndices(element, path));
    FaceReader reader(element, indices, values, store, output);
    const bool plain = values.stream() && isPlain(element);
    for (std::uint64_t face = 0; face < element.count;) {
        if (plain) {
            ASSIGN_OR_RETURN(const std::uint64_t done, format == PlyFormat::bigEndian
                                                           ? reader.readPlain<true>(face)
                                                           : reader.readPlain<false>(face));
            face += done;
        } else {
            RETURN_IF_ERROR(reader.readRecord(face++));
        }
        progress.at(values.offset());
    }
    return {};
}

}  // namespace iwalk
