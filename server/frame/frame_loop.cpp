#include "server/frame/frame_loop.hpp"

#include <chrono>
#include <optional>
#include <thread>

#include "server/frame/last_camera.hpp"
#include "server/present/tile_writer.hpp"

namespace iwalk {
namespace {

using Clock = std::chrono::steady_clock;

class FrameLoop {
  public:
    explicit FrameLoop(const FrameLoopParts& parts)
        : parts_(parts), lastCamera_(parts.resumeFile), resumed_(lastCamera_.load()) {
        parts_.sync.setIdleWork([this] { idle(); });
    }
    ~FrameLoop() { parts_.sync.setIdleWork({}); }

    void run() {
        for (FrameState state = nextState(); state.command != FrameState::quit; state = nextState())
            drawFrame(state);
    }

  private:
    FrameState nextState();
    FrameState waitForRequest();
    std::optional<protocol::CameraRequest> nextRequest();
    void drawFrame(const FrameState& state);
    void present(const FrameState& state);
    void report(const FrameState& state, protocol::TileStats stats, Clock::time_point swap);
    void idle();
    void passCapturesOn();

    const FrameLoopParts& parts_;
    TileWriter writer_;
    LastCamera lastCamera_;          // rank 0's
    std::optional<Camera> resumed_;  // to be drawn before a client asks for anything
    std::uint64_t frame_ = 0;
    std::optional<Clock::time_point> lastSwap_;
};

FrameState FrameLoop::nextState() {
    FrameState state;
    if (parts_.sync.rank() == 0) state = waitForRequest();
    parts_.sync.broadcast(state);
    return state;
}

std::optional<protocol::CameraRequest> FrameLoop::nextRequest() {
    std::optional<protocol::CameraRequest> request = parts_.gateway->nextRequest();
    if (!request && resumed_) request = protocol::CameraRequest{0, 0, *resumed_};
    resumed_.reset();
    if (request) lastCamera_.shows(request->camera, Clock::now());
    lastCamera_.keep(Clock::now());
    return request;
}

// Rank 0 waits for its clients here, the others in broadcast().
FrameState FrameLoop::waitForRequest() {
    FrameState state;
    std::optional<protocol::CameraRequest> request;
    int pauseUs = 50;
    const auto stop = [this] { return parts_.stop || parts_.sync.askedToStop(); };
    while (!stop() && !(request = nextRequest())) {
        idle();
        std::this_thread::sleep_for(std::chrono::microseconds(pauseUs));
        pauseUs = std::min(1000, pauseUs * 2);
    }
    if (!request) {
        state.command = FrameState::quit;
        return state;
    }
    const auto copy = [](const glm::dvec3& from, double(&to)[3]) {
        to[0] = from.x, to[1] = from.y, to[2] = from.z;
    };
    state.flags = request->flags;
    state.frame = frame_;
    state.sequence = request->sequence;
    copy(request->camera.eye, state.eye);
    copy(request->camera.target, state.target);
    copy(request->camera.up, state.up);
    state.fovY = request->camera.fovY;
    state.near = parts_.near;
    return state;
}

void FrameLoop::drawFrame(const FrameState& state) {
    protocol::TileStats stats = parts_.pipeline.draw(state);
    parts_.output.prepare(parts_.pipeline.renderer().colorTexture());
    stats.barrierWaitMs = parts_.sync.barrier();
    parts_.output.show();
    const Clock::time_point swap = Clock::now();
    present(state);
    report(state, stats, swap);
    ++frame_;
}

// Files are what is shown, captures what was drawn: the same but for projectors' blending.
void FrameLoop::present(const FrameState& state) {
    TilePicture picture;
    picture.frame = state.frame;
    if (!parts_.outputDirectory.empty()) {
        picture.file = tileFile(parts_.outputDirectory, state.frame, parts_.tileName);
        picture.color = parts_.output.read();
        writer_.put(picture);
    }
    if (!(state.flags & (protocol::kCaptureColor | protocol::kCaptureDepth))) return;
    picture.file.clear();
    picture.capture = true;
    picture.sequence = state.sequence;
    picture.tile = static_cast<std::uint32_t>(parts_.sync.rank());
    picture.color = parts_.pipeline.renderer().readColor();
    if (state.flags & protocol::kCaptureDepth) picture.depth = parts_.pipeline.renderer().readDepth();
    writer_.put(std::move(picture));
}

void FrameLoop::report(const FrameState& state, protocol::TileStats stats, Clock::time_point swap) {
    std::vector<protocol::TileStats> all = parts_.sync.gather(stats);
    if (parts_.gateway) {
        protocol::FrameDone done;
        done.sequence = state.sequence;
        done.frame = state.frame;
        done.timeMs = std::chrono::duration<double, std::milli>(swap - lastSwap_.value_or(swap)).count();
        done.tiles = std::move(all);
        parts_.gateway->frameDone(std::move(done));
    }
    lastSwap_ = swap;
    passCapturesOn();
}

// Whenever a wait leaves time.
void FrameLoop::idle() {
    passCapturesOn();
    if (parts_.output.closed()) parts_.sync.askToStop();
}

// Captures go from this rank's writer to rank 0, and from there through the gateway.
void FrameLoop::passCapturesOn() {
    for (protocol::TileImage& tile : writer_.encoded()) parts_.sync.sendToRank0(std::move(tile));
    for (protocol::TileImage& tile : parts_.sync.poll())
        if (parts_.gateway) parts_.gateway->tileImage(std::move(tile));
}

}  // namespace

void runFrames(const FrameLoopParts& parts) {
    FrameLoop(parts).run();
}

}  // namespace iwalk
