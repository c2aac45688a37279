#pragma once

#include <oneapi/tbb/task_group.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <vector>

namespace iwalk {

// Slots of work that one thread, the leading one, fills in turn, and that whichever thread is free works on:
// those of the arena that the leading one is in, and itself when it would have to wait. With a single slot no
// other thread has part in it.
class WorkRing {
  public:
    using Work = std::function<void(std::size_t)>;
    // `work` is called with a slot's number, for several slots at once; it never waits for another. So is
    // `after`, by the same thread, when the slot is done and may be filled again.
    WorkRing(
        std::size_t slots, Work work, Work after = [](std::size_t) {});
    // Waits for what is being worked on; what nobody has begun with stays undone.
    ~WorkRing() noexcept;  // which a task_group's destructor is not

    std::size_t slots() const { return states_.size(); }
    // The slot is filled, and nobody's; slots are started in turn, 0 after the last.
    void start(std::size_t slot);
    // Returns when a started slot is done; does it, or others behind it, as long as it is not.
    void finish(std::size_t slot);

  private:
    enum State : int { idle, waiting, working };

    // What throws would leave the slot to wait for without end.
    bool tryWork(std::size_t slot) noexcept;
    void workOnOne();

    Work work_, after_;
    std::vector<std::atomic<int>> states_;
    std::atomic<std::size_t> oldest_ = 0;  // where to begin to look; any will do
    std::atomic<std::size_t> tasks_ = 0;   // that have been handed to the arena, and have not begun
    tbb::task_group group_;
};

}  // namespace iwalk
