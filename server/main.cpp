// iwalk-server: one MPI rank draws one tile of the wall.

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "common/token.hpp"
#include "common/version.hpp"
#include "server/draw/gl_context.hpp"
#include "server/frame/frame_loop.hpp"
#include "server/options.hpp"

namespace {

using namespace iwalk;

std::atomic<bool> stopRequested = false;

void requestStop(int) {
    stopRequested = true;
}

// Before MPI runs only its launcher's environment tells the rank.
bool speaksForAll() {
    const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
    return !rank || std::string(rank) == "0";
}

std::string hostName() {
    char name[256] = "";
    gethostname(name, sizeof name - 1);
    return name;
}

void logTo(const std::string& who) {
    auto logger = spdlog::stderr_logger_mt("server");
    logger->set_pattern(who + ": %v");
    spdlog::set_default_logger(logger);
}

// All ranks go on, or all stop and every different reason is said once.
bool allFine(Sync& sync, const Result<void>& mine) {
    if (sync.agree(mine.ok())) return true;
    const std::vector<std::string> reasons = sync.gatherText(mine.ok() ? "" : mine.error().message);
    for (const std::string& reason : std::set<std::string>(reasons.begin(), reasons.end()))
        if (!reason.empty()) std::fprintf(stderr, "iwalk-server: %s\n", reason.c_str());
    return false;
}

Result<void> readInputs(ServerOptions& options, Dataset& dataset, const Sync& sync) {
    RETURN_IF_ERROR(readWallFile(options));
    if (options.wall.tiles.size() != static_cast<std::size_t>(sync.size()))
        return fail("{} has {} tiles, but there are {} ranks: start mpirun -np {}", options.wallFile,
                    options.wall.tiles.size(), sync.size(), options.wall.tiles.size());
    ASSIGN_OR_RETURN(dataset, openDataset(options.dataset));
    return {};
}

protocol::Welcome makeWelcome(const ServerOptions& options, const Dataset& dataset,
                              const std::vector<std::string>& hosts) {
    protocol::Welcome welcome;
    welcome.serverVersion = kVersion;
    welcome.datasetTriangles = dataset.manifest.triangles;
    welcome.datasetBytes = dataset.bytes;
    welcome.bounds = dataset.manifest.bounds;
    welcome.wallWidth = options.wall.width;
    welcome.wallHeight = options.wall.height;
    for (std::size_t i = 0; i < options.wall.tiles.size(); ++i) {
        const PixelRect& rect = options.wall.tiles[i].onWall;
        welcome.tiles.push_back({options.wall.tiles[i].name, hosts[i], static_cast<std::uint32_t>(i), rect.x,
                                 rect.y, rect.width, rect.height});
    }
    for (const SettingInfo& setting : settingTable())
        welcome.settings.push_back({setting.name, settingText(options.settings, setting.name)});
    return welcome;
}

// What a rank holds while it runs; made in this order, taken down in reverse.
struct Rank {
    std::unique_ptr<GlContext> gl;
    std::unique_ptr<TilePipeline> pipeline;
    std::unique_ptr<Gateway> gateway;
};

Result<void> prepare(Rank& rank, const ServerOptions& options, const Dataset& dataset, const Sync& sync,
                     const std::vector<std::string>& hosts) {
    ASSIGN_OR_RETURN(rank.gl, GlContext::createHeadless());
    ASSIGN_OR_RETURN(
        rank.pipeline,
        TilePipeline::create(dataset, options.wall, static_cast<std::size_t>(sync.rank()), options.settings));
    if (sync.rank() != 0) return {};
    std::string token;
    if (!options.tokenFile.empty()) {
        ASSIGN_OR_RETURN(token, readToken(options.tokenFile));
    }
    ASSIGN_OR_RETURN(rank.gateway, Gateway::listen(options.address, options.port,
                                                   makeWelcome(options, dataset, hosts), token));
    return {};
}

void announce(const ServerOptions& options, const Dataset& dataset, const Rank& rank) {
    std::printf("iwalk-server: %s: %llu triangles, %s; %s\n", options.dataset.c_str(),
                static_cast<unsigned long long>(dataset.manifest.triangles),
                formatBytes(dataset.bytes).c_str(), rank.gl->renderer().c_str());
    std::printf("iwalk-server: wall of %dx%d px on %zu tiles, listening on %s:%u\n", options.wall.width,
                options.wall.height, options.wall.tiles.size(), options.address.c_str(),
                rank.gateway->port());
    std::fflush(stdout);
}

int serve(Sync& sync, ServerOptions& options) {
    Dataset dataset;
    if (!allFine(sync, readInputs(options, dataset, sync))) return EXIT_FAILURE;
    const std::vector<std::string> hosts = sync.gatherText(hostName());
    logTo(fmt::format("iwalk-server: rank {} on {}", sync.rank(), hostName()));
    Rank rank;
    if (!allFine(sync, prepare(rank, options, dataset, sync, hosts))) return EXIT_FAILURE;
    if (sync.rank() == 0) announce(options, dataset, rank);
    runFrames({sync, *rank.pipeline, rank.gateway.get(),
               options.wall.tiles[static_cast<std::size_t>(sync.rank())].name, options.outputDirectory,
               dataset, options.wall, options.settings, stopRequested});
    return EXIT_SUCCESS;
}

int printTiles(ServerOptions& options) {
    if (const Result<void> read = readWallFile(options); !read) {
        std::fprintf(stderr, "iwalk-server: %s\n", read.error().message.c_str());
        return EXIT_FAILURE;
    }
    std::printf("%zu\n", options.wall.tiles.size());
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
    ServerOptions options;
    std::string message;
    const CommandLine parsed = parseCommandLine(argc, argv, options, message);
    if (parsed != CommandLine::run) {
        if (speaksForAll()) std::fputs(message.c_str(), parsed == CommandLine::done ? stdout : stderr);
        return parsed == CommandLine::done ? EXIT_SUCCESS : 2;
    }
    if (options.tilesOnly) return printTiles(options);
    std::signal(SIGTERM, requestStop);
    std::signal(SIGINT, requestStop);
    std::signal(SIGPIPE, SIG_IGN);
    Result<std::unique_ptr<Sync>> sync = startMpi(argc, argv);
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // no rank outlives its launcher
    if (!sync) {
        std::fprintf(stderr, "iwalk-server: %s\n", sync.error().message.c_str());
        return EXIT_FAILURE;
    }
    return serve(**sync, options);
}
