#include "preprocess/levels/level_slice.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "preprocess/build/grid.hpp"
#include "preprocess/levels/cell_runs.hpp"
#include "preprocess/levels/numbers.hpp"

namespace iwalk {
namespace {

// A range of a source, placed in the entry's cell.
struct SourceRange {
    std::uint64_t key;  // Morton key of its cell's lowest corner
    unsigned levels;    // of its cell below the entry's
    std::size_t source;
    const Range* range;
};

// A triangle of the image.
struct Image {
    std::array<std::uint32_t, 3> points;  // numbers, ascending
    std::uint32_t triangle;               // its place in the order
    bool turned;                          // ascending order turned it over
};

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
    for (std::size_t s = 0; s < sources.size(); ++s) {
        for (std::uint32_t r = 0; r < sources[s].rangeCount; ++r) {
            const Range& range = sources[s].page->ranges[sources[s].firstRange + r];
            ranges.push_back(
                {keyOf(sources[s], range), sources[s].wayLevels + pathLevels(range.path), s, &range});
        }
    }
    std::ranges::stable_sort(ranges, {},
                             [](const SourceRange& range) { return std::pair(range.key, range.levels); });
    return ranges;
}

class Maker {
  public:
    Maker(const RecordFormat& format, const Lattice& lattice, std::span<const LevelSource> sources,
          float errorLimit)
        : format_(format),
          lattice_(lattice),
          sources_(sources),
          errorLimit_(errorLimit),
          numbers_(sources.size()) {}

    Slice run(unsigned leastLevels) {
        const std::vector<SourceRange> ranges = sortedRanges(sources_);
        std::size_t most = 0;  // triangles
        for (const SourceRange& range : ranges) most += range.range->indexCount / 3;
        slice_.owned.reserve(most * format_.words());
        std::vector<RunSource> parts;
        for (const SourceRange& range : ranges) {
            const std::size_t before = slice_.count;
            addTriangles(range);
            parts.push_back({range.key, range.levels, slice_.count - before, boxOf(range)});
            slice_.box.add(parts.back().box);
        }
        if (slice_.count == 0) {
            addPoint(ranges.front());
            parts.front().triangles = 1;
        }
        slice_.records = slice_.owned.data();
        slice_.runs = joinRanges(parts, leastLevels);
        return std::move(slice_);
    }

  private:
    // Of all that is in the range's cell at finer levels.
    LatticeBox boxOf(const SourceRange& range) const {
        const LatticePoint origin = lattice_.fromCell(sources_[range.source].page->origin);
        const auto corner = [&](const std::uint32_t(&p)[3]) {
            return origin + LatticePoint(p[0], p[1], p[2]);
        };
        return {corner(range.range->boxMin), corner(range.range->boxMax)};
    }

    // An entry of which nothing is left keeps its place: a triangle that is a point.
    void addPoint(const SourceRange& range) {
        const std::uint32_t corner = range.range->firstIndex;
        addRecord(sources_[range.source], {corner, corner, corner});
    }

    // Of one range: equal triangles of different ranges both stay, since one may be drawn finer than the
    // other.
    void addTriangles(const SourceRange& range) {
        images_.clear();
        const LevelSource& source = sources_[range.source];
        for (std::uint32_t i = range.range->firstIndex; i < range.range->firstIndex + range.range->indexCount;
             i += 3) {
            addImage(source, i);
        }
        removeEqual();
        for (const Image& image : images_) {
            addRecord(source, {image.triangle, image.triangle + 1, image.triangle + 2});
        }
    }

    void addImage(const LevelSource& source, std::uint32_t first) {
        std::vector<std::uint32_t>& numbers = numbers_[static_cast<std::size_t>(&source - sources_.data())];
        if (numbers.empty()) numbers.assign(source.page->positions.size(), kNoNumber);
        std::array<std::uint32_t, 3> points{};
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint16_t vertex = source.page->indices[first + c];
            std::uint32_t& number = numbers[vertex];
            if (number == kNoNumber) number = points_.add(positionOf(source, vertex)).first;
            points[c] = number;
        }
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
    void removeEqual() {
        std::ranges::sort(images_, {},
                          [](const Image& i) { return std::tuple(i.points, i.turned, i.triangle); });
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

    const CellPoint& positionOf(const LevelSource& source, std::uint16_t vertex) const {
        return source.targets != nullptr ? source.targets->positions[vertex] : source.page->positions[vertex];
    }

    // Rounded up, so that it stays a bound.
    std::uint8_t errorOf(float error) const {
        return static_cast<std::uint8_t>(std::clamp(std::ceil(error * 255.0f / errorLimit_), 0.0f, 255.0f));
    }

    // `corners`: places in the page's indices.
    void addRecord(const LevelSource& source, const std::array<std::uint32_t, 3>& corners) {
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
        slice_.owned.resize(slice_.owned.size() + format_.words());
        format_.pack(record, slice_.owned.data() + slice_.owned.size() - format_.words());
        ++slice_.count;
    }

    const RecordFormat& format_;
    const Lattice& lattice_;
    std::span<const LevelSource> sources_;
    float errorLimit_;
    Numbers<CellPoint, PointHash> points_;
    std::vector<std::vector<std::uint32_t>> numbers_;  // by source and vertex: of its image
    std::vector<Image> images_;
    Slice slice_;
};

}  // namespace

Slice makeLevelSlice(const RecordFormat& format, const Lattice& lattice, std::span<const LevelSource> sources,
                     float errorLimit, unsigned leastLevels) {
    return Maker(format, lattice, sources, errorLimit).run(leastLevels);
}

}  // namespace iwalk
