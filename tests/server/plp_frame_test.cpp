// Drawing under a budget: what it may cost, and what is right in any case.

#include "tests/server/render_fixture.hpp"
#include "tests/server/wall_renders.hpp"

namespace iwalk::tools {
namespace {

class PlpFrameTest : public RenderTest {
  protected:
    static Settings settings(Mode mode, std::uint64_t budget = 0) {
        Settings settings;
        settings.mode = mode;
        if (mode == Mode::plp) settings.plpBudget = budget;
        return settings;
    }
    // A wall and what it hides: 21 squares of 512 triangles.
    Dataset squares() {
        Triangles triangles;
        for (int i = 0; i < 21; ++i) {
            const Triangles square = wallAt(0.7 * i, 2, 16);
            triangles.insert(triangles.end(), square.begin(), square.end());
        }
        return build(triangles);
    }
    const Camera ahead_{{-4, 0.1, 0.2}, {0, 0.1, 0.2}, {0, 0, 1}, 60};
};

TEST_F(PlpFrameTest, WhatTheFirstStepsHideCostsNothing) {
    const Dataset dataset = squares();
    for (const int width : {320, 1400}) {  // one block of the screen, and two
        const Wall wall = wallOf(width, 240, 1, 1);
        WallServers all(dataset, wall, settings(Mode::frustum)),
            some(dataset, wall, settings(Mode::plp, 4000));
        const Comparison comparison = compare(all.draw(ahead_), some.draw(ahead_), std::nullopt);
        EXPECT_EQ(comparison.different, 0u) << width;
        EXPECT_EQ(all.stats().triangles, 21u * 512) << width;
        EXPECT_LE(some.stats().triangles, 2000u) << width;  // what two steps of four may spend
        EXPECT_GT(some.stats().hiddenRanges, 0u) << width;
    }
}

TEST_F(PlpFrameTest, TheBudgetIsKept) {
    const Dataset dataset = squares();
    const Wall wall = wallOf(320, 240, 1, 1);
    const Camera aside{{-4, 9, 0.2}, {5, 0.1, 0.2}, {0, 0, 1}, 60};  // all squares show
    for (const std::uint64_t budget : {600u, 3000u, 9000u}) {
        WallServers some(dataset, wall, settings(Mode::plp, budget));
        some.drawOnly(aside);
        EXPECT_LE(some.stats().triangles, budget);
        EXPECT_GT(some.stats().triangles, budget / 2);
    }
}

TEST_F(PlpFrameTest, EnoughBudgetDrawsAllAndDoesNotLook) {
    const Dataset dataset = squares();
    const Wall wall = wallOf(1400, 240, 1, 1);
    WallServers all(dataset, wall, settings(Mode::frustum)), some(dataset, wall, settings(Mode::plp, 20000));
    EXPECT_EQ(compare(all.draw(ahead_), some.draw(ahead_), std::nullopt).different, 0u);
    EXPECT_EQ(some.stats().pyramidMs, 0);
    EXPECT_EQ(some.stats().hiddenRanges, 0u);
}

TEST_F(PlpFrameTest, TheNumberOfThreadsMakesNoDifference) {
    const Dataset dataset = squares();
    const Wall wall = wallOf(1400, 240, 1, 1);
    const Camera aside{{-4, 9, 0.2}, {5, 0.1, 0.2}, {0, 0, 1}, 60};
    for (const Mode mode : {Mode::plp, Mode::cplp}) {
        WallServers one(dataset, wall, settings(mode, 3000), 0),
            three(dataset, wall, settings(mode, 3000), 0, 0, 3);
        for (const Camera& camera : {aside, ahead_, aside}) {
            const Comparison comparison = compare(one.draw(camera), three.draw(camera), std::nullopt);
            EXPECT_EQ(comparison.different, 0u);
            EXPECT_EQ(one.stats().triangles, three.stats().triangles);
            EXPECT_EQ(one.stats().hiddenRanges, three.stats().hiddenRanges);
        }
    }
}

TEST_F(PlpFrameTest, ThePictureDependsOnTheViewAlone) {
    const Dataset dataset = squares();
    const Wall wall = wallOf(1400, 240, 1, 1);
    const Camera aside{{-4, 9, 0.2}, {5, 0.1, 0.2}, {0, 0, 1}, 60};
    WallServers fresh(dataset, wall, settings(Mode::plp, 3000)),
        other(dataset, wall, settings(Mode::plp, 3000));
    other.drawOnly(ahead_);
    other.drawOnly(aside);
    EXPECT_EQ(compare(fresh.draw(aside), other.draw(aside), std::nullopt).different, 0u);
    EXPECT_GT(fresh.stats().triangles, 1000u);
}

}  // namespace
}  // namespace iwalk::tools
