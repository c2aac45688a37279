#include <gtest/gtest.h>

#include "common/canvas.hpp"
#include "common/dataset/hierarchy.hpp"
#include "preprocess/picture/octree_picture.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/soup.hpp"

namespace iwalk {
namespace {

constexpr Color kBlack(0), kRed(1, 0, 0), kGreen(0, 1, 0), kBlue(0, 0, 1);

int countOf(const ColorImage& image, const Color& color) {
    int count = 0;
    for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
        const Color pixel = Color(image.pixels[i], image.pixels[i + 1], image.pixels[i + 2]) / 255.0f;
        count += pixel == color ? 1 : 0;
    }
    return count;
}

TEST(CanvasTest, TrianglesCoverPixelsByDepth) {
    Canvas canvas(20, 20, kBlack);
    canvas.triangle({glm::dvec3(0, 0, 5), glm::dvec3(10, 0, 5), glm::dvec3(0, 10, 5)}, kRed);
    EXPECT_NEAR(countOf(canvas.image(), kRed), 50, 5);
    canvas.triangle({glm::dvec3(0, 0, 6), glm::dvec3(0, 40, 6), glm::dvec3(40, 0, 6)}, kGreen);
    EXPECT_NEAR(countOf(canvas.image(), kRed), 50, 5);
    EXPECT_EQ(countOf(canvas.image(), kBlack), 0);
    canvas.triangle({glm::dvec3(3.1, 3.1, 1), glm::dvec3(3.2, 3.1, 1), glm::dvec3(3.1, 3.2, 1)}, kBlue);
    EXPECT_EQ(countOf(canvas.image(), kBlue), 1);
    // Out of the picture, far out, and without area.
    canvas.triangle({glm::dvec3(-9, -9, 1), glm::dvec3(-5, -9, 1), glm::dvec3(-9, -5, 1)}, kBlue);
    canvas.triangle({glm::dvec3(1e300, 0, 1), glm::dvec3(1e300, 1, 1), glm::dvec3(1e300, 0, 1)}, kBlue);
    EXPECT_EQ(countOf(canvas.image(), kBlue), 1);
}

TEST(CanvasTest, SurfacesHideLines) {
    Canvas canvas(20, 20, kBlack);
    canvas.triangle({glm::dvec3(0, 0, 5), glm::dvec3(0, 20, 5), glm::dvec3(20, 0, 5)}, kRed);
    const int before = countOf(canvas.image(), kRed);
    canvas.line({0, 2, 8}, {20, 2, 8}, kBlue, 1);
    EXPECT_EQ(countOf(canvas.image(), kRed), before);
    canvas.line({0, 4, 5.5}, {20, 4, 5.5}, kBlue, 1);
    EXPECT_LT(countOf(canvas.image(), kRed), before);
    canvas.text(2, 8, 1, "1", kGreen);
    EXPECT_EQ(countOf(canvas.image(), kGreen), 10);
}

TEST(OctreePictureTest, ShowsModelAndCells) {
    const TempDirectory directory;
    ASSERT_TRUE(buildFrom(makeSoup(20'000, 0.01, 0.1, 1), directory.path("d"), {.leafTriangles = 500}).ok());
    const auto picture = drawOctree(directory.path("d"), 320, 240);
    ASSERT_TRUE(picture.ok()) << picture.error().message;
    EXPECT_NE(picture->level, kFullLevel);  // coarse enough for so few pixels
    EXPECT_GT(picture->deepest, picture->shallowest);
    EXPECT_EQ(picture->image.width, 320);
    int grey = 0, colored = 0;
    for (std::size_t i = 0; i < picture->image.pixels.size(); i += 3) {
        const std::uint8_t* p = picture->image.pixels.data() + i;
        grey += p[0] == p[1] && p[1] == p[2] ? 1 : 0;
        colored += std::abs(p[0] - p[2]) > 60 ? 1 : 0;
    }
    EXPECT_GT(grey, 1500);
    EXPECT_GT(colored, 1000);
    EXPECT_FALSE(drawOctree(directory.path("nowhere"), 320, 240).ok());
}

}  // namespace
}  // namespace iwalk
