#include "server/visibility/plp_spending.hpp"

#include <gtest/gtest.h>

#include <random>

namespace iwalk {
namespace {

using Numbers = std::vector<std::uint32_t>;

Numbers numbersOf(const std::vector<PlpSpending::Taken>& taken) {
    Numbers numbers;
    for (const PlpSpending::Taken& t : taken) numbers.push_back(t.number);
    return numbers;
}

std::size_t look(PlpSpending& spending, const DepthPyramid& drawn) {
    Workers workers(2);
    return spending.look(drawn, workers);
}

// 10 x 10 pixels at one depth.
DepthPyramid flat(float depth) {
    DepthPyramid pyramid;
    pyramid.build(10, 10, [&](int, int rows, float* to) { std::fill_n(to, 10 * rows, depth); });
    return pyramid;
}

TEST(PlpSpendingTest, WhatFitsIsTakenAtOnce) {
    PlpSpending spending({{7, 10, {0, 0, 1, 1, 0}}, {3, 20, {0, 0, 1, 1, 0}}}, 30);
    EXPECT_EQ(numbersOf(spending.step()), (Numbers{7, 3}));
    EXPECT_TRUE(spending.done());
    EXPECT_EQ(spending.left(), 0u);
}

TEST(PlpSpendingTest, NothingInViewAndNothingThatFits) {
    PlpSpending none({}, 30), large({{0, 31, {0, 0, 1, 1, 0}}}, 30);
    for (PlpSpending* spending : {&none, &large}) {
        EXPECT_TRUE(spending->step().empty());
        EXPECT_TRUE(spending->done());
        EXPECT_EQ(spending->left(), 30u);
    }
}

TEST(PlpSpendingTest, WhatIsHiddenIsLeftOut) {
    PlpSpending spending(
        {{0, 10, {0, 0, 5, 5, 0.9f}}, {1, 90, {0, 0, 5, 5, 0.4f}}, {2, 40, {0, 0, 5, 5, 0.6f}}}, 100);
    EXPECT_EQ(numbersOf(spending.step()), Numbers{0});
    EXPECT_FALSE(spending.done());
    EXPECT_EQ(look(spending, flat(0.5f)), 1u);
    EXPECT_TRUE(spending.step().empty());  // 40 are too many for this step
    EXPECT_EQ(numbersOf(spending.step()), Numbers{2});
    EXPECT_TRUE(spending.done());
    EXPECT_EQ(spending.left(), 50u);
}

TEST(PlpSpendingTest, ALookOrdersByOpenPixelsPerTriangle) {
    std::vector<PlpSpending::Range> ranges{{0, 15, {0, 0, 1, 1, 1}}};
    ranges.push_back({1, 10, {0, 0, 2, 2, 0.6f}});    // 4 pixels
    ranges.push_back({2, 10, {0, 0, 10, 10, 0.6f}});  // 100
    ranges.push_back({3, 5, {0, 0, 10, 9, 0.6f}});    // 90, for half of the triangles
    ranges.push_back({4, 0, {0, 0, 1, 1, 0.6f}});     // paid for
    ranges.push_back({5, 90, {0, 0, 10, 10, 0.6f}});
    PlpSpending spending(ranges, 100);
    EXPECT_EQ(numbersOf(spending.step()), (Numbers{0, 4}));
    EXPECT_EQ(look(spending, flat(0.5f)), 0u);
    EXPECT_EQ(numbersOf(spending.step()), (Numbers{3, 2, 1}));
}

TEST(PlpSpendingTest, TheBudgetIsKeptWhateverLooksSay) {
    std::mt19937 random(5);
    for (int run = 0; run < 200; ++run) {
        const std::uint64_t budget = random() % 5000;
        std::vector<PlpSpending::Range> ranges;
        std::vector<bool> taken(60);
        for (std::uint32_t i = 0; i < 60; ++i)
            ranges.push_back({i,
                              static_cast<std::uint32_t>(random() % 512),
                              {0, 0, 1 + static_cast<int>(random() % 10), 5, float(random() % 8) / 8}});
        PlpSpending spending(ranges, budget);
        std::uint64_t spent = 0;
        for (int steps = 0; !spending.done() || steps == 0; ++steps) {
            ASSERT_LT(steps, 4);
            for (const PlpSpending::Taken& t : spending.step()) {
                EXPECT_FALSE(taken[t.number]);
                taken[t.number] = true;
                spent += ranges[t.number].triangles;
                EXPECT_GE(t.spent, 0);
                EXPECT_LT(t.spent, 1);
            }
            if (!spending.done()) look(spending, flat(float(random() % 8) / 8));
        }
        EXPECT_LE(spent, budget);
        EXPECT_EQ(spending.left(), budget - spent);
    }
}

}  // namespace
}  // namespace iwalk
