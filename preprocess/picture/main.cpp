// iwalk-octree-picture: what `iwalk-preprocess info --draw` becomes.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>

#include "common/dataset/hierarchy.hpp"
#include "common/file.hpp"
#include "common/version.hpp"
#include "preprocess/picture/octree_picture.hpp"

namespace {

using namespace iwalk;

constexpr int kWidth = 1600, kHeight = 1200;  // px

Result<void> draw(const std::string& dataset, const std::string& path) {
    ASSIGN_OR_RETURN(const OctreePicture picture, drawOctree(dataset, kWidth, kHeight));
    ASSIGN_OR_RETURN(const std::vector<std::byte> png, encodePng(picture.image));
    RETURN_IF_ERROR(replaceFile(path, {reinterpret_cast<const char*>(png.data()), png.size()}));
    const std::string level = picture.level == kFullLevel ? "full" : std::to_string(picture.level);
    fmt::print(stderr, "{}: the model at level {}, leaves of depth {} to {}\n", path, level,
               picture.shallowest, picture.deepest);
    return {};
}

int run(int argc, char** argv) {
    CLI::App app("Draws a dataset's model and octree; see iwalk-preprocess info --draw.");
    app.set_version_flag("--version", std::string("iwalk-octree-picture ") + kVersion);
    std::string dataset, path;
    app.add_option("dataset", dataset, "Directory of the dataset")->required()->type_name("DATASET");
    app.add_option("picture", path, "File to write")->required()->type_name("OUT.png");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "iwalk-octree-picture: {} (see --help)\n", error.what());
        return 2;
    }
    const Result<void> drawn = draw(dataset, path);
    if (drawn) return EXIT_SUCCESS;
    fmt::print(stderr, "iwalk-preprocess: {}\n", drawn.error().message);
    return EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "iwalk-preprocess: {}\n", error.what());
        return EXIT_FAILURE;
    }
}
