#include "server/frame/birds_eye.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <map>

namespace iwalk {
namespace {

// RGBA8 in memory order.
constexpr std::uint32_t kDrawn = 0xff50c83c, kRead = 0xff323ce6, kLeftOut = 0xffe67850, kFrustum = 0xff3cdcff,
                        kModel = 0xff909090;
constexpr double kFovY = 30;  // degrees

// The axis that points up most.
glm::dvec3 axisOf(const glm::dvec3& up) {
    glm::length_t axis = 0;
    for (const glm::length_t other : {1, 2})
        if (std::abs(up[other]) > std::abs(up[axis])) axis = other;
    glm::dvec3 unit(0);
    unit[axis] = up[axis] < 0 ? -1 : 1;
    return unit;
}

void addBox(const LatticeEye& from, const LatticeBox& box, std::uint32_t color, std::vector<Line>& lines) {
    const glm::dvec3 low = from.to(box.min), high = from.to(box.max);
    const auto corner = [&](unsigned i) {
        return glm::dvec3(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    };
    for (unsigned i = 0; i < 8; ++i)
        for (const unsigned along : {1u, 2u, 4u})
            if (!(i & along)) lines.push_back({corner(i), corner(i | along), color});
}

// Its edges, as long as `depth` along the view.
void addFrustum(const TileView& view, const LatticeEye& from, double depth, std::vector<Line>& lines) {
    const glm::dvec3 eye =
        glm::dvec3(view.eye.cell) - glm::dvec3(from.cell) + view.eye.fraction - from.fraction;
    const auto corner = [&](unsigned i) {
        const double x = view.tile.x + (i == 1 || i == 2 ? view.tile.width : 0);
        const double y = view.tile.y + (i >= 2 ? view.tile.height : 0);
        return eye + depth * (view.projection.toDirection * glm::dvec3(x, y, 1));
    };
    for (unsigned i = 0; i < 4; ++i) {
        lines.push_back({eye, corner(i), kFrustum, 0.8f});
        lines.push_back({corner(i), corner((i + 1) % 4), kFrustum, 0.8f});
    }
}

}  // namespace

void BirdsEye::draw(const TileView& view, const glm::dvec3& up,
                    const std::vector<PageDrawing::Drawn>& drawn) {
    const TileView from = above(view, up);
    std::vector<VisibleRanges> ranges;
    for (const PageDrawing::Drawn& d : drawn) ranges.push_back({d.page, d.range, 1});
    ranges = joined(std::move(ranges));
    scene_.visibility.sortFrontToBack(ranges, from.eye);

    std::vector<Line> lines = boxes(view, from.eye, drawn);
    const LatticeBox model = Hierarchy::box(scene_.dataset.hierarchy.nodes[0]);
    addBox(from.eye, model, kModel, lines);
    addFrustum(view, from.eye, 0.3 * glm::distance(from.eye.to(model.min), from.eye.to(model.max)), lines);

    scene_.renderer->beginFrame(from, pixels_);
    protocol::TileStats notOfTheFrame;
    for (const Block& block : blocksOf(from.tile)) {
        const BlockView part(from, block);
        scene_.cache->beginFrame(pagesOf(ranges));
        scene_.renderer->beginBlock(block);
        scene_.pages->drawAll(part, ranges, notOfTheFrame);
        scene_.renderer->finish();
        scene_.renderer->drawLines(lines);
        scene_.cache->release();
    }
}

// The whole model, and the eye where it is not too far from it, on the whole tile.
TileView BirdsEye::above(const TileView& view, const glm::dvec3& up) const {
    const LatticeBox model = Hierarchy::box(scene_.dataset.hierarchy.nodes[0]);
    glm::dvec3 low = view.eye.to(model.min), high = view.eye.to(model.max);  // from the tile's eye
    const double size = glm::distance(low, high);
    if (glm::length(low + high) / 2 < 1.5 * size) low = glm::min(low, 0.0), high = glm::max(high, 0.0);

    const glm::dvec3 upward = axisOf(up), side(upward.y, upward.z, upward.x),
                     ahead(upward.z, upward.x, upward.y);
    const glm::dvec3 direction = glm::normalize(0.45 * side - 0.75 * ahead + 1.1 * upward);
    const double aspect = static_cast<double>(view.tile.width) / view.tile.height;
    const double distance = 0.5 * std::max(1.0, glm::distance(low, high)) /
                            std::sin(glm::radians(kFovY / 2)) / std::min(1.0, aspect);
    const glm::dvec3 away = (low + high) / 2.0 + distance * direction;

    Wall wall;
    wall.width = view.tile.width;
    wall.height = view.tile.height;
    Camera camera;
    camera.eye = direction;
    camera.target = glm::dvec3(0);
    camera.up = upward;
    TileView from = view;
    from.projection = projectScreen(wall.screens(kFovY)[0], camera);
    glm::dmat3 toTile(1), fromTile(1);  // the tile's place on its screen
    toTile[2] = glm::dvec3(view.tile.x, view.tile.y, 1);
    fromTile[2] = glm::dvec3(-view.tile.x, -view.tile.y, 1);
    from.projection.toPixels = toTile * from.projection.toPixels;
    from.projection.toDirection = from.projection.toDirection * fromTile;
    from.eye = LatticeEye::at(glm::dvec3(view.eye.cell) + away, 0);
    return from;
}

std::vector<Line> BirdsEye::boxes(const TileView& view, const LatticeEye& from,
                                  const std::vector<PageDrawing::Drawn>& drawn) const {
    std::map<std::uint32_t, bool> read;  // by page that was drawn
    for (const PageDrawing::Drawn& d : drawn) read[d.page] |= d.fetched;
    const Frustum frustum = frustumOf(view.projection, view.tile, 1, view.near);
    std::vector<Line> leftOut, lines;
    for (const std::uint32_t page : pagesOf(scene_.visibility.visible(scene_.cut, frustum, view.eye))) {
        const auto found = read.find(page);
        if (found == read.end())
            addBox(from, scene_.visibility.pageBox(page), kLeftOut, leftOut);
        else
            addBox(from, scene_.visibility.pageBox(page), found->second ? kRead : kDrawn, lines);
    }
    leftOut.insert(leftOut.end(), lines.begin(), lines.end());  // what is drawn comes over what is not
    return leftOut;
}

}  // namespace iwalk
