#include "preprocess/import/foreign/image_reader.hpp"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace iwalk {
namespace {

constexpr int kRows = 16;  // at once, of an image without tiles

// The library gives integers as parts of their largest value.
double unitsOf(OIIO::TypeDesc type) {
    switch (type.basetype) {
        case OIIO::TypeDesc::UINT8:
            return 255;
        case OIIO::TypeDesc::INT8:
            return 127;
        case OIIO::TypeDesc::UINT16:
            return 65535;
        case OIIO::TypeDesc::INT16:
            return 32767;
        case OIIO::TypeDesc::HALF:
        case OIIO::TypeDesc::FLOAT:
        case OIIO::TypeDesc::DOUBLE:
            return 1;
        default:
            return 0;
    }
}

}  // namespace

Result<void> exportHeights(const std::string& path, ExchangeWriter& out) {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", 1);
    OIIO::ImageSpec asked;
    asked.attribute("oiio:UnassociatedAlpha", 1);  // samples as they are, however opaque
    const auto image = OIIO::ImageInput::open(path, &asked);
    if (!image) return fail("cannot be read as an image of heights");
    const OIIO::ImageSpec spec = image->spec();
    if (spec.width < 2 || spec.height < 2 || spec.depth > 1 || spec.nchannels < 1 ||
        static_cast<std::uint64_t>(spec.width) > kMostColumns) {
        return fail("has {} x {} x {} samples of {} channels: 2 x 2 to {} x {} can be heights", spec.width,
                    spec.height, spec.depth, spec.nchannels, kMostColumns, kMostColumns);
    }
    const double units = unitsOf(spec.format);
    if (units == 0) return fail("has samples of a type that heights cannot be: 8, 16 bits or floats can");

    ExchangeHeader header;
    header.kind = ExchangeHeader::kHeights;
    header.columns = static_cast<std::uint64_t>(spec.width);
    header.rows = static_cast<std::uint64_t>(spec.height);
    RETURN_IF_ERROR(out.header(header));
    const int step = spec.tile_height > 0 ? spec.tile_height : kRows;
    const auto width = static_cast<std::size_t>(spec.width);
    std::vector<float> rows(width * static_cast<std::size_t>(step));
    for (int first = 0; first < spec.height; first += step) {
        const int last = std::min(first + step, spec.height);
        const bool read =
            spec.tile_width > 0
                ? image->read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + first, spec.y + last, 0, 1, 0,
                                    1, OIIO::TypeDesc::FLOAT, rows.data())
                : image->read_scanlines(0, 0, spec.y + first, spec.y + last, 0, 0, 1, OIIO::TypeDesc::FLOAT,
                                        rows.data());
        if (!read) return fail("cannot be read from row {} on: it is damaged or cut short", first);
        const std::size_t count = width * static_cast<std::size_t>(last - first);
        if (units != 1) {
            for (std::size_t i = 0; i < count; ++i)
                rows[i] = static_cast<float>(std::nearbyint(static_cast<double>(rows[i]) * units));
        }
        for (std::size_t at = 0; at < count; at += width)
            RETURN_IF_ERROR(out.block(std::as_bytes(std::span(rows.data() + at, width))));
    }
    return out.finish();
}

}  // namespace iwalk
