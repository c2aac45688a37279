#include "client/playback.hpp"

#include <algorithm>
#include <cmath>

namespace iwalk::client {
namespace {

using protocol::Message;
using Clock = ServerLink::Clock;

// Frames in flight in lock step: enough that a round trip does not keep the wall waiting; few when each
// brings pictures, which pile up here or there.
constexpr std::size_t kInFlight = 4;
constexpr std::size_t kInFlightCapturing = 2;
constexpr std::chrono::milliseconds kCaptureLook{
    10};  // between looks at whether the disk has caught up, or failed

}  // namespace

Playback::Playback(ServerLink& link, std::vector<Camera> path, Capture* capture, const Options& options)
    : link_(link), path_(std::move(path)), capture_(capture), options_(options) {
    CHECK(!path_.empty());
    CHECK_OP(options_.fps, >, 0);
}

Result<void> Playback::awaitControl(Clock::time_point deadline) {
    for (;;) {
        ASSIGN_OR_RETURN(const std::optional<Message> message, link_.receive(deadline));
        const auto* control = message ? std::get_if<protocol::Control>(&*message) : nullptr;
        if (control && control->granted) return {};
        // The other client's frames may come so fast that there always is a message.
        if (!message || Clock::now() >= deadline) {
            return fail("another client controls the wall; end that one, or wait longer with --timeout");
        }
    }
}

Result<std::vector<PlayedFrame>> Playback::run(const Progress& progress) {
    start_ = Clock::now();
    while (next_ < path_.size() || !underWay_.empty()) {
        RETURN_IF_ERROR(sendDue());
        ASSIGN_OR_RETURN(const std::optional<Message> message, link_.receive(nextLook()));
        if (message) RETURN_IF_ERROR(take(*message));
        if (capture_) RETURN_IF_ERROR(capture_->status());
        if (message && progress) progress(played_.size(), path_.size());
    }
    return std::move(played_);
}

Result<void> Playback::sendDue() {
    if (options_.pace == Pace::lockstep) {
        while (next_ < path_.size() && hasRoom()) RETURN_IF_ERROR(sendFrame(next_));
        return {};
    }
    const std::size_t due = framesDueNow();
    if (due > next_ && hasRoom()) return sendFrame(due - 1);
    return {};
}

Result<void> Playback::sendFrame(std::size_t frame) {
    protocol::CameraRequest request;
    request.sequence = frame + 1;
    request.camera = path_[frame];
    if (options_.pace == Pace::lockstep) request.flags |= protocol::kLockstep;
    if (capture_) request.flags |= protocol::kCaptureColor;
    if (capture_ && options_.captureDepth) request.flags |= protocol::kCaptureDepth;
    underWay_[request.sequence].sent = Clock::now();
    next_ = frame + 1;
    return link_.send(request);
}

bool Playback::hasRoom() const {
    if (capture_ && capture_->backlog() > picturesPerFrame()) return false;
    return options_.pace == Pace::realtime || underWay_.size() < (capture_ ? kInFlightCapturing : kInFlight);
}

// How many frames of the path the clock has reached; the last one stays due until it is sent.
std::size_t Playback::framesDueNow() const {
    const std::chrono::duration<double> elapsed = Clock::now() - start_;
    const double frames = std::floor(elapsed.count() * options_.fps) + 1;
    return frames < static_cast<double>(path_.size()) ? static_cast<std::size_t>(frames) : path_.size();
}

Clock::time_point Playback::nextLook() const {
    Clock::time_point look = Clock::time_point::max();
    if (capture_) look = Clock::now() + kCaptureLook;
    if (options_.pace == Pace::realtime && framesDueNow() <= next_ && next_ < path_.size()) {
        const std::chrono::duration<double> due(static_cast<double>(next_) / options_.fps);
        look = std::min(look, start_ + std::chrono::ceil<Clock::duration>(due));
    }
    return look;
}

Result<void> Playback::take(const Message& message) {
    if (const auto* done = std::get_if<protocol::FrameDone>(&message)) return takeFrame(*done);
    if (const auto* image = std::get_if<protocol::TileImage>(&message)) return takeImage(*image);
    const auto* control = std::get_if<protocol::Control>(&message);
    if (!control) return fail("the server sent a message that does not belong here");
    if (!control->granted) return fail("the server took the control of the wall away");
    return {};
}

Result<void> Playback::takeFrame(const protocol::FrameDone& done) {
    if (done.sequence == 0) return {};  // asked for by the client before us
    const auto request = underWay_.find(done.sequence);
    if (request == underWay_.end() || request->second.done) {
        return fail("the server drew frame {} twice or unasked", done.sequence - 1);
    }
    const bool first = std::none_of(underWay_.begin(), request, [](const auto& r) { return !r.second.done; });
    if (options_.pace == Pace::lockstep && !first)
        return fail("the server left out a frame before {}", done.sequence - 1);
    RETURN_IF_ERROR(checkStats(done));

    // Older cameras that were not drawn were overtaken by this one.
    std::erase_if(underWay_, [&](const auto& r) { return r.first < done.sequence && !r.second.done; });
    const std::chrono::duration<double, std::milli> answered = Clock::now() - request->second.sent;
    played_.push_back({static_cast<std::size_t>(done.sequence - 1), done,
                       std::max(0.0, answered.count() - done.sinceSwapMs)});
    request->second.done = true;
    settle(done.sequence);
    return {};
}

Result<void> Playback::checkStats(const protocol::FrameDone& done) const {
    const std::size_t tiles = link_.welcome().tiles.size();
    const bool fine =
        std::all_of(done.tiles.begin(), done.tiles.end(), [&](const auto& t) { return t.tile < tiles; });
    return fine ? Result<void>() : fail("the server reports a tile that it does not have");
}

Result<void> Playback::takeImage(const protocol::TileImage& image) {
    const auto request = underWay_.find(image.sequence);
    const bool kind = image.kind == protocol::ImageKind::png || options_.captureDepth;
    if (!capture_ || !kind || request == underWay_.end() || image.tile >= link_.welcome().tiles.size() ||
        !request->second.pictures.emplace(image.tile, image.kind).second) {
        return fail("the server sent a picture that was not asked for");
    }
    capture_->add(static_cast<std::size_t>(image.sequence - 1), image);
    settle(image.sequence);
    return {};
}

// Forgets a request when all of its answers are here.
void Playback::settle(std::uint64_t sequence) {
    const Request& request = underWay_.at(sequence);
    if (request.done && request.pictures.size() == picturesPerFrame()) underWay_.erase(sequence);
}

std::size_t Playback::picturesPerFrame() const {
    if (!capture_) return 0;
    return link_.welcome().tiles.size() * (options_.captureDepth ? 2 : 1);
}

}  // namespace iwalk::client
