#include "client/fly/recorder.hpp"

#include <gtest/gtest.h>

namespace iwalk::client {
namespace {

Camera at(double x) {
    return {{x, 0, 0}, {x, 1, 0}, {0, 0, 1}, 60};
}

TEST(Recorder, HasSoManyFramesASecond) {
    for (const double perSecond : {24.0, 60.0, 144.0}) {
        Recorder recorder;
        const int steps = static_cast<int>(10 * perSecond);
        for (int i = 0; i < steps; ++i) recorder.add(100 + i / perSecond, at(i));
        const double expected = 10 * std::min(Recorder::kFps, perSecond);
        EXPECT_NEAR(static_cast<double>(recorder.path().size()), expected, 2) << perSecond;
    }
}

TEST(Recorder, LeavesOutRests) {
    Recorder recorder;
    for (int i = 0; i < 60; ++i) recorder.add(i / 30.0, at(std::min(i, 9)));
    EXPECT_EQ(recorder.path().size(), 10u);
    // After a rest frames do not come all at once.
    for (int i = 0; i < 10; ++i) recorder.add(10 + i / 300.0, at(20 + i));
    EXPECT_LE(recorder.path().size(), 13u);
}

TEST(Replay, IsAsFastAsTheRecording) {
    std::vector<Camera> path;
    for (int i = 0; i < 30; ++i) path.push_back(at(i));
    EXPECT_EQ(replayed(path, 0)->eye.x, 0);
    EXPECT_EQ(replayed(path, 0.501)->eye.x, 15);
    EXPECT_EQ(replayed(path, 0.999)->eye.x, 29);
    EXPECT_EQ(replayed(path, 1.001), nullptr);
    EXPECT_EQ(replayed({}, 0), nullptr);
}

}  // namespace
}  // namespace iwalk::client
