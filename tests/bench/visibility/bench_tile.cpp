#include "tests/bench/visibility/bench_tile.hpp"

#include <algorithm>
#include <cstring>

#include "common/dataset/page_files.hpp"
#include "server/frame/tile_counters.hpp"
#include "server/visibility/depth_pyramid.hpp"
#include "tests/bench/visibility/item_buffer.hpp"

namespace iwalk::bench {
namespace {

template <class T>
T orEnd(Result<T> result) {
    if (!result) detail::checkFailed(__FILE__, __LINE__, result.error().message);
    return std::move(result).value();
}

std::unique_ptr<Occlusion> occlusionOf(Method method, Renderer& renderer, Workers& workers) {
    if (method == Method::items) return makeItemBuffer(renderer);
    return orEnd(makeOcclusion(method == Method::hzb ? OcclusionTest::hzb : OcclusionTest::queries, renderer,
                               workers));
}

SceneLook lookOf(const Dataset& dataset) {
    SceneLook look;
    look.stepExponent = dataset.manifest.stepExponent;
    look.bounds = Hierarchy::box(dataset.hierarchy.nodes[0]);
    look.colors = dataset.manifest.colors;
    look.normals = dataset.manifest.normals;
    return look;
}

// All of the tile must be one block.
Block onlyBlock(const TileView& view) {
    const std::vector<Block> blocks = blocksOf(view.tile);
    CHECK_OP(blocks.size(), ==, 1u);
    return blocks[0];
}

}  // namespace

BenchTile::BenchTile(const Dataset& dataset, const PixelRect& rect, Method method, unsigned threads)
    : dataset_(dataset),
      cut_(cutAtLevel(dataset.hierarchy, kFullLevel)),
      visibility_(dataset.hierarchy),
      workers_(threads) {
    std::uint64_t bytes = 0;
    for (const PageRecord& page : dataset.hierarchy.pages) bytes += pageLayout(page).bytes;
    pixels_ = orEnd(TilePixels::create(rect.width, rect.height));
    renderer_ = orEnd(Renderer::create({&rect, 1}, lookOf(dataset)));
    memory_ = orEnd(renderer_->lendArena(bytes));
    cache_ =
        std::make_unique<PageCache>(dataset.hierarchy, orEnd(openPageFiles(dataset.path, dataset.manifest)),
                                    Arena(memory_, Renderer::kArenaAlignment), 2);
    pages_.emplace(dataset.hierarchy, *cache_, *renderer_);
    if (method == Method::frustum) return;
    occlusion_ = occlusionOf(method, *renderer_, workers_);
    conservative_.emplace(visibility_, *cache_, *renderer_, *pages_, *occlusion_, 0);
}

template <class Fill>
protocol::TileStats BenchTile::timed(const TileView& view, Fill fill) {
    protocol::TileStats stats;
    Stopwatch watch;
    const BlockView block(view, onlyBlock(view));
    renderer_->beginFrame(view, *pixels_);
    fill(block, stats);
    renderer_->finish();
    cache_->release();
    stats.drawMs = watch.lap();  // of the whole frame
    return stats;
}

std::vector<VisibleRanges> BenchTile::inFrustum(const TileView& view) const {
    const BlockView block(view, onlyBlock(view));
    return visibility_.visible(cut_, block.frustum, block.eye);
}

protocol::TileStats BenchTile::draw(const TileView& view) {
    return timed(view, [&](const BlockView& block, protocol::TileStats& stats) {
        Stopwatch watch;
        const std::vector<VisibleRanges> all = inFrustum(view);
        stats.visibilityMs = watch.lap();
        conservative_->drawBlock(block, all, stats);
    });
}

protocol::TileStats BenchTile::drawRanges(const TileView& view, std::span<const VisibleRanges> ranges) {
    drawn_.clear();
    return timed(view, [&](const BlockView& block, protocol::TileStats& stats) {
        cache_->beginFrame(pagesOf(ranges));
        renderer_->beginBlock(block.block);
        PageDrawing::Page page;
        while (!ranges.empty()) {
            CHECK(pages_->take(block, ranges, page, [] {}));
            if (page.ranges.empty()) continue;
            CHECK_OP(pages_->draw(page, stats), ==, drawn_.size());
            drawn_.push_back(page.page);
        }
    });
}

std::vector<VisibleRanges> BenchTile::notHidden(const TileView& view) {
    DepthPyramid pyramid;
    renderer_->readBlockDepths(pyramid);
    const std::vector<VisibleRanges> all = inFrustum(view);
    const BlockView block(view, onlyBlock(view));
    cache_->beginFrame(pagesOf(all));
    std::vector<VisibleRanges> found;
    PageDrawing::Page page;
    for (std::span<const VisibleRanges> left = all; !left.empty();) {
        CHECK(pages_->take(block, left, page, [] {}));
        for (const DrawnRange& range : page.ranges)
            if (!pyramid.hides(range.box)) found.push_back({page.page.page, range.range, 1, page.rank});
    }
    cache_->release();
    return found;
}

void BenchTile::packOwners(BenchTile& into) {
    std::vector<std::uint32_t> pixels;
    renderer_->readBlockTriangles(pixels);
    std::sort(pixels.begin(), pixels.end());
    pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
    into.packed_.clear();
    ArenaPlace place;
    for (auto at = std::upper_bound(pixels.begin(), pixels.end(), 0u); at != pixels.end();) {
        const ResidentPage& page = drawn_[(*at >> 16) - 1];
        const PageRecord& record = dataset_.hierarchy.pages[page.page];
        const PageLayout layout = pageLayout(record);
        if (place.offset + layout.bytes > into.memory_[place.bank].size()) place = {place.bank + 1, 0, 0};
        const std::byte* from = memory_[page.place.bank].data() + page.place.offset;
        std::byte* to = into.memory_[place.bank].data() + place.offset;
        std::memcpy(to, from, layout.indices);

        Packed packed{record, {page.table->origin, {}}, place};
        packed.record.indexCount = 0;
        for (const std::uint32_t number = *at >> 16; at != pixels.end() && *at >> 16 == number; ++at) {
            std::memcpy(to + layout.indices + 2 * packed.record.indexCount,
                        from + layout.indices + 6 * (*at & 0xffff), 6);
            packed.record.indexCount += 3;
        }
        into.packed_.push_back(packed);
        place.offset += layout.bytes;
    }
}

protocol::TileStats BenchTile::drawPacked(const TileView& view) {
    return timed(view, [&](const BlockView& block, protocol::TileStats& stats) {
        renderer_->beginBlock(block.block);
        std::uint32_t rank = 0;
        for (const Packed& packed : packed_) {
            DrawnRange all{0, 0, packed.record.indexCount, {}};
            all.box.depth = 1;
            renderer_->draw({0, packed.place, &packed.table}, packed.record, rank++, std::span(&all, 1));
            stats.triangles += packed.record.indexCount / 3;
        }
    });
}

}  // namespace iwalk::bench
