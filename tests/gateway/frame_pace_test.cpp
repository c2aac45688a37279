#include "server/gateway/frame_pace.hpp"

#include <gtest/gtest.h>

#include "server/gateway/requests.hpp"

namespace iwalk {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

FramePace::Time at(double ms) {
    return FramePace::Time(std::chrono::hours(5)) + microseconds(std::llround(ms * 1000));
}

double msOf(FramePace::Time time) {
    return std::chrono::duration<double, std::milli>(time - at(0)).count();
}

// A frame that begins at `ms`, for which something waited.
void frame(FramePace& pace, double ms) {
    ASSERT_TRUE(pace.begin(at(ms), [] { return std::optional<int>(1); }));
}

TEST(FramePace, WithoutALimitTheNextFrameBeginsAtOnce) {
    FramePace pace;
    frame(pace, 0);
    pace.frameOver(at(3), 0);
    EXPECT_EQ(msOf(pace.due()), 3);
    frame(pace, 3);
    pace.frameOver(at(300), 0);
    EXPECT_EQ(msOf(pace.due()), 300);
}

TEST(FramePace, FramesBeginAtMultiplesHoweverLateTheyAreSeen) {
    FramePace pace;
    frame(pace, 0);
    for (int i = 0; i < 100'000; ++i) {
        pace.frameOver(at(10 * i + 7), 100);
        ASSERT_EQ(msOf(pace.due()), 10 * i + 10);
        frame(pace, 10 * i + 10 + i % 5 * 0.5);  // sleeping takes longer than asked
    }
}

TEST(FramePace, AFrameThatTookTooLongSkipsToTheNextMultiple) {
    FramePace pace;
    frame(pace, 0);
    pace.frameOver(at(10.001), 100);
    EXPECT_EQ(msOf(pace.due()), 20);
    frame(pace, 20);
    pace.frameOver(at(50), 100);  // just in time
    EXPECT_EQ(msOf(pace.due()), 50);
    frame(pace, 50);
    pace.frameOver(at(87), 100);
    EXPECT_EQ(msOf(pace.due()), 90);
}

TEST(FramePace, AfterARestWhatComesBeginsAtOnce) {
    FramePace pace;
    frame(pace, 0);
    pace.frameOver(at(4), 100);
    EXPECT_FALSE(pace.begin(at(10), [] { return std::optional<int>(); }));
    frame(pace, 13);
    pace.frameOver(at(15), 100);
    EXPECT_EQ(msOf(pace.due()), 23);  // and never two within a period
}

TEST(FramePace, ALimitMayChangeWhileFramesAreDrawn) {
    FramePace pace;
    frame(pace, 0);
    pace.frameOver(at(4), 100);
    frame(pace, 10);
    pace.frameOver(at(14), 4);
    EXPECT_EQ(msOf(pace.due()), 260);
    frame(pace, 260);
    pace.frameOver(at(261), 0);
    EXPECT_EQ(msOf(pace.due()), 261);
}

// One camera each millisecond, 20 frames in a second: each frame has the camera of its own moment.
TEST(FramePace, TheCameraIsTheNewestWhenTheFrameBegins) {
    FramePace pace;
    Requests requests({10, 1000});
    const auto client = std::make_shared<Sender>(1);
    std::vector<std::uint64_t> drawn;
    for (int ms = 0; ms <= 200; ++ms) {
        requests.add(client, {static_cast<std::uint64_t>(ms) + 1, 0, {}});
        const auto taken = pace.begin(at(ms), [&] { return requests.take(); });
        if (!taken) continue;
        drawn.push_back(requests.origin(taken->request.sequence)->sequence - 1);
        pace.frameOver(at(ms + 30), 20);
    }
    EXPECT_EQ(drawn, (std::vector<std::uint64_t>{0, 50, 100, 150, 200}));
}

}  // namespace
}  // namespace iwalk
