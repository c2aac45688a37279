#include "preprocess/import/read_ahead.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace iwalk {
namespace {

using namespace std::chrono_literals;

struct Number {
    int read = 0, parsed = 0;
};

class ReadAheadTest : public testing::TestWithParam<std::size_t> {
  protected:
    // Runs `work()` among four threads.
    template <class Work>
    static void withThreads(Work work) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 4);
        tbb::task_arena arena(4);
        arena.execute(work);
    }
};

// Later blocks are parsed faster than earlier ones, and all come in order.
TEST_P(ReadAheadTest, inOrder) {
    withThreads([] {
        int filled = 0;
        const auto fill = [&](Number& block) -> Result<bool> {
            block.read = filled++;
            return filled <= 200;
        };
        const auto parse = [](Number& block) {
            if (block.read % 5 == 0) std::this_thread::sleep_for(2ms);
            block.parsed = 3 * block.read;
        };
        ReadAhead<Number> reading(GetParam(), fill, parse);
        for (int i = 0; i < 200; ++i) {
            const auto block = reading.next();
            ASSERT_TRUE(block.ok() && *block);
            ASSERT_EQ((*block)->read, i);
            ASSERT_EQ((*block)->parsed, 3 * i);
            ASSERT_LE(filled, i + static_cast<int>(GetParam()));
        }
        EXPECT_EQ(*reading.next(), nullptr);
        EXPECT_EQ(*reading.next(), nullptr);
    });
}

TEST_P(ReadAheadTest, anErrorComesAfterWhatWasBeforeIt) {
    withThreads([] {
        int filled = 0;
        const auto fill = [&](Number& block) -> Result<bool> {
            block.read = filled++;
            return filled <= 10 ? Result<bool>(true) : fail("torn");
        };
        ReadAhead<Number> reading(GetParam(), fill, [](Number& block) { block.parsed = block.read; });
        for (int i = 0; i < 10; ++i) ASSERT_EQ((*reading.next())->parsed, i);
        const auto end = reading.next();
        ASSERT_FALSE(end.ok());
        EXPECT_EQ(end.error().message, "torn");
    });
}

// Whoever ends the reading waits for the blocks that are being parsed, and nobody begins with others.
TEST_P(ReadAheadTest, endsEarly) {
    for (int round = 0; round < 50; ++round) {
        std::atomic<int> parsing = 0;
        withThreads([&] {
            ReadAhead<Number> reading(
                GetParam(), [](Number&) { return Result<bool>(true); },
                [&](Number&) {
                    ++parsing;
                    std::this_thread::sleep_for(100us);
                    --parsing;
                });
            for (int i = 0; i < round % 4; ++i) ASSERT_TRUE(reading.next().ok());
        });
        EXPECT_EQ(parsing, 0);
    }
}

INSTANTIATE_TEST_SUITE_P(Blocks, ReadAheadTest, testing::Values(1, 2, 8));

}  // namespace
}  // namespace iwalk
