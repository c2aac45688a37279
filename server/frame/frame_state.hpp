#pragma once

#include <cstdint>
#include <type_traits>

#include "common/settings.hpp"

namespace iwalk {

// What every tile must agree on in a frame; rank 0 makes it and broadcasts it as it is.
struct FrameState {
    static constexpr std::uint32_t kMagic = 0x53465749;  // "IWFS"
    static constexpr std::uint32_t kVersion = 3;
    // preview: of what was drawn last; meet: all come to the barrier, as a sign of life.
    enum Command : std::uint32_t { draw = 0, quit = 1, preview = 2, meet = 3 };
    static constexpr std::uint32_t kPreview = 1u << 8;  // among the flags: send a small picture, too

    std::uint32_t magic = kMagic;
    std::uint32_t version = kVersion;
    std::uint32_t command = draw;
    std::uint32_t flags = 0;                         // protocol::FrameFlags: what is captured for the client
    std::uint64_t frame = 0;                         // counts from 0
    std::uint64_t sequence = 0;                      // of the request, for its answer
    double eye[3] = {}, target[3] = {}, up[3] = {};  // model units
    double fovY = 0;                                 // degrees, of the whole wall
    double near = 0;                                 // model units
    Settings settings;
};
static_assert(std::is_trivially_copyable_v<FrameState>);

}  // namespace iwalk
