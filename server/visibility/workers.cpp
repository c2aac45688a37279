#include "server/visibility/workers.hpp"

#include <algorithm>

namespace iwalk {

Workers::Workers(unsigned threads) {
    for (unsigned i = 1; i < threads; ++i) threads_.emplace_back([this] { loop(); });
}

Workers::~Workers() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    begun_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void Workers::run(std::size_t pieces, const std::function<void(std::size_t)>& work) {
    if (threads_.empty() || pieces < 2) {
        for (std::size_t i = 0; i < pieces; ++i) work(i);
        return;
    }
    std::unique_lock lock(mutex_);
    work_ = &work;
    pieces_ = pieces;
    next_ = finished_ = 0;
    begun_.notify_all();
    takePieces(lock);
    done_.wait(lock, [&] { return finished_ == pieces_; });
}

void Workers::runParts(std::size_t count, std::size_t together,
                       const std::function<void(std::size_t, std::size_t)>& work) {
    run((count + together - 1) / together,
        [&](std::size_t part) { work(part * together, std::min(count, (part + 1) * together)); });
}

void Workers::loop() {
    std::unique_lock lock(mutex_);
    while (true) {
        begun_.wait(lock, [&] { return stop_ || next_ < pieces_; });
        if (stop_) return;
        takePieces(lock);
    }
}

void Workers::takePieces(std::unique_lock<std::mutex>& lock) {
    while (next_ < pieces_) {
        const std::size_t piece = next_++;
        lock.unlock();
        (*work_)(piece);
        lock.lock();
        if (++finished_ == pieces_) done_.notify_one();
    }
}

}  // namespace iwalk
