// Work on all threads whose results are taken in order.
#include "preprocess/build/parallel.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <numeric>
#include <thread>
#include <vector>

namespace iwalk {
namespace {

constexpr std::size_t kFirst = 3, kEnd = 2000;

TEST(OrderedFor, FinishesEachAfterItsWorkAndInOrder) {
    for (const int threads : {1, 2, 4}) {
        const tbb::global_control most(tbb::global_control::max_allowed_parallelism,
                                       static_cast<std::size_t>(threads));
        tbb::task_arena arena(threads);
        std::vector<std::size_t> made(kEnd, 0), finished;
        const auto work = [&](std::size_t i) -> Result<void> {
            if (i % 97 == 0) std::this_thread::yield();  // others overtake it
            made[i] = i * i;
            return {};
        };
        const auto finish = [&](std::size_t i) -> Result<void> {
            EXPECT_EQ(made[i], i * i);
            finished.push_back(i);
            return {};
        };
        ASSERT_TRUE(orderedFor(arena, kFirst, kEnd, work, finish));
        std::vector<std::size_t> expected(kEnd - kFirst);
        std::iota(expected.begin(), expected.end(), kFirst);
        EXPECT_EQ(finished, expected) << threads << " threads";
    }
}

TEST(OrderedFor, StopsAtTheFirstErrorOfEither) {
    for (const bool inWork : {true, false}) {
        tbb::task_arena arena(2);
        std::size_t last = 0;
        const auto failsAt = [](bool here, std::size_t i) -> Result<void> {
            if (here && i == 100) return fail("at {}", i);
            return {};
        };
        const auto result = orderedFor(
            arena, 0, kEnd, [&](std::size_t i) { return failsAt(inWork, i); },
            [&](std::size_t i) {
                last = std::max(last, i);
                return failsAt(!inWork, i);
            });
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().message, "at 100");
        EXPECT_LE(last, 100u);  // nothing is finished behind it
    }
}

TEST(OrderedFor, NothingIsNothing) {
    tbb::task_arena arena(2);
    const auto never = [](std::size_t) -> Result<void> { return fail("called"); };
    EXPECT_TRUE(orderedFor(arena, 5, 5, never, never));
}

}  // namespace
}  // namespace iwalk
