// iwalk-server: one MPI rank draws one tile of the wall.

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "common/token.hpp"
#include "common/version.hpp"
#include "server/draw/gl_context.hpp"
#include "server/frame/frame_loop.hpp"
#include "server/frame/pattern_wall.hpp"
#include "server/frame/same_dataset.hpp"
#include "server/options.hpp"
#include "server/present/tile_writer.hpp"
#include "server/wall/assign.hpp"

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

void logTo(const std::string& who) {
    auto logger = spdlog::stderr_logger_mt("server");
    logger->set_pattern(who + ": %v");
    spdlog::set_default_logger(logger);
}

const std::string& hostOf(const Sync& sync) {
    return sync.hosts()[static_cast<std::size_t>(sync.rank())];
}

// All ranks go on, or all stop and every different reason is said once.
bool allFine(Sync& sync, const Result<void>& mine) {
    if (sync.agree(mine.ok())) return true;
    const std::vector<std::string> reasons = sync.gatherText(mine.ok() ? "" : mine.error().message);
    if (sync.rank() != 0) return false;
    for (const std::string& reason : std::set<std::string>(reasons.begin(), reasons.end()))
        if (!reason.empty()) std::fprintf(stderr, "iwalk-server: %s\n", reason.c_str());
    return false;
}

Result<void> readWall(ServerOptions& options, const Sync& sync) {
    RETURN_IF_ERROR(readWallFile(options));
    if (options.wall.tiles.size() == static_cast<std::size_t>(sync.size())) return {};
    return fail("{} has {} tiles, but there are {} ranks: start mpirun -np {}", options.wallFile,
                options.wall.tiles.size(), sync.size(), options.wall.tiles.size());
}

Result<void> readInputs(ServerOptions& options, Dataset& dataset, const Sync& sync) {
    RETURN_IF_ERROR(readWall(options, sync));
    ASSIGN_OR_RETURN(dataset, openDataset(options.dataset));
    return {};
}

// Copies of a dataset on several hosts can differ; a shared one can change while it is opened.
Result<void> compareDatasets(const ServerOptions& options, const Dataset& dataset, Sync& sync) {
    const Result<std::uint64_t> mark = datasetMark(options.dataset);
    // All ranks come here.
    const std::vector<std::string> notes = sync.gatherText(datasetNote(mark ? *mark : 0, options.dataset));
    if (!mark) return mark.error();
    RETURN_IF_ERROR(sameDataset(notes, sync.hosts()));
    ASSIGN_OR_RETURN(const Manifest now, loadManifest(options.dataset));
    if (now.generation == dataset.manifest.generation) return {};
    return fail("{} changed while it was opened: start again", options.dataset);
}

// From here on rank i draws tile i.
Result<void> placeRanks(const Wall& wall, Sync& sync) {
    const std::vector<std::string> hosts = sync.hosts();
    ASSIGN_OR_RETURN(const std::vector<std::size_t> tiles, tilesOfRanks(wall, hosts));
    sync.renumber(static_cast<int>(tiles[static_cast<std::size_t>(sync.rank())]));
    return {};
}

protocol::Welcome makeWelcome(const ServerOptions& options, const Dataset& dataset,
                              const std::vector<std::string>& hosts) {
    protocol::Welcome welcome;
    welcome.serverVersion = kVersion;
    welcome.datasetTriangles = dataset.manifest.triangles;
    welcome.datasetBytes = dataset.bytes;
    welcome.bounds = dataset.manifest.bounds;
    if (options.wall.freeScreens.empty()) {
        welcome.wallWidth = options.wall.width;
        welcome.wallHeight = options.wall.height;
    }
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
    std::unique_ptr<TileOutput> output;
    std::unique_ptr<TilePipeline> pipeline;
    std::unique_ptr<Gateway> gateway;
};

// Of the ranks on this host; Open MPI says so.
std::size_t localRank() {
    const char* rank = std::getenv("OMPI_COMM_WORLD_LOCAL_RANK");
    return rank ? static_cast<std::size_t>(std::strtoul(rank, nullptr, 10)) : 0;
}

// The GL that draws the tile, and the way to whoever looks at it.
Result<void> prepareOutput(Rank& rank, const ServerOptions& options, std::size_t number) {
    Tile tile = options.wall.tiles[number];
    if (options.pattern != Pattern::none && options.pattern != Pattern::blend) tile.blend = {};
    WallWindow* shown = nullptr;
    if (options.window) {
        ASSIGN_OR_RETURN(std::unique_ptr<WallWindow> window,
                         WallWindow::open(tile, options.wall.windowPlace(number)));
        shown = window.get();
        rank.gl = std::move(window);
    } else {
        ASSIGN_OR_RETURN(rank.gl, GlContext::createHeadless(localRank()));
    }
    ASSIGN_OR_RETURN(rank.output, TileOutput::create(tile, shown));
    return {};
}

Result<void> prepare(Rank& rank, const ServerOptions& options, const Dataset& dataset, const Sync& sync) {
    const auto number = static_cast<std::size_t>(sync.rank());
    RETURN_IF_ERROR(prepareOutput(rank, options, number));
    ASSIGN_OR_RETURN(rank.pipeline, TilePipeline::create(dataset, options.wall, number, options.settings));
    if (sync.rank() != 0) return {};
    std::string token;
    if (!options.tokenFile.empty()) {
        ASSIGN_OR_RETURN(token, readToken(options.tokenFile));
    }
    ASSIGN_OR_RETURN(rank.gateway, Gateway::listen(options.address, options.port,
                                                   makeWelcome(options, dataset, sync.hosts()), token));
    return {};
}

// Which host draws what, and why.
void announceTiles(const Wall& wall, const std::vector<std::string>& hosts) {
    const auto named = [](const Tile& tile) { return !tile.host.empty(); };
    const bool byHost = std::any_of(wall.tiles.begin(), wall.tiles.end(), named);
    std::string tiles;
    for (std::size_t i = 0; i < hosts.size(); ++i)
        tiles += fmt::format("{}{} on {}", i > 0 ? ", " : "", wall.tiles[i].name, hosts[i]);
    std::printf("iwalk-server: tiles %s: %s\n", byHost ? "by the wall file's hosts" : "by rank",
                tiles.c_str());
}

void announce(const ServerOptions& options, const Dataset& dataset, const Rank& rank,
              const std::vector<std::string>& hosts, bool swapGroup) {
    std::printf("iwalk-server: %s: %llu triangles, %s; %s\n", options.dataset.c_str(),
                static_cast<unsigned long long>(dataset.manifest.triangles),
                formatBytes(dataset.bytes).c_str(), rank.gl->renderer().c_str());
    announceTiles(options.wall, hosts);
    if (swapGroup) std::printf("iwalk-server: the windows swap together (NV_swap_group)\n");
    const Wall& wall = options.wall;
    const std::string size = wall.freeScreens.empty()
                                 ? fmt::format("{}x{} px", wall.width, wall.height)
                                 : fmt::format("{} free screens", wall.freeScreens.size());
    std::printf("iwalk-server: wall of %s on %zu tiles, listening on %s:%u\n", size.c_str(),
                wall.tiles.size(), options.address.c_str(), rank.gateway->port());
    std::fflush(stdout);
}

int serve(Sync& sync, ServerOptions& options) {
    Dataset dataset;
    if (!allFine(sync, readInputs(options, dataset, sync))) return EXIT_FAILURE;
    if (!allFine(sync, compareDatasets(options, dataset, sync))) return EXIT_FAILURE;
    if (!allFine(sync, placeRanks(options.wall, sync))) return EXIT_FAILURE;
    logTo(fmt::format("iwalk-server: rank {} on {}", sync.rank(), hostOf(sync)));
    LastState last(sync.rank() == 0 ? options.resumeFile : "", options.settings);
    const LastState::Known begin = last.load();
    options.settings = begin.settings;
    Rank rank;
    if (!allFine(sync, prepare(rank, options, dataset, sync))) return EXIT_FAILURE;
    const SwapGroup together(rank.output->swapGroupDriver(), [&](bool mine) { return sync.agree(mine); });
    if (sync.rank() == 0) announce(options, dataset, rank, sync.hosts(), together.joined());
    runFrames({sync, *rank.pipeline, *rank.output, rank.gateway.get(),
               options.wall.tiles[static_cast<std::size_t>(sync.rank())].name, options.outputDirectory, last,
               begin.camera, dataset, options.wall, options.settings, stopRequested});
    return EXIT_SUCCESS;
}

int servePattern(Sync& sync, ServerOptions& options) {
    if (!allFine(sync, readWall(options, sync))) return EXIT_FAILURE;
    if (!allFine(sync, placeRanks(options.wall, sync))) return EXIT_FAILURE;
    const auto number = static_cast<std::size_t>(sync.rank());
    Rank rank;
    if (!allFine(sync, prepareOutput(rank, options, number))) return EXIT_FAILURE;
    const std::string file =
        options.window ? "" : tileFile(options.outputDirectory, 0, options.wall.tiles[number].name);
    const Result<void> shown =
        showPattern({sync, *rank.output, drawPattern(options.pattern, options.wall, number, hostOf(sync)),
                     file, stopRequested});
    return allFine(sync, shown) ? EXIT_SUCCESS : EXIT_FAILURE;
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
    Result<std::unique_ptr<Sync>> sync = startMpi(argc, argv, options.startTimeout);
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // no rank outlives its launcher
    if (!sync) {
        std::fprintf(stderr, "iwalk-server: %s\n", sync.error().message.c_str());
        return EXIT_FAILURE;
    }
    return options.pattern == Pattern::none ? serve(**sync, options) : servePattern(**sync, options);
}
