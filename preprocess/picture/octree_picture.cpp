#include "preprocess/picture/octree_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "common/canvas.hpp"
#include "common/dataset/page.hpp"
#include "common/dataset/page_files.hpp"
#include "common/font.hpp"

namespace iwalk {
namespace {

constexpr Color kBackground(0.125f, 0.141f, 0.165f), kGrey(0.8f), kWhite(1.0f);
constexpr double kMargin = 0.04;  // of the picture

// A parallel projection that shows a set of lattice boxes, z being up.
class View {
  public:
    View(const LatticePoint& center, const std::vector<LatticeBox>& boxes, int width, int height)
        : center_(center) {
        Box<double> shown;
        for (const LatticeBox& box : boxes) {
            for (unsigned corner = 0; corner < 8; ++corner) shown.add(turned(cornerOf(box, corner)));
        }
        const glm::dvec3 size = shown.max - shown.min;
        scale_ = (1 - 2 * kMargin) * std::min(width / std::max(size.x, 1.0), height / std::max(size.y, 1.0));
        depth_ = size.z;
        shift_ = glm::dvec3(width, height, 0) / 2.0 - scale_ * (shown.min + shown.max) / 2.0;
        shift_.z = 0;
    }

    static LatticePoint cornerOf(const LatticeBox& box, unsigned corner) {
        return LatticePoint(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                            corner & 4 ? box.max.z : box.min.z);
    }
    // px, and the distance in px.
    glm::dvec3 at(const LatticePoint& p) const { return scale_ * turned(p) + shift_; }
    double stepsPerPixel() const { return 1 / scale_; }
    double depthPx() const { return depth_ * scale_; }

    // How much of a face with this normal turns to the viewer, [0, 1].
    static double facing(const glm::dvec3& normal) {
        const double length = glm::length(normal);
        return length > 0 ? std::abs(glm::dot(normal, forward())) / length : 1;
    }

  private:
    static glm::dvec3 forward() { return glm::normalize(glm::dvec3(-0.6, 1, -0.7)); }

    glm::dvec3 turned(const LatticePoint& p) const {
        const glm::dvec3 v(p - center_);
        const glm::dvec3 right = glm::normalize(glm::cross(forward(), glm::dvec3(0, 0, 1)));
        return glm::dvec3(glm::dot(right, v), -glm::dot(glm::cross(right, forward()), v),
                          glm::dot(forward(), v));
    }

    LatticePoint center_;
    double scale_ = 1, depth_ = 1;
    glm::dvec3 shift_{0};
};

std::vector<LatticeBox> boxesOfLeaves(const Hierarchy& hierarchy) {
    const std::vector<LatticePoint> cells = cellsOfNodes(hierarchy);
    std::vector<LatticeBox> boxes;
    for (std::size_t n = 0; n < cells.size(); ++n) {
        if (!Hierarchy::isLeaf(hierarchy.nodes[n])) continue;
        const std::int64_t edge = std::int64_t{1} << (hierarchy.rootCellLog2 - hierarchy.nodes[n].depth);
        boxes.push_back({cells[n], cells[n] + LatticePoint(edge)});
    }
    return boxes;
}

// The triangles of a decoded page's ranges [first, first + count).
class PageDrawer {
  public:
    PageDrawer(const View& view, Canvas& canvas) : view_(view), canvas_(canvas) {}

    Result<void> read(const PageFiles& files, const PageRecord& record) {
        bytes_.resize(record.bytes);
        RETURN_IF_ERROR(files[record.file]->readAt(record.offset, bytes_));
        decoded_.resize(pageLayout(record).bytes);
        ASSIGN_OR_RETURN(table_, decodePage(bytes_, record, decoded_));
        return {};
    }

    void draw(const PageRecord& record, std::uint32_t first, std::uint32_t count) const {
        const Range &begin = table_.ranges[first], &last = table_.ranges[first + count - 1];
        const PageLayout layout = pageLayout(record);
        for (std::uint32_t i = begin.firstIndex; i < last.firstIndex + last.indexCount; i += 3) {
            std::array<std::uint16_t, 3> indices{};
            std::memcpy(indices.data(), decoded_.data() + layout.indices + 2 * i, sizeof(indices));
            std::array<glm::dvec3, 3> exact, shown;
            Color color(0);
            for (std::size_t c = 0; c < 3; ++c) {
                const glm::u32vec3 offset = pageOffset(decoded_, record, indices[c]);
                exact[c] = glm::dvec3(offset);
                shown[c] = view_.at(table_.origin + LatticePoint(offset));
                color += colorOf(record, layout, indices[c]) / 3.0f;
            }
            const double facing = View::facing(glm::cross(exact[1] - exact[0], exact[2] - exact[0]));
            canvas_.triangle(shown, color * static_cast<float>(0.25 + 0.75 * facing));
        }
    }

  private:
    Color colorOf(const PageRecord& record, const PageLayout& layout, std::uint32_t vertex) const {
        if ((record.flags & kPageColors) == 0) return kGrey;
        std::array<std::uint8_t, 4> rgba{};
        std::memcpy(rgba.data(), decoded_.data() + layout.colors + 4 * vertex, 4);
        return Color(rgba[0], rgba[1], rgba[2]) / 255.0f;
    }

    const View& view_;
    Canvas& canvas_;
    std::vector<std::byte> bytes_, decoded_;
    PageTable table_;
};

// The coarsest level whose error is hardly seen.
unsigned levelFor(const Hierarchy& hierarchy, const Manifest& manifest, const View& view) {
    for (unsigned level = 0; level < manifest.levels.size(); ++level) {
        if (levelErrorSteps(hierarchy.rootCellLog2, level) <= view.stepsPerPixel() / 2) return level;
    }
    return kFullLevel;
}

Result<void> drawModel(const Hierarchy& hierarchy, const PageFiles& files, unsigned level, const View& view,
                       Canvas& canvas) {
    PageDrawer drawer(view, canvas);
    std::uint32_t loaded = 0xffffffff;
    for (const NodeRecord& node : hierarchy.nodes) {
        const LevelRecord* entry = hierarchy.drawnAt(node, level);
        if (entry == nullptr) continue;
        for (std::uint32_t p = entry->firstPage; p < entry->firstPage + entry->pageCount; ++p) {
            const PageRecord& record = hierarchy.pages[p];
            if (p != loaded) RETURN_IF_ERROR(drawer.read(files, record));
            loaded = p;
            const bool shared = entry->pageCount == 1;
            drawer.draw(record, shared ? entry->firstRange : 0u,
                        shared ? entry->rangeCount : record.rangeCount);
        }
    }
    return {};
}

// From blue over green to red for t from 0 to 1.
Color rainbow(double t) {
    const auto bump = [t](double middle) {
        return static_cast<float>(std::clamp(1.5 - 4 * std::abs(t - middle), 0.0, 1.0));
    };
    return Color(bump(0.875), bump(0.5), bump(0.125)) * 0.85f + 0.15f;
}

Color depthColor(const OctreePicture& picture, unsigned depth) {
    const double span = std::max(1.0, static_cast<double>(picture.deepest - picture.shallowest));
    return rainbow((depth - picture.shallowest) / span);
}

void drawCell(const LatticeBox& cell, const Color& color, const View& view, Canvas& canvas) {
    for (unsigned corner = 0; corner < 8; ++corner) {
        for (const unsigned axis : {1u, 2u, 4u}) {
            if ((corner & axis) != 0) continue;
            canvas.line(view.at(View::cornerOf(cell, corner)), view.at(View::cornerOf(cell, corner | axis)),
                        color, view.depthPx() * 1e-3);
        }
    }
}

void drawLegend(const OctreePicture& picture, Canvas& canvas) {
    constexpr int kScale = 2, kRow = 24, kLeft = 20;
    int y = canvas.image().height - kRow * static_cast<int>(picture.deepest - picture.shallowest + 1);
    for (unsigned depth = picture.shallowest; depth <= picture.deepest; ++depth, y += kRow) {
        canvas.rectangle(kLeft, y, 2 * kRow, kLetterHeight * kScale, depthColor(picture, depth));
        canvas.text(kLeft + 2 * kRow + 8, y, kScale, std::to_string(depth), kWhite);
    }
}

}  // namespace

Result<OctreePicture> drawOctree(const std::string& dataset, int width, int height) {
    ASSIGN_OR_RETURN(const Manifest manifest, loadManifest(dataset));
    ASSIGN_OR_RETURN(const Hierarchy hierarchy, loadHierarchy(dataset, manifest));
    ASSIGN_OR_RETURN(const PageFiles files, openPageFiles(dataset, manifest));
    const std::vector<LatticeBox> cells = boxesOfLeaves(hierarchy);
    std::vector<unsigned> depths;
    for (const NodeRecord& node : hierarchy.nodes) {
        if (Hierarchy::isLeaf(node)) depths.push_back(node.depth);
    }
    OctreePicture picture;
    picture.shallowest = std::ranges::min(depths);
    picture.deepest = std::ranges::max(depths);

    const View view(hierarchy.rootCell, cells, width, height);
    Canvas canvas(width, height, kBackground);
    picture.level = levelFor(hierarchy, manifest, view);
    RETURN_IF_ERROR(drawModel(hierarchy, files, picture.level, view, canvas));
    for (std::size_t leaf = 0; leaf < cells.size(); ++leaf) {
        drawCell(cells[leaf], depthColor(picture, depths[leaf]), view, canvas);
    }
    drawLegend(picture, canvas);
    picture.image = canvas.image();
    return picture;
}

}  // namespace iwalk
