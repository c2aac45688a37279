// Processes that meet in shared memory.
#include "server/sync/host_meeting.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <span>
#include <thread>
#include <vector>

namespace iwalk {
namespace {

constexpr int kRounds = 200;

// Memory that forked processes share.
class SharedMemory {
  public:
    explicit SharedMemory(std::size_t bytes)
        : bytes_(bytes),
          address_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
        std::memset(address_, 0xA5, bytes_);
    }
    ~SharedMemory() { munmap(address_, bytes_); }
    void* get() const { return address_; }

  private:
    const std::size_t bytes_;
    void* const address_;
};

// What each has come to, for the others to look at.
struct Counts {
    std::atomic<int> come[8];
};

// Whether all is as it should be. Rank 0 gives its round's number; nobody leaves a round that others have not
// come to.
bool meetOften(HostMeeting& meeting, int rank, int ranks, Counts& counts) {
    for (int round = 1; round <= kRounds; ++round) {
        if (round % 37 == rank) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        counts.come[rank] = round;
        std::int64_t number = rank == 0 ? round * 1000 : 0;
        const std::span bytes = std::as_writable_bytes(std::span(&number, 1));
        if (meeting.leads()) {
            meeting.gather({});
            meeting.release(bytes);
        } else {
            meeting.follow(bytes, {});
        }
        if (number != round * 1000) return false;
        for (int i = 0; i < ranks; ++i)
            if (counts.come[i] < round) return false;
    }
    return true;
}

class HostMeetingTest : public testing::TestWithParam<int> {};

TEST_P(HostMeetingTest, NobodyLeavesBeforeAllHaveCome) {
    const int ranks = GetParam();
    const SharedMemory memory(HostMeeting::bytesFor(ranks)), counted(sizeof(Counts));
    Counts& counts = *new (counted.get()) Counts{};
    HostMeeting::prepare(memory.get(), ranks);
    std::vector<pid_t> children;
    for (int rank = 1; rank < ranks; ++rank) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            HostMeeting meeting(memory.get(), rank, ranks);
            _exit(meetOften(meeting, rank, ranks, counts) ? 0 : 1);
        }
        children.push_back(child);
    }
    HostMeeting meeting(memory.get(), 0, ranks);
    EXPECT_TRUE(meetOften(meeting, 0, ranks, counts));
    for (const pid_t child : children) {
        int status = -1;
        EXPECT_EQ(waitpid(child, &status, 0), child);
        EXPECT_EQ(status, 0);
    }
}
INSTANTIATE_TEST_SUITE_P(Ranks, HostMeetingTest, testing::Values(1, 2, 5, 8));

TEST(HostMeeting, WhoWaitsDoesIdleWork) {
    std::vector<double> memory(HostMeeting::bytesFor(2) / sizeof(double) + 1);
    HostMeeting::prepare(memory.data(), 2);
    std::atomic<int> led = 0, followed = 0;
    std::thread follower([&] {
        HostMeeting meeting(memory.data(), 1, 2);
        while (led < 3) std::this_thread::yield();
        meeting.follow({}, [&] { ++followed; });
    });
    HostMeeting meeting(memory.data(), 0, 2);
    meeting.gather([&] { ++led; });
    EXPECT_GE(led, 3);
    while (followed < 3) std::this_thread::yield();
    meeting.release({});
    follower.join();
}

}  // namespace
}  // namespace iwalk
