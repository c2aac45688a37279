#include "tests/tools/triangle_set.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/tools/scenes.hpp"

namespace iwalk::tools {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;

const Triangle kTriangle{glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)};

Triangle turned(const Triangle& t) {
    return {t[1], t[2], t[0]};
}

TEST(TriangleSet, AnyOrderIsTheSameSet) {
    Triangles model = sphere(2, 4);
    TriangleSet set(model, 0);
    std::shuffle(model.begin(), model.end(), std::mt19937(1));
    for (const Triangle& t : model) ASSERT_THAT(set.take(turned(t)), Optional(0.0));
    EXPECT_THAT(set.left(), IsEmpty());
    EXPECT_EQ(set.take(model[0]), std::nullopt);
}

TEST(TriangleSet, TellsTheOtherSideFromTheOne) {
    TriangleSet set({kTriangle}, 0.1);
    EXPECT_EQ(set.take({kTriangle[0], kTriangle[2], kTriangle[1]}), std::nullopt);
    EXPECT_THAT(set.left(), ElementsAre(kTriangle));
}

TEST(TriangleSet, CountsWhatIsThereTwice) {
    TriangleSet set({kTriangle, kTriangle}, 0);
    EXPECT_THAT(set.take(kTriangle), Optional(0.0));
    EXPECT_THAT(set.left(), ElementsAre(kTriangle));
    EXPECT_THAT(set.take(kTriangle), Optional(0.0));
    EXPECT_EQ(set.take(kTriangle), std::nullopt);
}

// Wherever the cells of the set have their borders.
TEST(TriangleSet, FindsWhatLiesWithinTheDistanceAndNoFarther) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> anywhere(-100, 100), near(-0.25, 0.25);
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 place(anywhere(random), anywhere(random), anywhere(random));
        const Triangle there = moved({kTriangle}, place)[0];
        Triangle close = there, far = there;
        for (glm::dvec3& corner : close) corner += glm::dvec3(near(random), near(random), near(random));
        far[1][static_cast<std::size_t>(i) % 3] += i % 2 ? 0.2501 : -0.2501;
        TriangleSet set({there}, 0.25);
        ASSERT_EQ(set.take(far), std::nullopt);
        ASSERT_THAT(set.take(close), Optional(testing::Le(0.25)));
    }
}

TEST(TriangleSet, TakesTheClosest) {
    const Triangle at1 = moved({kTriangle}, {0.125, 0, 0})[0], at2 = moved({kTriangle}, {0, 0.0625, 0})[0];
    TriangleSet set({at1, at2}, 0.5);
    EXPECT_THAT(set.take(kTriangle), Optional(0.0625));
    EXPECT_THAT(set.left(), ElementsAre(at1));
}

}  // namespace
}  // namespace iwalk::tools
