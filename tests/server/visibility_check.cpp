// iwalk-visibility-check: flies through a dataset with conservative visibility and without any, and says how
// many pixels differ in any way.

#include <CLI/CLI.hpp>
#include <cstdio>

#include "server/draw/gl_context.hpp"
#include "tests/server/flight.hpp"
#include "tests/server/wall_renders.hpp"

namespace {

using namespace iwalk;

struct Options {
    std::string dataset, path, occlusion = "hzb", cache = "2G", level = "full", near = "0", up = "z";
    int frames = 200, first = 0, width = 1024, height = 768, columns = 1, rows = 1;
};

Result<Settings> settingsOf(const Options& options, const std::string& mode) {
    Settings settings;
    RETURN_IF_ERROR(setSetting(settings, "mode", mode));
    RETURN_IF_ERROR(setSetting(settings, "occlusion", options.occlusion));
    RETURN_IF_ERROR(setSetting(settings, "cache", options.cache));
    RETURN_IF_ERROR(setSetting(settings, "level", options.level));
    RETURN_IF_ERROR(setSetting(settings, "near", options.near));
    return settings;
}

Result<std::vector<Camera>> pathOf(const Options& options, const Dataset& dataset) {
    if (!options.path.empty()) return loadCameraPath(options.path);
    const glm::dvec3 up = options.up == "y" ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    return tools::flight(dataset.manifest.bounds, options.frames, up);
}

Result<bool> check(const Options& options) {
    ASSIGN_OR_RETURN(const Settings frustum, settingsOf(options, "frustum"));
    ASSIGN_OR_RETURN(const Settings cplp, settingsOf(options, "cplp"));
    ASSIGN_OR_RETURN(const Dataset dataset, openDataset(options.dataset));
    ASSIGN_OR_RETURN(const std::vector<Camera> path, pathOf(options, dataset));
    ASSIGN_OR_RETURN(const std::unique_ptr<GlContext> context, GlContext::createHeadless());
    const Wall whole = tools::wallOf(options.width, options.height, 1, 1);
    const Wall tiles = tools::wallOf(options.width, options.height, options.columns, options.rows);
    tools::WallServers all(dataset, whole, frustum), some(dataset, tiles, cplp);
    std::uint64_t frames = 0, wrongFrames = 0, wrongPixels = 0, allTriangles = 0, someTriangles = 0;
    for (std::size_t i = static_cast<std::size_t>(options.first); i < path.size(); ++i) {
        const tools::Comparison comparison = compare(all.draw(path[i]), some.draw(path[i]), std::nullopt);
        ++frames;
        wrongPixels += comparison.different;
        wrongFrames += comparison.different > 0;
        allTriangles += all.stats().triangles;
        someTriangles += some.stats().triangles;
        if (comparison.different == 0) continue;
        std::printf("frame %zu: %llu pixels differ, %llu of them in colour\n", i,
                    static_cast<unsigned long long>(comparison.different),
                    static_cast<unsigned long long>(comparison.color.different));
        std::fflush(stdout);
    }
    std::printf(
        "%llu frames of %dx%d px on %dx%d tiles: %llu pixels differ in %llu frames; triangles drawn %.4f of "
        "all\n",
        static_cast<unsigned long long>(frames), options.width, options.height, options.columns, options.rows,
        static_cast<unsigned long long>(wrongPixels), static_cast<unsigned long long>(wrongFrames),
        static_cast<double>(someTriangles) / static_cast<double>(allTriangles));
    return wrongPixels == 0;
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
    app.add_option("--columns", options.columns, "tiles side by side");
    app.add_option("--rows", options.rows, "tiles on top of one another");
    app.add_option("--occlusion", options.occlusion, "as iwalk-server's");
    app.add_option("--cache", options.cache, "bytes for pages, as iwalk-server's");
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
