#include "client/fly/session.hpp"

#include <algorithm>
#include <utility>

#include "client/server_link.hpp"
#include "client/wall_check.hpp"

namespace iwalk::client {
namespace {

using protocol::Message;

constexpr std::chrono::seconds kAttempt{1};
constexpr std::chrono::milliseconds kFirstPause{200}, kLongestPause{2000};  // between attempts
constexpr std::chrono::milliseconds kPauseLook{20};
constexpr std::chrono::seconds kNoHurry{1};
// A wall that answers nothing gets no more cameras: they would pile up in the network.
constexpr std::size_t kMostUnanswered = 256;
constexpr std::size_t kMostPreviewBytes = 64u << 20;  // of the whole wall, compressed

}  // namespace

Session::Session(const Address& server, const protocol::Hello& hello, std::function<void()> news)
    : server_(server), news_(std::move(news)), hello_(hello), thread_([this] { run(); }) {}

Session::~Session() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
        wake();
    }
    thread_.join();
}

WallState Session::state() const {
    const std::lock_guard lock(mutex_);
    WallState state = state_;
    state.framesPerSecond = meter_.framesPerSecond(Clock::now());
    state.latency = meter_.latency();
    state.interval = meter_.interval();
    return state;
}

std::vector<protocol::TileImage> Session::previews() {
    const std::lock_guard lock(mutex_);
    return std::exchange(previews_, {});
}

void Session::setCamera(const Camera& camera) {
    const std::lock_guard lock(mutex_);
    camera_ = camera;
    cameraSince_ = Clock::now();
    cameraDue_ = true;
    wake();
}

void Session::changeSetting(const std::string& name, const std::string& value) {
    const std::lock_guard lock(mutex_);
    settings_[name] = value;
    settingsDue_ = true;
    wake();
}

void Session::wishControl(bool control) {
    const std::lock_guard lock(mutex_);
    hello_.control = control;
    helloDue_ = true;
    wake();
}

void Session::wishPreview(bool preview) {
    const std::lock_guard lock(mutex_);
    hello_.preview = preview;
    helloDue_ = true;
    wake();
}

void Session::wake() {
    if (link_) link_->wake();
}

void Session::run() {
    auto pause = kFirstPause;
    for (;;) {
        protocol::Hello hello;
        {
            const std::lock_guard lock(mutex_);
            if (stop_) return;
            hello = hello_;
            helloDue_ = false;
        }
        auto link = ServerLink::connect(server_, hello, Clock::now() + kAttempt);
        Result<void> end;
        if (link) end = checkWall((*link)->welcome());
        if (link && end) {
            pause = kFirstPause;
            end = serve(**link);
        }
        const std::string trouble = !link ? link.error().message : end ? "" : end.error().message;
        {
            const std::lock_guard lock(mutex_);
            state_.connected = state_.told = state_.control = false;
            state_.trouble = trouble;
        }
        news_();
        for (auto slept = kPauseLook; slept < pause; slept += kPauseLook) {
            std::this_thread::sleep_for(kPauseLook);
            const std::lock_guard lock(mutex_);
            if (stop_) return;
        }
        pause = std::min(kLongestPause, pause * 2);
    }
}

// From the Welcome to the end of the connection.
Result<void> Session::serve(ServerLink& link) {
    {
        const std::lock_guard lock(mutex_);
        state_.welcome = std::make_shared<const protocol::Welcome>(link.welcome());
        state_.connected = true;
        state_.trouble.clear();
        state_.refusal.clear();
        state_.settings = link.welcome().settings;
        state_.frame = nullptr;
        meter_.forget();
        coming_.clear();
        previews_.clear();
        link_ = &link;
    }
    news_();
    Result<void> fine;
    for (bool stop = false; fine && !stop;) {
        for (const Message& message : due())
            if (fine) fine = link.send(message);
        if (!fine) break;
        Result<std::optional<Message>> message = link.receive(Clock::now() + kNoHurry);
        if (!message) fine = message.error();
        if (message && *message) {
            fine = take(std::move(**message));
            news_();
        }
        const std::lock_guard lock(mutex_);
        stop = stop_;
    }
    const std::lock_guard lock(mutex_);
    link_ = nullptr;
    return fine;
}

// What is to be sent now. Settings go before the camera that is to be drawn with them.
std::vector<Message> Session::due() {
    const std::lock_guard lock(mutex_);
    std::vector<Message> messages;
    if (std::exchange(helloDue_, false)) messages.emplace_back(hello_);
    if (!state_.control) return messages;
    if (std::exchange(settingsDue_, false)) {
        protocol::ChangeSettings changes;
        for (const auto& [name, value] : settings_) changes.settings.push_back({name, value});
        messages.emplace_back(std::move(changes));
    }
    if (cameraDue_ && meter_.unanswered() < kMostUnanswered) {
        cameraDue_ = false;
        messages.emplace_back(protocol::CameraRequest{++sequence_, 0, *camera_});
        meter_.sent(sequence_, cameraSince_);
    }
    return messages;
}

Result<void> Session::take(Message message) {
    const std::lock_guard lock(mutex_);
    if (auto* frame = std::get_if<protocol::FrameDone>(&message)) return takeFrame(std::move(*frame));
    if (auto* image = std::get_if<protocol::TileImage>(&message)) return takePicture(std::move(*image));
    if (auto* now = std::get_if<protocol::SettingsNow>(&message))
        return takeSettings(std::move(*now)), Result<void>();
    const auto* control = std::get_if<protocol::Control>(&message);
    if (!control) return fail("the server sent a message that does not belong here");
    // Who comes into control brings what was asked for meanwhile, or before the servers were started anew.
    if (control->granted && !state_.control) {
        settingsDue_ = !settings_.empty();
        cameraDue_ = camera_ && (!state_.frame || state_.frame->camera != *camera_);
        cameraSince_ = Clock::now();
    }
    if (!control->granted) {
        meter_.forget();  // its cameras will not be answered
        if (state_.frame) camera_ = state_.frame->camera;
    }
    state_.control = control->granted;
    state_.waiting = control->waiting;
    state_.told = true;
    return {};
}

Result<void> Session::takeFrame(protocol::FrameDone frame) {
    const std::size_t tiles = state_.welcome->tiles.size();
    for (const protocol::TileStats& stats : frame.tiles)
        if (stats.tile >= tiles) return fail("the server reports a tile that it does not have");
    meter_.done(frame, Clock::now());
    // Who watches sees with the eyes of who steers, and goes on from there.
    if (state_.told && !state_.control) camera_ = frame.camera;
    state_.frame = std::make_shared<const protocol::FrameDone>(std::move(frame));
    return {};
}

Result<void> Session::takePicture(protocol::TileImage image) {
    if (image.kind != protocol::ImageKind::preview || image.tile >= state_.welcome->tiles.size())
        return fail("the server sent a picture that was not asked for");
    // Tiles of two moments side by side would look broken.
    if (!coming_.empty() && coming_.begin()->second.sequence != image.sequence) coming_.clear();
    std::size_t bytes = image.bytes.size();
    for (const auto& [tile, picture] : coming_) bytes += picture.bytes.size();
    if (bytes > kMostPreviewBytes) return fail("the server's previews are too large");
    const std::uint32_t tile = image.tile;
    coming_.insert_or_assign(tile, std::move(image));
    if (coming_.size() < state_.welcome->tiles.size()) return {};
    previews_.clear();
    for (auto& [number, picture] : std::exchange(coming_, {})) previews_.push_back(std::move(picture));
    return {};
}

void Session::takeSettings(protocol::SettingsNow now) {
    state_.settings = std::move(now.settings);
    state_.refusal = std::move(now.refusal);
    // Refused, or changed by another client since: then that counts.
    for (const protocol::NamedValue& setting : state_.settings)
        if (const auto ours = settings_.find(setting.name); ours != settings_.end())
            ours->second = setting.value;
}

}  // namespace iwalk::client
