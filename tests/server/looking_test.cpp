#include "server/visibility/looking.hpp"

#include <gtest/gtest.h>

namespace iwalk {
namespace {

TEST(LookingTest, FewTrianglesAreNeverLookedAt) {
    Looking looking;
    for (int i = 0; i < 50; ++i) EXPECT_FALSE(looking.pays(99, 100));
}

TEST(LookingTest, GoesOnWhileMuchIsHidden) {
    Looking looking;
    for (int i = 0; i < 50; ++i) {
        EXPECT_TRUE(looking.pays(1000, 100));
        looking.looked(150, 1000, 100);
    }
    EXPECT_TRUE(looking.pays(700, 100));  // 105 of them
}

TEST(LookingTest, TriesAgainLessAndLessOftenWhereLittleIsHidden) {
    Looking looking;
    int looks = 0;
    for (int i = 0; i < 1700; ++i) {
        if (!looking.pays(1000, 100)) continue;
        ++looks;
        looking.looked(50, 1000, 100);
    }
    EXPECT_GE(looks, 100);
    EXPECT_LE(looks, 105);
}

// One bad frame, as when the eye passes a wall: the next but one is looked at.
TEST(LookingTest, OneFrameDoesNotDecideForLong) {
    Looking looking;
    looking.looked(800, 1000, 100);
    looking.looked(0, 1000, 100);
    int without = 0;
    while (!looking.pays(1000, 100)) ++without;
    EXPECT_LE(without, 2);
}

TEST(LookingTest, AnotherViewIsLookedAtAtOnce) {
    Looking looking;
    for (int i = 0; i < 9; ++i) looking.looked(0, 1000, 100);
    EXPECT_FALSE(looking.pays(1400, 100));
    EXPECT_TRUE(looking.pays(1600, 100));
    EXPECT_TRUE(looking.pays(600, 100));
}

}  // namespace
}  // namespace iwalk
