#include "preprocess/levels/level_slice.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "preprocess/build/grid.hpp"

namespace iwalk {
namespace {

// A range of a source, placed in the entry's cell.
struct SourceRange {
    std::uint64_t key;  // Morton key of its cell's lowest corner
    unsigned levels;    // of its cell below the entry's
    const LevelSource* source;
    const Range* range;
};

unsigned levelsOf(const LevelSource& source, const Range& range) {
    return source.wayLevels + pathLevels(range.path);
}

std::uint64_t keyOf(const LevelSource& source, const Range& range) {
    const unsigned levels = pathLevels(range.path);
    const std::uint64_t path = range.path & ((std::uint64_t{1} << 3 * levels) - 1);
    const unsigned depth = source.wayLevels + levels;
    const std::uint64_t morton = source.way << 3 * levels | path;
    // Deeper than keys reach, cells are told apart no more.
    return 3 * depth <= kMortonKeyBits ? morton << (kMortonKeyBits - 3 * depth)
                                       : morton >> (3 * depth - kMortonKeyBits);
}

std::vector<SourceRange> sortedRanges(std::span<const LevelSource> sources) {
    std::vector<SourceRange> ranges;
    for (const LevelSource& source : sources) {
        for (const Range& range :
             std::span(source.page->ranges).subspan(source.firstRange, source.rangeCount))
            ranges.push_back({keyOf(source, range), levelsOf(source, range), &source, &range});
    }
    std::ranges::stable_sort(ranges, {},
                             [](const SourceRange& range) { return std::pair(range.key, range.levels); });
    return ranges;
}

const CellPoint& positionOf(const LevelSource& source, std::uint16_t vertex) {
    return source.targets != nullptr ? source.targets->positions[vertex] : source.page->positions[vertex];
}

}  // namespace

RunSource RangeImages::add(const LevelSource& source, const Range& range,
                           std::vector<std::uint32_t>& records) {
    images_.clear();
    points_.clear();
    for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; i += 3)
        addImage(source, i);
    removeEqual();
    for (const Image& image : images_)
        addRecord(source, {image.triangle, image.triangle + 1, image.triangle + 2}, records);
    return {keyOf(source, range), levelsOf(source, range), images_.size(), boxOf(source, range)};
}

void RangeImages::addPoint(const LevelSource& source, const Range& range,
                           std::vector<std::uint32_t>& records) const {
    const std::uint32_t corner = range.firstIndex;
    addRecord(source, {corner, corner, corner}, records);
}

// Of all that is in the range's cell at finer levels.
LatticeBox RangeImages::boxOf(const LevelSource& source, const Range& range) const {
    const LatticePoint origin = lattice_.fromCell(source.page->origin);
    const auto corner = [&](const std::uint32_t(&p)[3]) { return origin + LatticePoint(p[0], p[1], p[2]); };
    return {corner(range.boxMin), corner(range.boxMax)};
}

void RangeImages::addImage(const LevelSource& source, std::uint32_t first) {
    std::array<std::uint32_t, 3> points{};
    for (std::size_t c = 0; c < 3; ++c)
        points[c] = points_.add(positionOf(source, source.page->indices[first + c])).first;
    if (points[0] == points[1] || points[1] == points[2] || points[2] == points[0]) return;
    Image image{points, first, false};
    const auto order = [&](std::size_t a, std::size_t b) {
        if (image.points[a] < image.points[b]) return;
        std::swap(image.points[a], image.points[b]);
        image.turned = !image.turned;
    };
    order(0, 1), order(1, 2), order(0, 1);
    images_.push_back(image);
}

// Of n triangles one way round and m the other, |n - m| or, when they are as many, one each way stay.
void RangeImages::removeEqual() {
    std::ranges::sort(images_, {}, [](const Image& i) { return std::tuple(i.points, i.turned, i.triangle); });
    std::vector<Image> kept;
    for (std::size_t begin = 0, end = 0; begin < images_.size(); begin = end) {
        std::size_t turned = 0;
        for (end = begin; end < images_.size() && images_[end].points == images_[begin].points; ++end) {
            turned += images_[end].turned ? 1 : 0;
        }
        const std::size_t straight = end - begin - turned;
        const std::size_t pairs = std::min(straight, turned);
        const std::size_t gone = straight == turned ? pairs - 1 : pairs;
        for (std::size_t i = begin; i < begin + straight - gone; ++i) kept.push_back(images_[i]);
        for (std::size_t i = begin + straight; i < end - gone; ++i) kept.push_back(images_[i]);
    }
    std::ranges::sort(kept, {}, &Image::triangle);
    images_ = std::move(kept);
}

// Rounded up, so that it stays a bound.
std::uint8_t RangeImages::errorOf(float error) const {
    return static_cast<std::uint8_t>(std::clamp(std::ceil(error * 255.0f / errorLimit_), 0.0f, 255.0f));
}

// `corners`: places in the page's indices.
void RangeImages::addRecord(const LevelSource& source, const std::array<std::uint32_t, 3>& corners,
                            std::vector<std::uint32_t>& records) const {
    const auto& colors = source.targets != nullptr ? source.targets->colors : source.page->colors;
    const auto& normals = source.targets != nullptr ? source.targets->normals : source.page->normals;
    TriangleRecord record;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::uint16_t vertex = source.page->indices[corners[c]];
        record.positions[c] = positionOf(source, vertex);
        if (!colors.empty()) record.colors[c] = colors[vertex];
        if (!normals.empty()) record.normals[c] = normals[vertex];
        record.errors[c] =
            source.targets != nullptr ? errorOf(source.targets->errors[vertex]) : std::uint8_t{0};
    }
    records.resize(records.size() + format_.words());
    format_.pack(record, records.data() + records.size() - format_.words());
}

Slice makeLevelSlice(const RecordFormat& format, const Lattice& lattice, std::span<const LevelSource> sources,
                     float errorLimit, unsigned leastLevels) {
    const std::vector<SourceRange> ranges = sortedRanges(sources);
    std::size_t most = 0;  // triangles
    for (const SourceRange& range : ranges) most += range.range->indexCount / 3;
    Slice slice;
    slice.owned.reserve(most * format.words());
    RangeImages images(format, lattice, errorLimit);
    std::vector<RunSource> parts;
    for (const SourceRange& range : ranges) {
        parts.push_back(images.add(*range.source, *range.range, slice.owned));
        slice.box.add(parts.back().box);
    }
    if (slice.owned.empty()) {
        images.addPoint(*ranges.front().source, *ranges.front().range, slice.owned);
        parts.front().triangles = 1;
    }
    slice.count = slice.owned.size() / format.words();
    slice.records = slice.owned.data();
    slice.runs = joinRanges(parts, leastLevels);
    return slice;
}

}  // namespace iwalk
