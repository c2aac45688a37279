#include "preprocess/import/work_ring.hpp"

namespace iwalk {

WorkRing::WorkRing(std::size_t slots, Work work, Work after)
    : work_(std::move(work)), after_(std::move(after)), states_(slots) {}

WorkRing::~WorkRing() noexcept {
    for (std::atomic<int>& state : states_) {
        int expected = waiting;
        state.compare_exchange_strong(expected, idle);
    }
    group_.wait();
}

void WorkRing::start(std::size_t slot) {
    states_[slot] = waiting;
    if (slots() == 1 || tasks_ >= slots()) return;
    ++tasks_;
    // A task takes what is oldest then, since the leading thread may have done this slot before.
    group_.run([this] {
        --tasks_;
        workOnOne();
    });
}

void WorkRing::finish(std::size_t slot) {
    oldest_ = slot;
    for (std::size_t i = 0; i < slots() && states_[slot] != idle; ++i) tryWork((slot + i) % slots());
    while (states_[slot] == working) states_[slot].wait(working);
}

bool WorkRing::tryWork(std::size_t slot) noexcept {
    int expected = waiting;
    if (!states_[slot].compare_exchange_strong(expected, working)) return false;
    work_(slot);
    states_[slot] = idle;
    states_[slot].notify_all();
    after_(slot);
    return true;
}

void WorkRing::workOnOne() {
    const std::size_t first = oldest_;
    for (std::size_t i = 0; i < slots(); ++i) {
        if (tryWork((first + i) % slots())) return;
    }
}

}  // namespace iwalk
