#include "server/sync/host_meeting.hpp"

#include <semaphore.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <new>

#include "common/check.hpp"

namespace iwalk {
namespace {

constexpr long kIdleEveryNs = 1'000'000, kSecondNs = 1'000'000'000;

void prepareSemaphore(sem_t& semaphore) {
    constexpr int kBetweenProcesses = 1;
    CHECK_OP(sem_init(&semaphore, kBetweenProcesses, 0), ==, 0);
}

void post(sem_t& semaphore) {
    CHECK_OP(sem_post(&semaphore), ==, 0);
}

void wait(sem_t& semaphore, const HostMeeting::IdleWork& idle) {
    while (true) {
        timespec until{};
        clock_gettime(CLOCK_MONOTONIC, &until);
        until.tv_nsec += kIdleEveryNs;
        if (until.tv_nsec >= kSecondNs) ++until.tv_sec, until.tv_nsec -= kSecondNs;
        if (sem_clockwait(&semaphore, CLOCK_MONOTONIC, &until) == 0) return;
        CHECK(errno == ETIMEDOUT || errno == EINTR);
        if (idle) idle();
    }
}

}  // namespace

struct HostMeeting::Shared {
    sem_t here;  // posted by each follower that comes
    std::array<std::byte, kMostBytes> bytes;

    // Behind this: posted for one rank each; the leader's is not used.
    sem_t& go(int rank) { return reinterpret_cast<sem_t*>(this + 1)[rank]; }
};

std::size_t HostMeeting::bytesFor(int ranks) {
    return sizeof(Shared) + static_cast<std::size_t>(ranks) * sizeof(sem_t);
}

void HostMeeting::prepare(void* memory, int ranks) {
    Shared& shared = *new (memory) Shared;
    prepareSemaphore(shared.here);
    for (int i = 1; i < ranks; ++i) prepareSemaphore(shared.go(i));
}

HostMeeting::HostMeeting(void* memory, int rank, int ranks)
    : shared_(*static_cast<Shared*>(memory)), rank_(rank), ranks_(ranks) {}

void HostMeeting::gather(const IdleWork& idle) {
    for (int i = 1; i < ranks_; ++i) wait(shared_.here, idle);
}

void HostMeeting::release(std::span<const std::byte> bytes) {
    CHECK_OP(bytes.size(), <=, kMostBytes);
    std::copy(bytes.begin(), bytes.end(), shared_.bytes.begin());
    for (int i = 1; i < ranks_; ++i) post(shared_.go(i));
}

void HostMeeting::follow(std::span<std::byte> bytes, const IdleWork& idle) {
    CHECK_OP(bytes.size(), <=, kMostBytes);
    post(shared_.here);
    wait(shared_.go(rank_), idle);
    std::copy_n(shared_.bytes.begin(), bytes.size(), bytes.begin());
}

}  // namespace iwalk
