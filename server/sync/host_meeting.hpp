#pragma once

#include <cstddef>
#include <functional>
#include <span>

namespace iwalk {

// How the ranks of one host come together: in memory that they share, with semaphores, so that who waits
// sleeps until the kernel wakes it. One of them leads; between gather() and release() it speaks for its host.
class HostMeeting {
  public:
    static constexpr std::size_t kMostBytes = 1024;
    using IdleWork = std::function<void()>;  // done every millisecond of a wait; may be empty

    // What `ranks` of them need, to be aligned like double.
    static std::size_t bytesFor(int ranks);

    // Before any of them has a HostMeeting there; the memory may hold anything.
    static void prepare(void* memory, int ranks);

    // `rank`: from 0, which leads, to `ranks` - 1. The memory must stay.
    HostMeeting(void* memory, int rank, int ranks);

    bool leads() const { return rank_ == 0; }

    // The leader: returns when all others are in follow().
    void gather(const IdleWork& idle);
    // The leader, after gather(): gives the others these bytes, at most kMostBytes, and lets them go on.
    void release(std::span<const std::byte> bytes);

    // The others: returns after the leader's release() with its bytes. As many as it gives are asked for.
    void follow(std::span<std::byte> bytes, const IdleWork& idle);

  private:
    struct Shared;

    Shared& shared_;
    const int rank_, ranks_;
};

}  // namespace iwalk
