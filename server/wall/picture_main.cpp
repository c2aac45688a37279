// iwalk-wall-picture: what scripts/check-wall runs.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>

#include "common/file.hpp"
#include "common/version.hpp"
#include "server/wall/wall_picture.hpp"

namespace {

using namespace iwalk;

constexpr int kWidth = 1600, kHeight = 1000;  // px

Result<void> draw(const std::string& file, const std::string& picture) {
    ASSIGN_OR_RETURN(const Wall wall, loadWall(file));
    std::fputs(describeWall(wall).c_str(), stdout);
    ASSIGN_OR_RETURN(const std::vector<std::byte> png, encodePng(drawWall(wall, kWidth, kHeight)));
    return replaceFile(picture, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Checks a wall file, says what it means, and draws it.");
    app.set_version_flag("--version", std::string("iwalk-wall-picture ") + kVersion);
    std::string file, picture;
    app.add_option("wall", file, "Wall file to check")->required()->type_name("WALL.toml");
    app.add_option("picture", picture, "File to write")->required()->type_name("OUT.png");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        std::fprintf(stderr, "iwalk-wall-picture: %s (see --help)\n", error.what());
        return 2;
    }
    const Result<void> drawn = draw(file, picture);
    if (drawn) return EXIT_SUCCESS;
    std::fprintf(stderr, "iwalk-wall-picture: %s\n", drawn.error().message.c_str());
    return EXIT_FAILURE;
}
