// iwalk-server: each MPI rank draws one or more tiles of the wall.

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <thread>

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
    if (options.wall.tiles.size() >= static_cast<std::size_t>(sync.size())) return {};
    return fail("{} has {} tiles, but there are {} ranks: start mpirun -np {}, or fewer", options.wallFile,
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

// Tiles by rank.
using Shares = std::vector<std::vector<std::size_t>>;

// From here on ranks are numbered by their first tiles.
Result<void> placeRanks(const Wall& wall, Sync& sync, Shares& shares) {
    ASSIGN_OR_RETURN(shares, tilesOfRanks(wall, sync.hosts()));
    const std::vector<std::size_t> mine = shares[static_cast<std::size_t>(sync.rank())];
    std::sort(shares.begin(), shares.end());
    std::vector<int> counts;
    for (const auto& share : shares) counts.push_back(static_cast<int>(share.size()));
    const auto number = std::find(shares.begin(), shares.end(), mine) - shares.begin();
    sync.renumber(static_cast<int>(number), counts);
    return {};
}

protocol::Welcome makeWelcome(const ServerOptions& options, const Dataset& dataset, const Shares& shares,
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
    welcome.tiles.resize(options.wall.tiles.size());
    for (std::size_t rank = 0; rank < shares.size(); ++rank)
        for (const std::size_t i : shares[rank]) {
            const Tile& tile = options.wall.tiles[i];
            const PixelRect& rect = tile.onWall;
            welcome.tiles[i] = {tile.name,  hosts[rank], static_cast<std::uint32_t>(rank), rect.x, rect.y,
                                rect.width, rect.height};
        }
    for (const SettingInfo& setting : settingTable())
        welcome.settings.push_back({setting.name, settingText(options.settings, setting.name)});
    return welcome;
}

// What a rank holds while it runs; made in this order, taken down in reverse.
struct Rank {
    std::unique_ptr<GlContext> gl;
    std::vector<std::unique_ptr<TileOutput>> outputs;  // of its tiles
    std::unique_ptr<RankTiles> tiles;
    std::unique_ptr<Gateway> gateway;
};

// What Open MPI says; 0 without it.
unsigned long fromMpi(const char* name) {
    const char* number = std::getenv(name);
    return number ? std::strtoul(number, nullptr, 10) : 0;
}

// Of the ranks on this host.
std::size_t localRank() {
    return fromMpi("OMPI_COMM_WORLD_LOCAL_RANK");
}

// This rank's part of the cores.
unsigned visibilityThreads() {
    const auto ranks = static_cast<unsigned>(std::max(1ul, fromMpi("OMPI_COMM_WORLD_LOCAL_SIZE")));
    return std::clamp(std::thread::hardware_concurrency() / ranks, 1u, Workers::kMost);
}

// The GL that draws the tiles, and the way to whoever looks at them.
Result<void> prepareOutputs(Rank& rank, const ServerOptions& options,
                            const std::vector<std::size_t>& numbers) {
    std::vector<WallWindows::Place> places;
    for (const std::size_t number : numbers)
        places.push_back({options.wall.tiles[number], options.wall.windowPlace(number)});
    WallWindows* shown = nullptr;
    if (options.window) {
        ASSIGN_OR_RETURN(std::unique_ptr<WallWindows> windows, WallWindows::open(places));
        shown = windows.get();
        rank.gl = std::move(windows);
    } else {
        ASSIGN_OR_RETURN(rank.gl, GlContext::createHeadless(localRank()));
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
        Tile& tile = places[i].tile;
        if (options.pattern != Pattern::none && options.pattern != Pattern::blend) tile.blend = {};
        ASSIGN_OR_RETURN(std::unique_ptr<TileOutput> output,
                         TileOutput::create(tile, shown ? &shown->window(i) : nullptr));
        rank.outputs.push_back(std::move(output));
    }
    return {};
}

Result<void> prepare(Rank& rank, const ServerOptions& options, const Dataset& dataset, const Shares& shares,
                     const Sync& sync) {
    const std::vector<std::size_t>& mine = shares[static_cast<std::size_t>(sync.rank())];
    RETURN_IF_ERROR(prepareOutputs(rank, options, mine));
    ASSIGN_OR_RETURN(rank.tiles, RankTiles::create(dataset, options.wall, mine, options.settings,
                                                   ConservativeDrawing::kCostOfLooking, visibilityThreads()));
    if (sync.rank() != 0) return {};
    std::string token;
    if (!options.tokenFile.empty()) {
        ASSIGN_OR_RETURN(token, readToken(options.tokenFile));
    }
    ASSIGN_OR_RETURN(rank.gateway,
                     Gateway::listen(options.address, options.port,
                                     makeWelcome(options, dataset, shares, sync.hosts()), token));
    return {};
}

// Who draws what, and why.
void announceTiles(const Wall& wall, const Shares& shares, const std::vector<std::string>& hosts) {
    const auto named = [](const Tile& tile) { return !tile.host.empty(); };
    const bool byHost = std::any_of(wall.tiles.begin(), wall.tiles.end(), named);
    std::string text;
    for (std::size_t rank = 0; rank < shares.size(); ++rank) {
        for (const std::size_t tile : shares[rank])
            text += fmt::format("{}{}", text.empty() ? "" : ", ", wall.tiles[tile].name);
        text += fmt::format(" on {}", hosts[rank]);
        if (shares.size() < wall.tiles.size()) text += fmt::format(" (rank {})", rank);
    }
    std::printf("iwalk-server: tiles %s: %s\n", byHost ? "by the wall file's hosts" : "by rank",
                text.c_str());
}

void announce(const ServerOptions& options, const Dataset& dataset, const Rank& rank, const Shares& shares,
              const std::vector<std::string>& hosts, bool swapGroup) {
    std::printf("iwalk-server: %s: %llu triangles, %s; %s\n", options.dataset.c_str(),
                static_cast<unsigned long long>(dataset.manifest.triangles),
                formatBytes(dataset.bytes).c_str(), rank.gl->renderer().c_str());
    announceTiles(options.wall, shares, hosts);
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
    Shares shares;
    if (!allFine(sync, placeRanks(options.wall, sync, shares))) return EXIT_FAILURE;
    logTo(fmt::format("iwalk-server: rank {} on {}", sync.rank(), hostOf(sync)));
    LastState last(sync.rank() == 0 ? options.resumeFile : "", options.settings);
    const LastState::Known begin = last.load();
    options.settings = begin.settings;
    Rank rank;
    if (!allFine(sync, prepare(rank, options, dataset, shares, sync))) return EXIT_FAILURE;
    // One rank's windows cannot all wait for one another.
    SwapGroupDriver* const driver = rank.outputs.size() == 1 ? rank.outputs[0]->swapGroupDriver() : nullptr;
    const SwapGroup together(driver, [&](bool mine) { return sync.agree(mine); });
    if (sync.rank() == 0) announce(options, dataset, rank, shares, sync.hosts(), together.joined());
    runFrames({sync, shares[static_cast<std::size_t>(sync.rank())], *rank.tiles, rank.outputs,
               rank.gateway.get(), options.outputDirectory, last, begin.camera, dataset, options.wall,
               options.settings, stopRequested});
    return EXIT_SUCCESS;
}

int servePattern(Sync& sync, ServerOptions& options) {
    Shares shares;
    if (!allFine(sync, readWall(options, sync))) return EXIT_FAILURE;
    if (!allFine(sync, placeRanks(options.wall, sync, shares))) return EXIT_FAILURE;
    const std::vector<std::size_t>& mine = shares[static_cast<std::size_t>(sync.rank())];
    Rank rank;
    if (!allFine(sync, prepareOutputs(rank, options, mine))) return EXIT_FAILURE;
    std::vector<PatternTile> tiles;
    for (std::size_t i = 0; i < mine.size(); ++i)
        tiles.push_back(
            {*rank.outputs[i],
             drawPattern(options.pattern, options.wall, mine[i], {sync.rank(), sync.size(), hostOf(sync)}),
             options.window ? "" : tileFile(options.outputDirectory, 0, options.wall.tiles[mine[i]].name)});
    const Result<void> shown = showPattern({sync, std::move(tiles), stopRequested});
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
    std::signal(SIGUSR1, requestStop);  // mpirun passes it on, and does not kill soon after
    std::signal(SIGPIPE, SIG_IGN);
    Result<std::unique_ptr<Sync>> sync = startMpi(argc, argv, options.startTimeout);
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // no rank outlives its launcher
    if (!sync) {
        std::fprintf(stderr, "iwalk-server: %s\n", sync.error().message.c_str());
        return EXIT_FAILURE;
    }
    return options.pattern == Pattern::none ? serve(**sync, options) : servePattern(**sync, options);
}
