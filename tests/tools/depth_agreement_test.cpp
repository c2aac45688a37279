#include "tests/tools/depth_agreement.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace iwalk::tools {
namespace {

TEST(DepthAgreement, CountsAndListsWhatDisagrees) {
    DepthImage picture(3, 2, 1);
    Image<double> reference(3, 2, 1);
    picture.pixels = {0, 10, 10.5f, 0, 4, 10};
    reference.pixels = {0, 10, 10, 5, 0, 9.5};
    const DepthAgreement exact = depthAgreement(picture, reference, 0.001);
    EXPECT_EQ(exact.pixels, 6u);
    EXPECT_EQ(exact.agreed, 2u);
    EXPECT_DOUBLE_EQ(exact.fraction(), 2.0 / 6);
    EXPECT_EQ(exact.missing, 1u);
    EXPECT_EQ(exact.extra, 1u);
    ASSERT_EQ(exact.worst.size(), 4u);
    EXPECT_TRUE(std::isinf(exact.worst[0].difference));
    EXPECT_TRUE(std::isinf(exact.worst[1].difference));
    EXPECT_NEAR(exact.worst[2].difference, 0.5 / 9.5, 1e-12);
    EXPECT_EQ(exact.worst[2].x, 2);
    EXPECT_EQ(exact.worst[2].y, 1);
    EXPECT_NEAR(exact.worst[3].difference, 0.05, 1e-12);

    EXPECT_EQ(depthAgreement(picture, reference, 0.051).agreed, 3u);
    const DepthAgreement two = depthAgreement(picture, reference, 0.001, 2);
    ASSERT_EQ(two.worst.size(), 2u);
    EXPECT_TRUE(std::isinf(two.worst[1].difference));
    EXPECT_TRUE(depthAgreement(picture, reference, 0.001, 0).worst.empty());
}

}  // namespace
}  // namespace iwalk::tools
