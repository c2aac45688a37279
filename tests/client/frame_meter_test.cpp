#include "client/fly/frame_meter.hpp"

#include <gtest/gtest.h>

namespace iwalk::client {
namespace {

FrameMeter::Time at(int ms) {
    return FrameMeter::Time(std::chrono::hours(1)) + std::chrono::milliseconds(ms);
}

protocol::FrameDone frame(std::uint64_t sequence, double timeMs) {
    return {sequence, 1, timeMs, {}};
}

TEST(FrameMeter, LatencyIsOfTheCameraThatWasDrawn) {
    FrameMeter meter;
    EXPECT_EQ(meter.latency().median, 0);
    meter.sent(1, at(0));
    meter.sent(2, at(10));  // overtaken
    meter.sent(3, at(20));
    meter.done(frame(1, 40), at(40));
    EXPECT_EQ(meter.latency().median, 40);
    EXPECT_EQ(meter.unanswered(), 2u);
    meter.done(frame(3, 40), at(80));
    EXPECT_EQ(meter.latency().median, 60);  // of 40 and 60
    EXPECT_EQ(meter.unanswered(), 0u);
}

TEST(FrameMeter, LatencyEndsAtTheSwap) {
    FrameMeter meter;
    protocol::FrameDone done = frame(1, 40);
    done.sinceSwapMs = 12;
    meter.sent(1, at(0));
    meter.done(done, at(40));
    EXPECT_EQ(meter.latency().median, 28);
}

TEST(FrameMeter, SpreadIsOfTheLastFrames) {
    FrameMeter meter;
    for (int i = 0; i < 500; ++i) {
        const auto sequence = static_cast<std::uint64_t>(i + 1);
        meter.sent(sequence, at(20 * i));
        meter.done(frame(sequence, i % 50 == 0 ? 30 : i), at(20 * i + (i % 50 == 1 ? 19 : 5)));
    }
    EXPECT_EQ(meter.interval().median, 398);  // of 300 to 499
    EXPECT_EQ(meter.interval().p99, 498);
    EXPECT_EQ(meter.latency().median, 5);
    EXPECT_EQ(meter.latency().p99, 19);
}

TEST(FrameMeter, RestsAreNoIntervals) {
    FrameMeter meter;
    for (int i = 0; i < 10; ++i) {
        meter.sent(static_cast<std::uint64_t>(i + 1), at(20 * i));
        meter.done(frame(static_cast<std::uint64_t>(i + 1), 20), at(20 * i + 15));
    }
    EXPECT_EQ(meter.interval().median, 20);
    for (int i = 0; i < 20; ++i) {
        meter.sent(static_cast<std::uint64_t>(i + 100), at(1000 * i + 1000));
        meter.done(frame(static_cast<std::uint64_t>(i + 100), 1000), at(1000 * i + 1015));
    }
    EXPECT_EQ(meter.interval().median, 20);
    EXPECT_EQ(meter.latency().median, 15);
}

TEST(FrameMeter, FramesPerSecondCountsOthersToo) {
    FrameMeter meter;
    for (int i = 1; i <= 50; ++i) meter.done(frame(0, 50), at(50 * i));
    EXPECT_EQ(meter.framesPerSecond(at(2510)), 20);
    EXPECT_EQ(meter.framesPerSecond(at(5000)), 0);
    EXPECT_EQ(meter.latency().median, 0);
}

TEST(FrameMeter, ANewConnectionAnswersNothingOfTheOld) {
    FrameMeter meter;
    meter.sent(1, at(0));
    meter.forget();
    meter.sent(2, at(100));
    meter.done(frame(2, 10), at(120));
    EXPECT_EQ(meter.latency().median, 20);
}

}  // namespace
}  // namespace iwalk::client
