#include "server/gateway/requests.hpp"

#include <utility>

#include "common/check.hpp"

namespace iwalk {

bool Requests::add(const SenderPtr& sender, const protocol::CameraRequest& request) {
    const std::lock_guard lock(mutex_);
    if ((request.flags & protocol::kLockstep) == 0) {
        newest_ = Waiting{sender, request};
        return !full();
    }
    CHECK(!full());
    lockstep_.push_back({sender, request});
    return !full();
}

void Requests::drop(const Sender& sender) {
    const std::lock_guard lock(mutex_);
    std::erase_if(lockstep_, [&](const Waiting& waiting) { return waiting.sender.get() == &sender; });
    if (newest_ && newest_->sender.get() == &sender) newest_.reset();
}

bool Requests::heldBack(const Waiting& waiting) const {
    const bool captures = (waiting.request.flags & (protocol::kCaptureColor | protocol::kCaptureDepth)) != 0;
    return captures && waiting.sender->unsentBytes > limits_.holdBackBytes;
}

std::optional<Requests::Taken> Requests::take() {
    const std::lock_guard lock(mutex_);
    if (lockstep_.empty() && !newest_) return std::nullopt;
    const bool inOrder = !lockstep_.empty();
    if (heldBack(inOrder ? lockstep_.front() : *newest_)) return std::nullopt;

    const bool wasFull = full();
    Waiting waiting = inOrder ? std::move(lockstep_.front()) : std::move(*newest_);
    if (inOrder) lockstep_.pop_front();
    if (!inOrder) newest_.reset();

    const std::uint64_t number = ++lastNumber_;
    origins_[number] = {waiting.sender, waiting.request.sequence};
    if (origins_.size() > kRemembered) origins_.erase(origins_.begin());
    waiting.request.sequence = number;
    return Taken{waiting.request, wasFull && !full()};
}

void Requests::changeSettings(const Settings& settings) {
    const std::lock_guard lock(mutex_);
    settings_ = settings;
}

std::optional<Settings> Requests::takeSettings() {
    const std::lock_guard lock(mutex_);
    return std::exchange(settings_, std::nullopt);
}

std::optional<Requests::Origin> Requests::origin(std::uint64_t sequence) const {
    const std::lock_guard lock(mutex_);
    const auto found = origins_.find(sequence);
    if (found == origins_.end()) return std::nullopt;
    return found->second;
}

}  // namespace iwalk
