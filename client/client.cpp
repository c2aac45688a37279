#include "client/client.hpp"

#include <unistd.h>

#include <chrono>
#include <filesystem>

#include "client/wall_check.hpp"
#include "common/file.hpp"
#include "common/token.hpp"

namespace iwalk::client {
namespace {

using Clock = ServerLink::Clock;

Clock::time_point timeoutFromNow(const Options& options) {
    return Clock::now() +
           std::chrono::ceil<Clock::duration>(std::chrono::duration<double>(options.timeoutSeconds));
}

// Before a path is played for an hour, not after it.
Result<void> checkReportPlace(const std::string& report) {
    const std::filesystem::path parent = std::filesystem::path(report).parent_path();
    const std::string directory = parent.empty() ? "." : parent.string();
    if (::access(directory.c_str(), W_OK) != 0)
        return fail("{}: the directory is not there or not writable", report);
    return {};
}

std::string summary(const Options& options, const std::vector<PlayedFrame>& frames, std::size_t pathFrames) {
    std::string line = fmt::format("{} of {} frames", frames.size(), pathFrames);
    if (const auto times = frameTimes(frames)) {
        line += fmt::format(", {:.1f} ms median, {:.1f} ms p99", times->median, times->p99);
    }
    // In lock step cameras wait in line for their turn.
    if (options.pace == Pace::realtime && !frames.empty()) {
        const FrameTimes latency = latencies(frames);
        line += fmt::format(", camera to swap {:.1f} ms median, {:.1f} ms p99", latency.median, latency.p99);
    }
    std::uint64_t badPages = 0;
    for (const PlayedFrame& frame : frames) {
        for (const auto& stats : frame.done.tiles) badPages += stats.badPages;
    }
    if (badPages > 0) line += fmt::format(", {} times a page could not be read", badPages);
    if (!options.captureDir.empty()) line += fmt::format("; pictures in {}", options.captureDir);
    if (!options.report.empty()) line += fmt::format("; report in {}", options.report);
    return line;
}

}  // namespace

Result<std::string> run(const Options& options, const Playback::Progress& progress) {
    ASSIGN_OR_RETURN(const std::vector<Camera> path, loadCameraPath(options.path));
    if (!options.report.empty()) RETURN_IF_ERROR(checkReportPlace(options.report));

    protocol::Hello hello;
    if (!options.tokenFile.empty()) {
        ASSIGN_OR_RETURN(hello.token, readToken(options.tokenFile));
    }
    ASSIGN_OR_RETURN(const auto link, ServerLink::connect(options.server, hello, timeoutFromNow(options)));
    RETURN_IF_ERROR(checkWall(link->welcome()));
    std::unique_ptr<Capture> capture;
    if (!options.captureDir.empty()) {
        ASSIGN_OR_RETURN(capture, Capture::create(options.captureDir, link->welcome()));
    }

    Playback playback(*link, path, capture.get(), {options.pace, options.fps, options.captureDepth});
    RETURN_IF_ERROR(playback.awaitControl(timeoutFromNow(options)));
    const Result<std::vector<PlayedFrame>> played = playback.run(progress);
    // Also after an error: what has come is written.
    if (capture) {
        const Result<void> written = capture->finish();
        if (played && !written) return written.error();
    }
    if (!played) return played.error();
    if (!options.report.empty())
        RETURN_IF_ERROR(replaceFile(options.report, reportText(link->welcome(), *played)));
    return summary(options, *played, path.size());
}

}  // namespace iwalk::client
