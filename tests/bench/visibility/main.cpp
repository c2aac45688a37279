// iwalk-visibility-bench: what conservative visibility saves and costs on a moving path, everything resident.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>

#include "server/draw/gl_context.hpp"
#include "tests/bench/visibility/bench_tile.hpp"
#include "tests/bench/visibility/bench_wall.hpp"

namespace {

using namespace iwalk;
using bench::BenchTile;
using bench::Method;
using bench::Series;

struct Options {
    std::string dataset, views;
    int frames = 10, width = 1024, height = 768, tiles = 0;
    double step = 0.001, costOfLooking = ConservativeDrawing::kCostOfLooking;
    unsigned threads = 1;
    bool slow = false;
};

// Straight ahead from a view, `step` of the model's diagonal a frame.
Camera onTheWay(Camera camera, const Manifest& manifest, double steps) {
    const double diagonal = glm::distance(manifest.bounds.min, manifest.bounds.max);
    const glm::dvec3 move = steps * diagonal * glm::normalize(camera.target - camera.eye);
    camera.eye += move;
    camera.target += move;
    return camera;
}

TileView viewOf(const Dataset& dataset, const Wall& wall, const Camera& camera) {
    TileView view;
    view.projection = projectScreen(wall.screens(camera.fovY)[0], camera);
    view.screenWidth = wall.width;
    view.screenHeight = wall.height;
    view.tile = wall.tiles[0].onScreen;
    view.eye = LatticeEye::at(camera.eye, dataset.manifest.stepExponent);
    view.near = std::ldexp(nearPlane({}, dataset.manifest), -dataset.manifest.stepExponent);
    return view;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[values.size() / 2];
}

void note(Series& series, const std::string& name, const protocol::TileStats& stats) {
    series[name + ".ms"].push_back(stats.drawMs);
    series[name + ".triangles"].push_back(static_cast<double>(stats.triangles));
    series[name + ".ranges"].push_back(static_cast<double>(stats.ranges));
    if (name == "frustum" || name == "oracle" || name == "perfect") return;
    series[name + ".walk_ms"].push_back(stats.visibilityMs);
    series[name + ".guess_ms"].push_back(stats.guessMs);
    series[name + ".guess_triangles"].push_back(static_cast<double>(stats.guessTriangles));
    series[name + ".pyramid_ms"].push_back(stats.pyramidMs);
    series[name + ".test_ms"].push_back(stats.testMs);
    series[name + ".hidden_pages"].push_back(static_cast<double>(stats.hiddenPages));
    series[name + ".hidden_ranges"].push_back(static_cast<double>(stats.hiddenRanges));
}

struct Tiles {
    BenchTile frustum, hzb, queries, items, oracle;
    Tiles(const Dataset& dataset, const PixelRect& rect, unsigned threads)
        : frustum(dataset, rect, Method::frustum, 1),
          hzb(dataset, rect, Method::hzb, threads),
          queries(dataset, rect, Method::queries, 1),
          items(dataset, rect, Method::items, 1),
          oracle(dataset, rect, Method::frustum, 1) {}
};

// All methods draw each frame one after the other, so that they share what else the machine does.
void drawFrame(Tiles& tiles, const TileView& view, const Options& options, Series& series) {
    const std::vector<VisibleRanges> all = tiles.frustum.inFrustum(view);
    note(series, "frustum", tiles.frustum.drawRanges(view, all));
    const std::vector<VisibleRanges> perfect = tiles.frustum.notHidden(view);
    tiles.frustum.packOwners(tiles.oracle);
    note(series, "hzb", tiles.hzb.draw(view));
    if (options.slow) note(series, "queries", tiles.queries.draw(view));
    if (options.slow) note(series, "items", tiles.items.draw(view));
    note(series, "perfect", tiles.frustum.drawRanges(view, perfect));
    note(series, "oracle", tiles.oracle.drawPacked(view));
}

void print(std::size_t view, const Series& series) {
    std::printf("{\"view\": %zu", view);
    for (const auto& [name, values] : series) std::printf(", \"%s\": %.6g", name.c_str(), median(values));
    std::printf("}\n");
    std::fflush(stdout);
}

// Calls draw(camera, series) for the frames of each view.
template <class Draw>
void fly(const Options& options, const Manifest& manifest, const std::vector<Camera>& views,
         const Draw& draw) {
    for (std::size_t v = 0; v < views.size(); ++v) {
        Series series;
        for (int frame = -2; frame < options.frames; ++frame) {
            Series unused;
            draw(onTheWay(views[v], manifest, frame * options.step), frame < 0 ? unused : series);
        }
        print(v, series);
    }
}

Result<void> run(const Options& options) {
    ASSIGN_OR_RETURN(const Dataset dataset, openDataset(options.dataset));
    ASSIGN_OR_RETURN(const std::vector<Camera> views, loadCameraPath(options.views));
    ASSIGN_OR_RETURN(const std::unique_ptr<GlContext> context, GlContext::createHeadless());
    if (options.tiles > 0) {
        bench::BenchWall wall(dataset, options.width, options.height, options.tiles, options.costOfLooking,
                              options.threads);
        fly(options, dataset.manifest, views,
            [&](const Camera& camera, Series& series) { wall.drawFrame(camera, series); });
        return {};
    }
    const Wall wall = tools::wallOf(options.width, options.height, 1, 1);
    Tiles tiles(dataset, wall.tiles[0].onScreen, options.threads);
    fly(options, dataset.manifest, views, [&](const Camera& camera, Series& series) {
        drawFrame(tiles, viewOf(dataset, wall, camera), options, series);
    });
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app(
        "Flies straight ahead from each view. Prints one JSON object a view with medians: frame times (ms), "
        "triangles "
        "and ranges drawn, times of the stages, by method: frustum, hzb, queries and items (item buffer), "
        "perfect "
        "(what the frame's own depth leaves at the grain of ranges), oracle (triangles that own a pixel). "
        "With "
        "--tiles the servers' modes on a wall instead.");
    app.option_defaults()->always_capture_default();
    app.add_option("DATASET", options.dataset, "directory that iwalk-preprocess made")->required();
    app.add_option("VIEWS", options.views, "camera path (JSON), each frame a view to begin at")->required();
    app.add_option("--frames", options.frames, "frames a view, behind two that are not counted");
    app.add_option("--step", options.step, "way from frame to frame, in diagonals of the model");
    app.add_option("--width", options.width, "px of a tile; without --tiles at most 1024");
    app.add_option("--height", options.height, "px of a tile; likewise");
    app.add_option("--tiles", options.tiles,
                   "N: a wall of N x N tiles, drawn one after the other in modes frustum, cplp and plp; sums")
        ->check(CLI::Range(1, 16));
    app.add_option("--cost-of-looking", options.costOfLooking,
                   "with --tiles: triangles a pixel that must be hidden for cplp to look for them; 0: always")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--threads", options.threads, "of visibility")->check(CLI::Range(1u, Workers::kMost));
    app.add_flag("--slow", options.slow, "with queries and items, too");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const Result<void> done = run(options);
    if (!done) std::fprintf(stderr, "iwalk-visibility-bench: %s\n", done.error().message.c_str());
    return done ? 0 : 1;
}
