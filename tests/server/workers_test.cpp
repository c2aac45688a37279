#include "server/visibility/workers.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "server/visibility/order.hpp"

namespace iwalk {
namespace {

TEST(WorkersTest, EachPieceIsDoneOnceBeforeRunReturns) {
    for (const unsigned threads : {1u, 2u, 4u}) {
        Workers workers(threads);
        for (std::size_t pieces = 0; pieces < 200; ++pieces) {
            std::vector<int> done(pieces);  // no piece may be on two threads
            workers.run(pieces, [&](std::size_t i) { ++done[i]; });
            EXPECT_EQ(done, std::vector<int>(pieces, 1));
        }
    }
}

TEST(WorkersTest, AllThreadsWork) {
    Workers workers(3);
    std::atomic<int> here = 0;
    workers.run(3, [&](std::size_t) {  // each piece waits for the others
        ++here;
        while (here < 3) std::this_thread::yield();
    });
    EXPECT_EQ(here, 3);
}

TEST(WorkersTest, PartsCoverEverything) {
    Workers workers(2);
    for (const std::size_t count : {0u, 1u, 9u, 10u, 11u, 100u}) {
        std::vector<int> done(count);
        workers.runParts(count, 10, [&](std::size_t first, std::size_t end) {
            EXPECT_LE(end - first, 10u);
            for (std::size_t i = first; i < end; ++i) ++done[i];
        });
        EXPECT_EQ(done, std::vector<int>(count, 1));
    }
}

TEST(OrderTest, EqualKeysStayAsTheyCome) {
    const std::vector<float> keys{3, 1e-30f, 0, 1e30f, 3, 0};
    EXPECT_EQ(leastFirst(keys), (std::vector<std::uint32_t>{2, 5, 1, 0, 4, 3}));
    EXPECT_EQ(greatestFirst(keys), (std::vector<std::uint32_t>{3, 0, 4, 1, 2, 5}));
    EXPECT_TRUE(leastFirst({}).empty());
}

}  // namespace
}  // namespace iwalk
