// iwalk-tile-check: draws views of a dataset as one tile and as many, and says how many pixels differ in any
// way.

#include <CLI/CLI.hpp>
#include <cstdio>

#include "server/draw/gl_context.hpp"
#include "tests/server/wall_renders.hpp"

namespace {

using namespace iwalk;

struct Options {
    std::string dataset, views, cache = "1G", near = "0";
    int width = 2048, height = 1536, columns = 4, rows = 4;
};

Result<bool> check(const Options& options) {
    Settings settings;
    RETURN_IF_ERROR(setSetting(settings, "cache", options.cache));
    RETURN_IF_ERROR(setSetting(settings, "near", options.near));
    ASSIGN_OR_RETURN(const Dataset dataset, openDataset(options.dataset));
    ASSIGN_OR_RETURN(const std::vector<Camera> views, loadCameraPath(options.views));
    ASSIGN_OR_RETURN(const std::unique_ptr<GlContext> context, GlContext::createHeadless());
    const Wall one = tools::wallOf(options.width, options.height, 1, 1);
    const Wall many = tools::wallOf(options.width, options.height, options.columns, options.rows);
    bool good = true;
    for (std::size_t i = 0; i < views.size(); ++i) {
        tools::WallRenders renders(dataset, settings);
        const tools::Picture whole = renders.draw(one, views[i]);
        const tools::Comparison comparison = compare(whole, renders.draw(many, views[i]), std::nullopt);
        std::printf(
            "view %zu: %llu of %llu pixels differ, %llu of them in colour, by %d of 255 at the most\n", i,
            static_cast<unsigned long long>(comparison.different),
            static_cast<unsigned long long>(comparison.pixels()),
            static_cast<unsigned long long>(comparison.color.different), comparison.color.largestDifference);
        good = good && comparison.different == 0;
    }
    return good;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("Draws views as one tile and as many. Exit code 0: not one pixel differs.");
    app.option_defaults()->always_capture_default();
    app.add_option("DATASET", options.dataset, "directory that iwalk-preprocess made")->required();
    app.add_option("VIEWS", options.views, "camera path (JSON)")->required();
    app.add_option("--width", options.width, "px of the whole picture");
    app.add_option("--height", options.height, "px of the whole picture");
    app.add_option("--columns", options.columns, "tiles side by side");
    app.add_option("--rows", options.rows, "tiles on top of one another");
    app.add_option("--cache", options.cache, "bytes for pages, as iwalk-server's");
    app.add_option("--near", options.near, "distance of the near plane, as iwalk-server's");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const Result<bool> good = check(options);
    if (!good) std::fprintf(stderr, "iwalk-tile-check: %s\n", good.error().message.c_str());
    return !good ? 2 : *good ? 0 : 1;
}
