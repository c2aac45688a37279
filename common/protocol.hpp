#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "common/camera_path.hpp"
#include "common/geometry.hpp"
#include "common/result.hpp"

// What client and server say to each other over TCP (docs/protocol.md). Little-endian, length-prefixed:
//   u32 payload bytes, u16 type, u16 zero, payload
// Strings are u16 length and UTF-8 bytes, arrays u32 count and items. A receiver checks the length against
// its limit before it allocates anything.
namespace iwalk::protocol {

inline constexpr std::uint32_t kVersion = 4;
inline constexpr std::size_t kHeaderBytes = 8;
inline constexpr std::uint32_t kMaxClientPayload = 1024;        // client to server
inline constexpr std::uint32_t kMaxServerPayload = 512u << 20;  // server to client (an image of a large tile)
inline constexpr std::uint32_t kMaxTiles = 4096;
inline constexpr std::uint32_t kMaxSettings = 4096;
inline constexpr std::size_t kMaxStringBytes = 4096;
inline constexpr std::int32_t kMaxTilePx = 32768;
inline constexpr std::int32_t kMaxWallPx = 1 << 24;

// Client to server, first: who I am. The server answers with Welcome or Failure. Sent again later it changes
// `control` alone: false hands control over to the next in line, true asks for it again.
struct Hello {
    std::uint32_t version = kVersion;
    bool control = true;   // wants to steer; false: only watches
    bool preview = false;  // wants small pictures of the wall
    std::string token{};   // the secret that a server beyond the loopback asks for; else empty
};

enum FrameFlags : std::uint8_t {
    kLockstep = 1,      // draw this camera, whatever else is waiting; without it the newest wins
    kCaptureColor = 2,  // send the tiles of this frame as PNG
    kCaptureDepth = 4,  // and their depth as EXR
};

// Client to server: the camera of a frame. Only the controller's count.
struct CameraRequest {
    std::uint64_t sequence = 0;  // the client's own number, from 1, returned with the frame
    std::uint8_t flags = 0;      // FrameFlags
    Camera camera;
};

struct TileInfo {
    std::string name, host;
    std::uint32_t rank = 0;
    std::int32_t x = 0, y = 0, width = 0, height = 0;  // px of the wall, from its top left corner
};

struct NamedValue {
    std::string name, value;
};

// Server to client, first.
struct Welcome {
    std::uint32_t version = kVersion;
    std::string serverVersion;
    std::uint64_t datasetTriangles = 0, datasetBytes = 0;
    ModelBox bounds;  // model units
    std::int32_t wallWidth = 0,
                 wallHeight = 0;  // px, bezels included; 0 x 0: free screens, no common rectangle
    std::vector<TileInfo> tiles;
    std::vector<NamedValue> settings;  // every run-time setting
};

// Client to server: other values for settings. Only the controller's count; all of them or, if one is wrong,
// none.
struct ChangeSettings {
    std::vector<NamedValue> settings;
};

// Server to client: the settings from the next frame on, whenever they changed; and to a client whose
// ChangeSettings was refused.
struct SettingsNow {
    std::vector<NamedValue> settings;  // all of them
    std::string refusal;               // why nothing was changed; else empty
};

// Server to client: whether this client steers; sent after Welcome and whenever it changes.
struct Control {
    bool granted = false;
    std::uint32_t waiting = 0;  // clients that wait to take over
};

// What a tile did in a frame. Times in ms; bytes as read from disk.
struct TileStats {
    std::uint32_t tile = 0;
    double visibilityMs = 0, adaptMs = 0, fetchWaitMs = 0, drawMs = 0, barrierWaitMs = 0;
    double guessMs = 0;                       // part of drawMs: what is drawn first
    double pyramidMs = 0, testMs = 0;         // parts of visibilityMs: looking at the depth, testing boxes
    std::uint64_t triangles = 0, ranges = 0;  // drawn
    std::uint64_t guessTriangles = 0;         // of these, drawn first
    std::uint64_t hiddenPages = 0,
                  hiddenRanges = 0;  // in the frustum, tested, and hidden; ranges of other pages
    double screenErrorPx = 0;
    std::uint64_t fetchedBytes = 0, prefetchedBytes = 0, stalls = 0;
    std::uint64_t badPages = 0;  // pages left out of this frame because they could not be read
    std::uint64_t peakRssBytes = 0;
    // Of the pixels that show a surface: how far a twentieth of them are at most, and half of them. Model
    // units along the view; 0 where no surface is.
    double nearDepth = 0, midDepth = 0;
};

// Server to client: a frame is on the wall.
struct FrameDone {
    std::uint64_t sequence = 0;  // of the receiver's own request; 0: somebody else's
    std::uint64_t frame = 0;     // the server's own count
    double timeMs = 0;           // from the swap before to this one
    std::vector<TileStats> tiles;
    Camera camera{};         // that the wall shows
    double sinceSwapMs = 0;  // from this swap to the sending of this message, >= 0
};

enum class ImageKind : std::uint8_t { png = 0, exr = 1, preview = 2 };

// Server to client: a captured tile; comes after its FrameDone or before it. A preview is a JPEG of any size,
// to whoever wants them.
struct TileImage {
    std::uint64_t sequence = 0;  // of a preview: the same for all tiles of a picture of the wall
    std::uint32_t tile = 0;      // index into Welcome::tiles
    ImageKind kind = ImageKind::png;
    std::vector<std::byte> bytes;
};

// Either way: why the connection ends.
struct Failure {
    std::string reason;
};

// New types come at the end, and Hello keeps its version first: so other releases can still be told why not.
using Message = std::variant<Hello, CameraRequest, Welcome, Control, FrameDone, TileImage, Failure,
                             ChangeSettings, SettingsNow>;

// Header and payload, ready to send. Strings are cut to kMaxStringBytes and what is no text in them becomes
// '?'; numbers that no receiver takes (NaN, over a limit) are our own bug.
std::vector<std::byte> encode(const Message& message);

struct Header {
    std::uint32_t payloadBytes = 0;
    std::uint16_t type = 0;
};
// Fails on an unknown type, a nonzero reserved field, or a payload over `limit`.
Result<Header> decodeHeader(std::span<const std::byte, kHeaderBytes> bytes, std::uint32_t limit);
// Fails on a payload that is too short, too long, or holds what cannot be (NaN, counts over the limits).
Result<Message> decodePayload(const Header& header, std::span<const std::byte> payload);

}  // namespace iwalk::protocol
