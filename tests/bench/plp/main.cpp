// iwalk-plp-bench: how many pixels are right in mode plp, by budget and by the way to choose, along a path
// through a dataset; and what choosing costs. Markdown on standard output, JSON with --json. A pixel is right
// when its owner in the complete picture is drawn; with --colors the papers' measure, too: pictures of the
// server's own pipeline, pixels of equal colour.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "server/draw/gl_context.hpp"
#include "server/frame/tile_counters.hpp"
#include "tests/bench/plp/methods.hpp"
#include "tests/server/wall_renders.hpp"

namespace {

using namespace iwalk;
using namespace iwalk::bench;
using nlohmann::json;

struct Options {
    std::string dataset, path, json;
    int frames = 60, width = 1024, height = 768;
    std::vector<int> tiles{1, 4};
    std::vector<std::uint64_t> budgets{35000, 70000, 140000, 280000};
    double rays = Settings().plpRays;
    unsigned threads = 1;
    bool alone = false, colors = false;
};

// `frames` cameras on straight lines between those of the path, evenly.
std::vector<Camera> along(const std::vector<Camera>& path, int frames) {
    std::vector<Camera> cameras;
    for (int frame = 0; frame < frames; ++frame) {
        const double place = frames == 1 ? 0 : double(frame) * double(path.size() - 1) / (frames - 1);
        const std::size_t before = std::min(static_cast<std::size_t>(place), path.size() - 1);
        const Camera& from = path[before];
        const Camera& to = path[std::min(before + 1, path.size() - 1)];
        const double t = place - double(before);
        Camera camera = from;
        camera.eye += t * (to.eye - from.eye);
        camera.target += t * (to.target - from.target);
        cameras.push_back(camera);
    }
    return cameras;
}

struct Spread {
    double median = 0, least = 0, p10 = 0;
};

Spread spreadOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return {values[values.size() / 2], values.front(), values[values.size() / 10]};
}

// All tiles of all frames of a wall.
std::vector<std::vector<Shot>> takeShots(const Bench& bench, const Wall& wall,
                                         const std::vector<Camera>& cameras, OwnerRenders& renders) {
    const int step = bench.dataset.manifest.stepExponent;
    const double near = std::ldexp(nearPlane({}, bench.dataset.manifest), -step);
    std::vector<std::vector<Shot>> frames;
    for (const Camera& camera : cameras) {
        std::vector<std::vector<Owned>> owned = renders.draw(wall, camera);
        const ScreenProjection projection = projectScreen(wall.screens(camera.fovY)[0], camera);
        std::vector<Shot>& shots = frames.emplace_back();
        for (std::size_t tile = 0; tile < wall.tiles.size(); ++tile)
            shots.push_back({{projection, wall.tiles[tile].onScreen, LatticeEye::at(camera.eye, step), near},
                             std::move(owned[tile])});
    }
    return frames;
}

// The share of right pixels of a wall, in percent, over the frames.
Spread accuracyOf(const Method& method, const std::vector<std::vector<Shot>>& frames, std::uint64_t budget) {
    std::vector<double> shares;
    for (const std::vector<Shot>& shots : frames) {
        double correct = 0, all = 0;
        for (const Shot& shot : shots) {
            correct += static_cast<double>(correctPixels(shot, method.choose(shot, budget)));
            all += double(shot.sight.tile.width) * shot.sight.tile.height;
        }
        shares.push_back(100 * correct / all);
    }
    return spreadOf(std::move(shares));
}

// The share of pixels whose colour is that of mode frustum, in percent, over the frames; by budget.
std::vector<Spread> equalColors(const Bench& bench, const Options& options, int n,
                                const std::vector<Camera>& cameras) {
    const Wall wall = tools::wallOf(n * options.width, n * options.height, n, n);
    Settings settings;
    // One rank has all tiles of a wall, so that pages are in memory once for each budget.
    const auto servers = [&] {
        return std::make_unique<tools::WallServers>(bench.dataset, wall, settings,
                                                    ConservativeDrawing::kCostOfLooking, 1, options.threads);
    };
    settings.mode = Mode::frustum;
    const std::unique_ptr<tools::WallServers> complete = servers();
    settings.mode = Mode::plp;
    settings.plpRays = options.rays;
    std::vector<std::unique_ptr<tools::WallServers>> walls;
    for (const std::uint64_t budget : options.budgets) {
        settings.plpBudget = budget;
        walls.push_back(servers());
    }
    std::vector<std::vector<double>> shares(walls.size());
    for (const Camera& camera : cameras) {
        const tools::Picture picture = complete->draw(camera);
        for (std::size_t i = 0; i < walls.size(); ++i) {
            const tools::Comparison c = compare(picture, walls[i]->draw(camera), std::nullopt);
            shares[i].push_back(100 - 100.0 * static_cast<double>(c.color.different) /
                                          static_cast<double>(c.pixels()));
        }
    }
    std::vector<Spread> spreads;
    for (std::vector<double>& values : shares) spreads.push_back(spreadOf(std::move(values)));
    return spreads;
}

json addRow(int n, const std::string& method, std::uint64_t budget, const Spread& spread) {
    std::printf(" %.2f (%.2f) |", spread.median, spread.least);
    std::fflush(stdout);
    return {{"tiles", n * n},          {"method", method},    {"budget", budget},
            {"median", spread.median}, {"min", spread.least}, {"p10", spread.p10}};
}

json accuracy(const Bench& bench, const Options& options, int n, const std::vector<Camera>& cameras,
              const std::vector<std::vector<Shot>>& frames, OwnerRenders& renders) {
    const OriginalPlp original(bench.dataset.hierarchy, bench.cut, bench.dataset.manifest.leafTriangles);
    std::printf("\n%d tile%s of %dx%d, right pixels in %%: median (least)\n\n| chosen by |", n * n,
                n > 1 ? "s" : "", options.width, options.height);
    for (const std::uint64_t budget : options.budgets)
        std::printf(" %llu |", static_cast<unsigned long long>(budget));
    std::printf("\n| --- |");
    for (std::size_t i = 0; i < options.budgets.size(); ++i) std::printf(" --- |");
    json rows = json::array();
    const std::vector<Method> methods =
        options.alone ? std::vector{modePlp(bench, renders)} : allMethods(bench, original, renders);
    for (const Method& method : methods) {
        std::printf("\n| %s |", method.name.c_str());
        for (const std::uint64_t budget : options.budgets)
            rows.push_back(addRow(n, method.name, budget, accuracyOf(method, frames, budget)));
    }
    if (options.colors) {
        const std::string name = "`--mode plp`, equal colours";
        std::printf("\n| %s |", name.c_str());
        const std::vector<Spread> spreads = equalColors(bench, options, n, cameras);
        for (std::size_t i = 0; i < spreads.size(); ++i)
            rows.push_back(addRow(n, name, options.budgets[i], spreads[i]));
    }
    std::printf("\n");
    return rows;
}

double trianglesInView(const Bench& bench, const FrustumVisibility& visibility, const TileSight& sight) {
    const Frustum frustum = sight.frustum();
    double triangles = 0;
    for (const VisibleRanges& v : visibility.visible(bench.cut, frustum, sight.eye)) {
        const PageTable& table = bench.pages.tables[v.page];
        forRangesIn(table, v.firstRange, v.rangeCount, frustum, sight.eye,
                    [&](std::uint32_t r, const glm::dvec3&, const glm::dvec3&) {
                        triangles += table.ranges[r].indexCount / 3;
                    });
    }
    return triangles;
}

// Of all threads.
double processorMs() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

// What a tile costs, and how many triangles the ranges have that own a pixel.
json costs(const Bench& bench, const Options& options, int n, const std::vector<std::vector<Shot>>& frames) {
    const FrustumVisibility visibility(bench.dataset.hierarchy);
    const PlpVisibility plp(bench.dataset.hierarchy, options.budgets.back(), bench.raysPerPixel,
                            *bench.workers);
    const auto table = [&](std::uint32_t page) { return &bench.pages.tables[page]; };
    std::vector<double> nodes, ranges, nodesCpu, rangesCpu, perMillion, inView, owners;
    for (const std::vector<Shot>& shots : frames)
        for (const Shot& shot : shots) {
            Stopwatch watch;
            const double begin = processorMs();
            const auto candidates = plp.candidates(bench.cut, shot.sight);
            nodes.push_back(watch.lap());
            const double between = processorMs();
            plp.ranges(candidates, table, shot.sight);
            ranges.push_back(watch.lap());
            nodesCpu.push_back(between - begin);
            rangesCpu.push_back(processorMs() - between);
            inView.push_back(trianglesInView(bench, visibility, shot.sight) / 1e6);
            if (inView.back() > 0) perMillion.push_back((nodes.back() + ranges.back()) / inView.back());
            double triangles = 0;
            for (const Owned& owned : shot.owned)
                triangles += bench.pages.tables[owned.page].ranges[owned.range].indexCount / 3;
            owners.push_back(triangles);
        }
    const double megapixels = double(options.width) * options.height / 1e6;
    const auto perMegapixel = [&](const std::vector<double>& ms) { return spreadOf(ms).median / megapixels; };
    const json row{{"tiles", n * n},
                   {"nodes_ms_per_megapixel", perMegapixel(nodes)},
                   {"nodes_cpu_ms_per_megapixel", perMegapixel(nodesCpu)},
                   {"ranges_ms_per_megapixel", perMegapixel(ranges)},
                   {"ranges_cpu_ms_per_megapixel", perMegapixel(rangesCpu)},
                   {"ms_per_million_triangles_in_view", perMillion.empty() ? 0 : spreadOf(perMillion).median},
                   {"million_triangles_in_view", spreadOf(inView).median},
                   {"triangles_of_owners_median", spreadOf(owners).median},
                   {"triangles_of_owners_max", *std::max_element(owners.begin(), owners.end())}};
    std::printf("\nA tile of %d, budget %llu, %g %% rays, medians:\n\n| what | |\n| --- | --- |\n", n * n,
                static_cast<unsigned long long>(options.budgets.back()), options.rays);
    for (const auto& [key, value] : row.items())
        if (key != "tiles") std::printf("| %s | %.4g |\n", key.c_str(), value.get<double>());
    return row;
}

Result<void> run(const Options& options) {
    Bench bench;
    ASSIGN_OR_RETURN(bench.dataset, openDataset(options.dataset));
    ASSIGN_OR_RETURN(const std::vector<Camera> path, loadCameraPath(options.path));
    ASSIGN_OR_RETURN(const std::unique_ptr<GlContext> context, GlContext::createHeadless());
    bench.cut = cutAtLevel(bench.dataset.hierarchy, kFullLevel);
    ASSIGN_OR_RETURN(bench.pages, loadPages(bench.dataset, bench.cut));
    bench.cells = cellsOfNodes(bench.dataset.hierarchy);
    bench.raysPerPixel = options.rays / 100;
    bench.workers = std::make_unique<Workers>(options.threads);
    const std::vector<Camera> cameras = along(path, options.frames);

    json report{{"dataset", options.dataset},   {"triangles", bench.dataset.manifest.triangles},
                {"path", options.path},         {"frames", options.frames},
                {"rays_percent", options.rays}, {"accuracy", json::array()},
                {"costs", json::array()}};
    std::printf("%s, %d frames of %s\n", options.dataset.c_str(), options.frames, options.path.c_str());
    for (const int n : options.tiles) {
        const Wall wall = tools::wallOf(n * options.width, n * options.height, n, n);
        ASSIGN_OR_RETURN(
            const std::unique_ptr<OwnerRenders> renders,
            OwnerRenders::create(bench.dataset, bench.cut, bench.pages, wall.width, wall.height));
        const std::vector<std::vector<Shot>> frames = takeShots(bench, wall, cameras, *renders);
        for (json& row : accuracy(bench, options, n, cameras, frames, *renders))
            report["accuracy"].push_back(std::move(row));
        report["costs"].push_back(costs(bench, options, n, frames));
    }
    if (!options.json.empty()) {
        std::ofstream out(options.json);
        out << report.dump(2) << '\n';
        if (!out.flush()) return fail("cannot write {}", options.json);
    }
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("How many pixels are right in mode plp along a path, and what it costs.");
    app.option_defaults()->always_capture_default();
    app.add_option("DATASET", options.dataset, "directory that iwalk-preprocess made")->required();
    app.add_option("PATH", options.path, "camera path (JSON); cameras between its frames are made")
        ->required();
    app.add_option("--frames", options.frames, "cameras")->check(CLI::Range(1, 100000));
    app.add_option("--tiles", options.tiles, "walls of N x N tiles")->check(CLI::Range(1, 16));
    app.add_option("--width", options.width, "px of a tile")->check(CLI::Range(1, 16384));
    app.add_option("--height", options.height, "px of a tile")->check(CLI::Range(1, 16384));
    app.add_option("--budgets", options.budgets, "triangles of a tile")->check(CLI::PositiveNumber);
    app.add_option("--rays", options.rays, "as iwalk-server's --plp-rays")->check(CLI::Range(0.001, 10.0));
    app.add_option("--threads", options.threads, "of visibility")->check(CLI::Range(1u, Workers::kMost));
    app.add_flag("--alone", options.alone, "mode plp without other ways to choose");
    app.add_flag("--colors", options.colors, "count pixels of equal colour, too, as the papers do");
    app.add_option("--json", options.json, "file for all figures");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const Result<void> done = run(options);
    if (!done) std::fprintf(stderr, "iwalk-plp-bench: %s\n", done.error().message.c_str());
    return done ? 0 : 1;
}
