#include "preprocess/build/distribute_queue.hpp"

namespace iwalk {

DistributeQueue::DistributeQueue(Distributor& distributor, unsigned threads)
    : distributor_(distributor),
      slots_(batchesAtOnce(threads)),
      packed_(slots_.size(), false),
      ring_(
          slots_.size(), [this](std::size_t slot) { distributor_.pack(slots_[slot]); },
          [this](std::size_t slot) { appendPacked(slot); }) {}

Result<void> DistributeQueue::add(std::vector<Triangle>& triangles) {
    if (slots_.size() == 1) return distributor_.add(triangles);
    const std::size_t slot = added_ % slots_.size();
    if (added_ >= slots_.size()) waitUntil(added_ - slots_.size() + 1);
    {
        const std::lock_guard lock(mutex_);
        if (error_) return *error_;
    }
    slots_[slot].triangles.swap(triangles);
    ++added_;
    ring_.start(slot);
    return {};
}

Result<void> DistributeQueue::finish() {
    waitUntil(added_);
    const std::lock_guard lock(mutex_);
    return error_ ? Result<void>(*error_) : Result<void>();
}

// At most as many as were added.
void DistributeQueue::waitUntil(std::size_t appended) {
    std::unique_lock lock(mutex_);
    while (appended_ < appended) {
        const std::size_t next = appended_;
        lock.unlock();
        ring_.finish(next % slots_.size());
        lock.lock();
        // The thread that packed it puts it into the bins, or another that is at it already.
        changed_.wait(lock, [&] { return appended_ > next; });
    }
}

void DistributeQueue::appendPacked(std::size_t slot) {
    std::unique_lock lock(mutex_);
    packed_[slot] = true;
    if (appending_) return;
    appending_ = true;
    for (std::size_t next = appended_ % slots_.size(); packed_[next]; next = appended_ % slots_.size()) {
        if (!error_) {
            lock.unlock();
            const Result<void> result = distributor_.append(slots_[next]);
            lock.lock();
            if (!result) error_ = result.error();
        }
        packed_[next] = false;
        ++appended_;
        changed_.notify_all();
    }
    appending_ = false;
}

}  // namespace iwalk
