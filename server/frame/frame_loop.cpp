#include "server/frame/frame_loop.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "common/jpeg.hpp"
#include "server/gateway/frame_pace.hpp"
#include "server/gateway/preview_pace.hpp"
#include "server/present/tile_writer.hpp"

namespace iwalk {
namespace {

using Clock = std::chrono::steady_clock;

class FrameLoop {
  public:
    explicit FrameLoop(const FrameLoopParts& parts) : parts_(parts), begin_(parts.begin) {
        parts_.sync.setIdleWork([this] { idle(); });
    }
    ~FrameLoop() { parts_.sync.setIdleWork({}); }

    void run() {
        for (FrameState state = nextState(); state.command != FrameState::quit; state = nextState())
            switch (state.command) {
                case FrameState::draw:
                    drawFrame(state);
                    break;
                case FrameState::meet:
                    parts_.sync.barrier();
                    lives();
                    break;
                default:
                    sendPreview();
            }
    }

  private:
    FrameState nextState();
    FrameState waitForRequest();
    FrameState stateOf(const protocol::CameraRequest& request);
    bool previewDue();
    void sendPreview();
    void sendPreview(std::size_t tile, double scale);
    void takePicture(protocol::TileImage picture);
    std::optional<protocol::CameraRequest> nextRequest();
    void drawFrame(const FrameState& state);
    void lives();
    void present(const FrameState& state, std::size_t tile);
    void report(const FrameState& state, const std::vector<protocol::TileStats>& stats,
                Clock::time_point swap);
    void idle();
    void passCapturesOn();

    const FrameLoopParts& parts_;
    TileWriter writer_;
    std::optional<Camera> begin_;  // as in FrameLoopParts, until it is drawn
    std::uint64_t frame_ = 0;
    std::optional<Clock::time_point> lastSwap_;
    Settings settings_ = parts_.settings, next_ = settings_;  // drawn with, and (rank 0) from now on
    std::optional<protocol::CameraRequest> last_;  // rank 0: what the wall shows, as if nobody had asked
    bool again_ = false;                           // rank 0: settings have changed since
    std::uint64_t joined_ = 0;                     // rank 0: as in Gateway::PreviewWish
    std::uint64_t preview_ = 0;                    // counts them, the same on all ranks
    PreviewPace previews_;                         // rank 0
    FramePace pace_;                               // rank 0
};

double ms(Clock::duration duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

// Px of a preview for each px of the wall. Where screens stand freely, as if their tiles made a square.
double previewScale(const Wall& wall, std::uint32_t size) {
    int longest = std::max(wall.width, wall.height);
    if (longest == 0) {
        for (const Tile& tile : wall.tiles)
            longest = std::max({longest, tile.onWall.width, tile.onWall.height});
        longest = static_cast<int>(longest * std::ceil(std::sqrt(static_cast<double>(wall.tiles.size()))));
    }
    return std::min(1.0, size / static_cast<double>(longest));
}

FrameState FrameLoop::nextState() {
    FrameState state;
    if (parts_.sync.rank() == 0) state = waitForRequest();
    parts_.sync.broadcast(state);
    return state;
}

// A client's camera, or the last one again when settings have changed.
std::optional<protocol::CameraRequest> FrameLoop::nextRequest() {
    parts_.last.keep(Clock::now());
    std::optional<protocol::CameraRequest> request = parts_.gateway->nextRequest();
    if (!request && begin_) request = protocol::CameraRequest{0, 0, *begin_};
    begin_.reset();
    if (const std::optional<Settings> changed = parts_.gateway->newSettings()) {
        next_ = *changed;
        again_ = true;
        parts_.last.changes(next_, Clock::now());
    }
    if (!request && again_) request = last_;
    if (!request) return request;
    parts_.last.shows(request->camera, Clock::now());
    again_ = false;
    last_ = request;
    last_->sequence = 0;
    last_->flags = 0;
    return request;
}

// Rank 0 waits for its clients here, the others in broadcast().
FrameState FrameLoop::waitForRequest() {
    FrameState state;
    std::optional<protocol::CameraRequest> request;
    int pauseUs = 50;
    const auto stop = [this] { return parts_.stop || parts_.sync.askedToStop(); };
    while (!stop() && !(request = pace_.begin(Clock::now(), [this] { return nextRequest(); }))) {
        idle();
        const bool preview = last_ && previewDue();
        if (preview || parts_.last.beatDue(Clock::now())) {
            state.command = preview ? FrameState::preview : FrameState::meet;
            return state;
        }
        const Clock::time_point now = Clock::now(), look = now + std::chrono::microseconds(pauseUs);
        std::this_thread::sleep_until(pace_.due() > now ? std::min(look, pace_.due()) : look);
        pauseUs = std::min(1000, pauseUs * 2);
    }
    if (!request) {
        state.command = FrameState::quit;
        return state;
    }
    return stateOf(*request);
}

FrameState FrameLoop::stateOf(const protocol::CameraRequest& request) {
    FrameState state;
    const auto copy = [](const glm::dvec3& from, double(&to)[3]) {
        to[0] = from.x, to[1] = from.y, to[2] = from.z;
    };
    previews_.somethingNew();
    state.flags = request.flags | (previewDue() ? FrameState::kPreview : 0);
    state.frame = frame_;
    state.sequence = request.sequence;
    copy(request.camera.eye, state.eye);
    copy(request.camera.target, state.target);
    copy(request.camera.up, state.up);
    state.fovY = request.camera.fovY;
    state.near = nearPlane(next_, parts_.dataset.manifest);
    state.settings = next_;
    return state;
}

void FrameLoop::drawFrame(const FrameState& state) {
    if (state.settings != settings_) {
        const Result<void> applied = parts_.tiles.apply(state.settings);
        if (!applied) detail::checkFailed(__FILE__, __LINE__, applied.error().message);
        settings_ = state.settings;
    }
    std::vector<protocol::TileStats> stats;
    for (std::size_t i = 0; i < parts_.tiles.size(); ++i) {
        stats.push_back(parts_.tiles[i].draw(state));
        parts_.outputs[i]->prepare(parts_.tiles[i].pixels().colorTexture());
    }
    const double waitedMs = parts_.sync.barrier();
    for (protocol::TileStats& tile : stats) tile.barrierWaitMs = waitedMs;
    for (const std::unique_ptr<TileOutput>& output : parts_.outputs) output->show();
    const Clock::time_point swap = Clock::now();
    lives();
    for (std::size_t i = 0; i < parts_.tiles.size(); ++i) present(state, i);
    report(state, stats, swap);
    if (state.flags & FrameState::kPreview) sendPreview();
    ++frame_;
}

// All ranks have come to the barrier.
void FrameLoop::lives() {
    if (parts_.last.beatDue(Clock::now())) parts_.last.beat(Clock::now());
}

// Files are what is shown, captures what was drawn: the same but for projectors' blending.
void FrameLoop::present(const FrameState& state, std::size_t tile) {
    TilePicture picture;
    picture.frame = state.frame;
    if (!parts_.outputDirectory.empty()) {
        picture.file =
            tileFile(parts_.outputDirectory, state.frame, parts_.wall.tiles[parts_.numbers[tile]].name);
        picture.color = parts_.outputs[tile]->read();
        writer_.put(picture);
    }
    if (!(state.flags & (protocol::kCaptureColor | protocol::kCaptureDepth))) return;
    picture.file.clear();
    picture.capture = true;
    picture.sequence = state.sequence;
    picture.tile = static_cast<std::uint32_t>(parts_.numbers[tile]);
    picture.color = parts_.tiles[tile].pixels().readColor();
    if (state.flags & protocol::kCaptureDepth) picture.depth = parts_.tiles[tile].pixels().readDepth();
    writer_.put(std::move(picture));
}

void FrameLoop::report(const FrameState& state, const std::vector<protocol::TileStats>& stats,
                       Clock::time_point swap) {
    std::vector<protocol::TileStats> all = parts_.sync.gather(stats);
    if (parts_.gateway) {
        std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.tile < b.tile; });
        protocol::FrameDone done;
        done.sequence = state.sequence;
        done.frame = state.frame;
        done.timeMs = ms(swap - lastSwap_.value_or(swap));
        done.sinceSwapMs = ms(Clock::now() - swap);
        done.tiles = std::move(all);
        done.camera = last_->camera;
        parts_.gateway->frameDone(std::move(done));
        pace_.frameOver(Clock::now(), next_.maxFps);
    }
    lastSwap_ = swap;
    passCapturesOn();
}

// Whenever a wait leaves time.
void FrameLoop::idle() {
    passCapturesOn();
    for (const std::unique_ptr<TileOutput>& output : parts_.outputs)
        if (output->closed()) parts_.sync.askToStop();
}

// Captures go from this rank's writer to rank 0, and from there through the gateway.
void FrameLoop::passCapturesOn() {
    for (protocol::TileImage& tile : writer_.encoded()) parts_.sync.sendToRank0(std::move(tile));
    for (protocol::TileImage& tile : parts_.sync.poll()) takePicture(std::move(tile));
}

void FrameLoop::takePicture(protocol::TileImage picture) {
    if (!parts_.gateway) return;
    if (picture.kind == protocol::ImageKind::preview)
        previews_.arrived(picture.bytes.size(), next_.previewFps, next_.previewRate);
    // An empty one stands for a tile that has none.
    if (!picture.bytes.empty()) parts_.gateway->tileImage(std::move(picture));
}

// Begins them when they are: all ranks will be told.
bool FrameLoop::previewDue() {
    const Gateway::PreviewWish wish = parts_.gateway->previewWish();
    if (wish.joined != joined_) previews_.somethingNew();
    joined_ = wish.joined;
    const auto now = Clock::now();
    if (!wish.wanted || !previews_.due(now, next_.previewFps)) return false;
    previews_.begin(now, parts_.wall.tiles.size());
    return true;
}

void FrameLoop::sendPreview() {
    const double scale = previewScale(parts_.wall, settings_.previewSize);
    for (std::size_t i = 0; i < parts_.tiles.size(); ++i) sendPreview(i, scale);
    ++preview_;
}

// Read back small and compressed here: it takes less time than handing the large one to another thread.
void FrameLoop::sendPreview(std::size_t tile, double scale) {
    const PixelRect& place = parts_.wall.tiles[parts_.numbers[tile]].onWall;
    const auto pixels = [&](int length) {
        return std::max(1, static_cast<int>(std::lround(scale * length)));
    };
    const ColorImage small = parts_.tiles[tile].pixels().readSmall(pixels(place.width), pixels(place.height));
    Result<std::vector<std::byte>> bytes = encodeJpeg(small);
    if (!bytes) spdlog::error("no preview: {}", bytes.error().message);
    parts_.sync.sendToRank0({preview_, static_cast<std::uint32_t>(parts_.numbers[tile]),
                             protocol::ImageKind::preview,
                             bytes ? std::move(*bytes) : std::vector<std::byte>()});
}

}  // namespace

void runFrames(const FrameLoopParts& parts) {
    FrameLoop(parts).run();
}

}  // namespace iwalk
