#include "tests/bench/visibility/bench_wall.hpp"

#include <ctime>

#include "server/frame/tile_counters.hpp"

namespace iwalk::bench {
namespace {

Settings inMode(Mode mode) {
    Settings settings;
    settings.mode = mode;
    return settings;
}

double processorMs() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

void draw(const std::string& name, tools::WallServers& servers, const Camera& camera, Series& series) {
    Stopwatch watch;
    const double before = processorMs();
    servers.drawOnly(camera);
    series[name + ".ms"].push_back(watch.lap());
    series[name + ".cpu_ms"].push_back(processorMs() - before);
    const protocol::TileStats& stats = servers.stats();
    series[name + ".triangles"].push_back(static_cast<double>(stats.triangles));
    if (name == "frustum") return;
    series[name + ".visibility_ms"].push_back(stats.visibilityMs);
    series[name + ".pyramid_ms"].push_back(stats.pyramidMs);
    series[name + ".test_ms"].push_back(stats.testMs);
}

}  // namespace

BenchWall::BenchWall(const Dataset& dataset, int width, int height, int n, double costOfLooking,
                     unsigned threads)
    : wall_(tools::wallOf(n * width, n * height, n, n)),
      frustum_(dataset, wall_, inMode(Mode::frustum), costOfLooking, 1),
      cplp_(dataset, wall_, inMode(Mode::cplp), costOfLooking, 1, threads),
      plp_(dataset, wall_, inMode(Mode::plp), costOfLooking, 1, threads) {}

void BenchWall::drawFrame(const Camera& camera, Series& series) {
    draw("frustum", frustum_, camera, series);
    draw("cplp", cplp_, camera, series);
    draw("plp", plp_, camera, series);
}

}  // namespace iwalk::bench
