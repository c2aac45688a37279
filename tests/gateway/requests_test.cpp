#include "server/gateway/requests.hpp"

#include <gtest/gtest.h>

namespace iwalk {
namespace {

using protocol::CameraRequest;

SenderPtr sender(std::uint64_t id) {
    return std::make_shared<Sender>(id);
}

CameraRequest request(std::uint64_t sequence, std::uint8_t flags) {
    return {sequence, flags, {}};
}

// The sender's own number of what is taken next; 0 for nothing.
std::uint64_t takeNext(Requests& requests) {
    const auto taken = requests.take();
    return taken ? requests.origin(taken->request.sequence)->sequence : 0;
}

TEST(Requests, LockstepFirstThenTheNewestOnce) {
    Requests requests({10, 1000});
    const SenderPtr a = sender(1);
    requests.add(a, request(1, 0));
    requests.add(a, request(2, protocol::kLockstep));
    requests.add(a, request(3, protocol::kLockstep));
    requests.add(a, request(4, 0));
    EXPECT_EQ(takeNext(requests), 2u);
    EXPECT_EQ(takeNext(requests), 3u);
    EXPECT_EQ(takeNext(requests), 4u);
    EXPECT_EQ(takeNext(requests), 0u);
}

TEST(Requests, SaysWhenFullAndWhenThereIsRoom) {
    Requests requests({2, 1000});
    const SenderPtr a = sender(1);
    EXPECT_TRUE(requests.add(a, request(1, protocol::kLockstep)));
    EXPECT_FALSE(requests.add(a, request(2, protocol::kLockstep)));
    EXPECT_TRUE(requests.take()->madeRoom);
    EXPECT_FALSE(requests.take()->madeRoom);
}

TEST(Requests, NumbersAreItsOwn) {
    Requests requests({10, 1000});
    const SenderPtr a = sender(1), b = sender(2);
    requests.add(a, request(7, protocol::kLockstep));
    requests.add(b, request(7, protocol::kLockstep));
    const auto first = requests.take(), second = requests.take();
    EXPECT_NE(first->request.sequence, second->request.sequence);
    EXPECT_EQ(requests.origin(first->request.sequence)->sender, a);
    EXPECT_EQ(requests.origin(second->request.sequence)->sender, b);
    EXPECT_FALSE(requests.origin(0).has_value());
    EXPECT_FALSE(requests.origin(99).has_value());
}

TEST(Requests, DropForgetsOneSender) {
    Requests requests({10, 1000});
    const SenderPtr a = sender(1), b = sender(2);
    requests.add(a, request(1, protocol::kLockstep));
    requests.add(b, request(2, protocol::kLockstep));
    requests.add(a, request(3, 0));
    requests.drop(*a);
    EXPECT_EQ(takeNext(requests), 2u);
    EXPECT_EQ(takeNext(requests), 0u);
}

TEST(Requests, CapturesAreHeldBackAndKeepTheirPlace) {
    Requests requests({10, 1000});
    const SenderPtr a = sender(1);
    requests.add(a, request(1, protocol::kLockstep | protocol::kCaptureColor));
    requests.add(a, request(2, protocol::kLockstep));
    a->unsentBytes = 1001;
    EXPECT_EQ(takeNext(requests), 0u);
    a->unsentBytes = 1000;
    EXPECT_EQ(takeNext(requests), 1u);
    a->unsentBytes = 1001;
    EXPECT_EQ(takeNext(requests), 2u);  // no pictures, no need to wait
}

TEST(Requests, OriginsAreBounded) {
    Requests requests({10, 1000});
    const SenderPtr a = sender(1);
    std::uint64_t first = 0, last = 0;
    for (std::uint64_t i = 1; i <= Requests::kRemembered + 1; ++i) {
        requests.add(a, request(i, 0));
        last = requests.take()->request.sequence;
        if (i == 1) first = last;
    }
    EXPECT_FALSE(requests.origin(first).has_value());
    EXPECT_TRUE(requests.origin(last).has_value());
}

}  // namespace
}  // namespace iwalk
