// iwalk-visibility-check: flies through a dataset with conservative visibility and without any, and says how
// many pixels differ in any way.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "server/draw/gl_context.hpp"
#include "tests/server/flight.hpp"
#include "tests/server/wall_renders.hpp"

namespace {

using namespace iwalk;

struct Options {
    std::string dataset, path, cache = "2G", level = "full", near = "0", up = "z";
    std::vector<std::string> occlusions = {"hzb"};
    std::vector<int> tiles = {1};
    int frames = 200, first = 0, width = 1024, height = 768;
};

Result<Settings> settingsOf(const Options& options, const std::string& mode, const std::string& occlusion) {
    Settings settings;
    RETURN_IF_ERROR(setSetting(settings, "mode", mode));
    RETURN_IF_ERROR(setSetting(settings, "occlusion", occlusion));
    RETURN_IF_ERROR(setSetting(settings, "cache", options.cache));
    RETURN_IF_ERROR(setSetting(settings, "level", options.level));
    RETURN_IF_ERROR(setSetting(settings, "near", options.near));
    return settings;
}

// The servers of one wall with cplp, and what was seen of them.
class Flight {
  public:
    Flight(const Dataset& dataset, const Options& options, int tiles, Settings settings,
           const std::string& occlusion)
        : name_(fmt::format("{0}x{0} tiles, {1}", tiles, occlusion)),
          wall_(tools::wallOf(options.width, options.height, tiles, tiles)),
          servers_(dataset, wall_, settings) {}

    void compareFrame(std::size_t frame, const Camera& camera, const tools::Picture& all) {
        const tools::Comparison comparison = compare(all, servers_.draw(camera), std::nullopt);
        pixels_ += comparison.different;
        frames_ += comparison.different > 0;
        triangles_ += servers_.stats().triangles;
        if (comparison.different == 0) return;
        fmt::print("{}: frame {}: {} pixels differ, {} of them in colour\n", name_, frame,
                   comparison.different, comparison.color.different);
        std::fflush(stdout);
    }
    void report(std::uint64_t allTriangles) const {
        fmt::print("{}: {} pixels differ in {} frames; triangles drawn {:.4f} of all\n", name_, pixels_,
                   frames_, static_cast<double>(triangles_) / static_cast<double>(allTriangles));
    }
    bool exact() const { return pixels_ == 0; }

  private:
    const std::string name_;
    const Wall wall_;
    tools::WallServers servers_;
    std::uint64_t frames_ = 0, pixels_ = 0, triangles_ = 0;
};

Result<std::vector<Camera>> pathOf(const Options& options, const Dataset& dataset) {
    if (!options.path.empty()) return loadCameraPath(options.path);
    const glm::dvec3 up = options.up == "y" ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    return tools::flight(dataset.manifest.bounds, options.frames, up);
}

Result<bool> check(const Options& options) {
    ASSIGN_OR_RETURN(const Settings frustum, settingsOf(options, "frustum", "hzb"));
    ASSIGN_OR_RETURN(const Dataset dataset, openDataset(options.dataset));
    ASSIGN_OR_RETURN(const std::vector<Camera> path, pathOf(options, dataset));
    ASSIGN_OR_RETURN(const std::unique_ptr<GlContext> context, GlContext::createHeadless());
    const Wall whole = tools::wallOf(options.width, options.height, 1, 1);
    tools::WallServers all(dataset, whole, frustum);
    std::vector<std::unique_ptr<Flight>> flights;
    for (const std::string& occlusion : options.occlusions)
        for (const int tiles : options.tiles) {
            ASSIGN_OR_RETURN(Settings settings, settingsOf(options, "cplp", occlusion));
            settings.cacheBytes /= static_cast<std::uint64_t>(tiles * tiles);
            flights.push_back(std::make_unique<Flight>(dataset, options, tiles, settings, occlusion));
        }
    std::uint64_t triangles = 0;
    for (std::size_t i = static_cast<std::size_t>(options.first); i < path.size(); ++i) {
        const tools::Picture picture = all.draw(path[i]);
        triangles += all.stats().triangles;
        for (const std::unique_ptr<Flight>& flight : flights) flight->compareFrame(i, path[i], picture);
    }
    fmt::print("{} frames of {}x{} px\n", path.size() - static_cast<std::size_t>(options.first),
               options.width, options.height);
    bool exact = true;
    for (const std::unique_ptr<Flight>& flight : flights) {
        flight->report(triangles);
        exact = exact && flight->exact();
    }
    return exact;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app(
        "Draws a path with cplp, on tiles, and without, as one picture. Exit code 0: not one pixel differs.");
    app.option_defaults()->always_capture_default();
    app.add_option("DATASET", options.dataset, "directory that iwalk-preprocess made")->required();
    app.add_option("--path", options.path, "camera path (JSON); without it, a flight through the model");
    app.add_option("--frames", options.frames, "frames of the flight");
    app.add_option("--first", options.first, "frame to begin with");
    app.add_option("--up", options.up, "the model's axis that points up")->check(CLI::IsMember({"y", "z"}));
    app.add_option("--width", options.width, "px of the whole picture");
    app.add_option("--height", options.height, "px of the whole picture");
    app.add_option("--tiles", options.tiles, "walls of N x N tiles")
        ->delimiter(',')
        ->check(CLI::Range(1, 64));
    app.add_option("--occlusion", options.occlusions, "as iwalk-server's; several: each on every wall")
        ->delimiter(',');
    app.add_option("--cache", options.cache, "bytes for pages, which the tiles of a wall share");
    app.add_option("--level", options.level, "as iwalk-server's");
    app.add_option("--near", options.near, "as iwalk-server's");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const Result<bool> good = check(options);
    if (!good) std::fprintf(stderr, "iwalk-visibility-check: %s\n", good.error().message.c_str());
    return !good ? 2 : *good ? 0 : 1;
}
