#include "server/frame/pattern_wall.hpp"

#include <epoxy/gl.h>

#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>

#include "common/file.hpp"
#include "server/draw/gl_objects.hpp"

namespace iwalk {
namespace {

GLuint upload(const ColorImage& picture) {
    const GLuint texture = makeTexture(GL_RGBA8, picture.width, picture.height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture, 0, 0, 0, picture.width, picture.height, GL_RGB, GL_UNSIGNED_BYTE,
                        picture.pixels.data());
    return texture;
}

Result<void> write(const std::string& file, const ColorImage& picture) {
    std::error_code ignored;
    std::filesystem::create_directories(std::filesystem::path(file).parent_path(), ignored);
    ASSIGN_OR_RETURN(const std::vector<std::byte> png, encodePng(picture));
    return replaceFile(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

// Until somebody closes a window, or rank 0 is told to stop.
void stay(const PatternWallParts& parts) {
    const auto lookAfterWindows = [&] {
        for (const PatternTile& tile : parts.tiles)
            if (tile.output.closed()) parts.sync.askToStop();
    };
    parts.sync.setIdleWork(lookAfterWindows);
    if (parts.sync.rank() == 0)
        while (!parts.stop && !parts.sync.askedToStop()) {
            lookAfterWindows();
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    FrameState state;
    state.command = FrameState::quit;
    parts.sync.broadcast(state);
    parts.sync.setIdleWork({});
}

}  // namespace

Result<void> showPattern(const PatternWallParts& parts) {
    for (const PatternTile& tile : parts.tiles) tile.output.prepare(upload(tile.picture));
    parts.sync.barrier();
    for (const PatternTile& tile : parts.tiles) tile.output.show();
    for (const PatternTile& tile : parts.tiles)
        if (!tile.file.empty()) RETURN_IF_ERROR(write(tile.file, tile.output.read()));
    if (parts.tiles.at(0).file.empty()) stay(parts);
    return {};
}

}  // namespace iwalk
