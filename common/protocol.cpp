#include "common/protocol.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>
#include <type_traits>

namespace iwalk::protocol {
namespace {

// Bytes of the character that `text` begins with; 0 for what is not UTF-8 or is a control character, which
// would let a peer write into terminals and logs.
std::size_t characterBytes(std::string_view text) {
    const auto byte = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
    };
    const unsigned first = byte(0);
    if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
    const std::size_t count = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    std::uint32_t code = first & (0xffu >> (count + 1));
    for (std::size_t i = 1; i < count; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return 0;
        code = code << 6 | (byte(i) & 0x3f);
    }
    constexpr std::uint32_t kSmallest[] = {0, 0, 0xa0, 0x800, 0x10000};  // 0x80 to 0x9f are controls
    const bool surrogate = code >= 0xd800 && code < 0xe000;
    return first >= 0xc0 && first < 0xf8 && code >= kSmallest[count] && code <= 0x10ffff && !surrogate ? count
                                                                                                       : 0;
}

bool validText(std::string_view text) {
    while (!text.empty()) {
        const std::size_t bytes = characterBytes(text);
        if (bytes == 0) return false;
        text.remove_prefix(bytes);
    }
    return true;
}

// `text` as it can be sent: what is not text becomes ?, what is too long is cut.
std::string sendable(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t bytes = characterBytes(text);
        if (out.size() + std::max<std::size_t>(bytes, 1) > kMaxStringBytes) break;
        out += bytes == 0 ? std::string_view("?") : text.substr(0, bytes);
        text.remove_prefix(std::max<std::size_t>(bytes, 1));
    }
    return out;
}

// Appends little-endian values. Reader has the same functions, so that one description of a message serves
// both.
class Writer {
  public:
    explicit Writer(std::vector<std::byte>& out) : out_(out) {}

    template <class T>
    void integer(T value, T least, T greatest) {
        CHECK_OP(value, >=, least);
        CHECK_OP(value, <=, greatest);
        put(static_cast<std::make_unsigned_t<T>>(value));
    }
    template <class T>
    void integer(T value) {
        put(static_cast<std::make_unsigned_t<T>>(value));
    }
    void version(std::uint32_t value) { put(value); }
    void flag(bool value) { put(static_cast<std::uint8_t>(value)); }
    void real(double value) {
        CHECK(std::isfinite(value));
        put(std::bit_cast<std::uint64_t>(value));
    }
    void text(const std::string& value) {
        const std::string fit = sendable(value);
        put(static_cast<std::uint16_t>(fit.size()));
        raw(std::as_bytes(std::span(fit)));
    }
    void blob(const std::vector<std::byte>& value) {
        put(static_cast<std::uint32_t>(value.size()));
        raw(value);
    }
    template <class Item, class Each>
    void array(const std::vector<Item>& items, std::size_t most, std::size_t, Each each) {
        CHECK_OP(items.size(), <=, most);
        put(static_cast<std::uint32_t>(items.size()));
        for (const Item& item : items) each(item);
    }
    void require(bool fine, const char* what) {
        if (!fine) detail::checkFailed(__FILE__, __LINE__, what);
    }

  private:
    template <class T>
    void put(T value) {
        for (std::size_t i = 0; i < sizeof(T); ++i)
            out_.push_back(static_cast<std::byte>((value >> 8 * i) & 0xff));
    }
    void raw(std::span<const std::byte> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }

    std::vector<std::byte>& out_;
};

// Takes little-endian values from the front of a payload. After the first error all values are zero or empty.
class Reader {
  public:
    explicit Reader(std::span<const std::byte> payload) : rest_(payload) {}

    template <class T>
    void integer(T& value, T least, T greatest) {
        integer(value);
        require(value >= least && value <= greatest, "a number is out of range");
    }
    template <class T>
    void integer(T& value) {
        value = static_cast<T>(get<std::make_unsigned_t<T>>());
    }
    // First of all: of another version not even the layout of what follows is known.
    void version(std::uint32_t& value) {
        integer(value);
        if (ok() && value != kVersion) {
            error_ = fmt::format(
                "the other side speaks version {} of the protocol, this side version {}: use a "
                "client and a server of the same release",
                value, kVersion);
        }
    }
    void flag(bool& value) {
        const auto byte = get<std::uint8_t>();
        require(byte <= 1, "a flag is neither 0 nor 1");
        value = byte == 1;
    }
    void real(double& value) {
        value = std::bit_cast<double>(get<std::uint64_t>());
        require(std::isfinite(value), "a number is not finite");
    }
    void text(std::string& value) {
        const std::size_t bytes = get<std::uint16_t>();
        require(bytes <= kMaxStringBytes, "a text is too long");
        const auto taken = take(bytes);
        value.assign(reinterpret_cast<const char*>(taken.data()), taken.size());
        require(validText(value), "a text is not UTF-8 or has control characters");
    }
    void blob(std::vector<std::byte>& value) {
        const auto taken = take(get<std::uint32_t>());
        value.assign(taken.begin(), taken.end());
    }
    // Allocates only when `count` items of at least `itemBytes` each can be in what is left.
    template <class Item, class Each>
    void array(std::vector<Item>& items, std::size_t most, std::size_t itemBytes, Each each) {
        const std::size_t count = get<std::uint32_t>();
        require(count <= most && count <= rest_.size() / itemBytes, "more items than there can be");
        if (!ok()) return;
        items.resize(count);
        for (Item& item : items) each(item);
    }
    void require(bool fine, const char* what) {
        if (ok() && !fine) error_ = what;
    }
    void end() { require(rest_.empty(), "bytes after the end of the message"); }

    bool ok() const { return error_.empty(); }
    const std::string& error() const { return error_; }

  private:
    std::span<const std::byte> take(std::size_t bytes) {
        require(bytes <= rest_.size(), "the message ends too early");
        if (!ok()) return {};
        const auto taken = rest_.first(bytes);
        rest_ = rest_.subspan(bytes);
        return taken;
    }
    template <class T>
    T get() {
        T value = 0;
        const auto taken = take(sizeof(T));
        for (std::size_t i = 0; i < taken.size(); ++i) {
            value = static_cast<T>(value | static_cast<T>(std::to_integer<std::uint64_t>(taken[i]) << 8 * i));
        }
        return value;
    }

    std::span<const std::byte> rest_;
    std::string error_;
};

// The fields of every message in the order of docs/protocol.md. M is const when Io writes.
template <class Io, class Vector>
void vectorFields(Io& io, Vector& v) {
    io.real(v.x), io.real(v.y), io.real(v.z);
}

template <class Io, class M>
void tileInfoFields(Io& io, M& m) {
    io.text(m.name), io.text(m.host), io.integer(m.rank);
    io.integer(m.x), io.integer(m.y);
    io.integer(m.width, 1, kMaxTilePx), io.integer(m.height, 1, kMaxTilePx);
}
constexpr std::size_t kMinTileInfoBytes = 2 + 2 + 4 + 4 * 4;

template <class Io, class M>
void tileStatsFields(Io& io, M& m) {
    io.integer(m.tile, std::uint32_t{0}, kMaxTiles - 1);
    io.real(m.visibilityMs), io.real(m.adaptMs), io.real(m.fetchWaitMs), io.real(m.drawMs),
        io.real(m.barrierWaitMs);
    io.real(m.guessMs), io.real(m.pyramidMs), io.real(m.testMs);
    io.integer(m.triangles), io.integer(m.ranges), io.integer(m.guessTriangles);
    io.integer(m.hiddenPages), io.integer(m.hiddenRanges), io.real(m.screenErrorPx);
    io.integer(m.fetchedBytes), io.integer(m.prefetchedBytes), io.integer(m.stalls), io.integer(m.badPages);
    io.integer(m.peakRssBytes), io.real(m.nearDepth), io.real(m.midDepth);
}
constexpr std::size_t kTileStatsBytes = 4 + 21 * 8;

template <class Io, class M>
void cameraFields(Io& io, M& m) {
    vectorFields(io, m.eye), vectorFields(io, m.target), vectorFields(io, m.up), io.real(m.fovY);
    const Result<void> camera = checkCamera(m);
    io.require(camera.ok(), camera.ok() ? "" : camera.error().message.c_str());
}

template <class Io, class M>
void settingsFields(Io& io, M& settings) {
    io.array(settings, kMaxSettings, 2 + 2,
             [&](auto& setting) { io.text(setting.name), io.text(setting.value); });
}

// Constness of the message is what tells writing from reading here.
template <class T, class M>
concept Is = std::is_same_v<std::remove_const_t<T>, M>;

void fields(auto& io, Is<Hello> auto& m) {
    io.version(m.version), io.flag(m.control), io.flag(m.preview), io.text(m.token);
}

void fields(auto& io, Is<CameraRequest> auto& m) {
    constexpr std::uint8_t kAllFlags = kLockstep | kCaptureColor | kCaptureDepth;
    io.integer(m.sequence), io.integer(m.flags, std::uint8_t{0}, kAllFlags);
    io.require(m.sequence != 0, "sequence number 0");  // stands for somebody else's frame in FrameDone
    cameraFields(io, m.camera);
}

void fields(auto& io, Is<Welcome> auto& m) {
    io.version(m.version), io.text(m.serverVersion);
    io.integer(m.datasetTriangles), io.integer(m.datasetBytes);
    vectorFields(io, m.bounds.min), vectorFields(io, m.bounds.max);
    io.integer(m.wallWidth, 0, kMaxWallPx), io.integer(m.wallHeight, 0, kMaxWallPx);
    io.array(m.tiles, kMaxTiles, kMinTileInfoBytes, [&](auto& tile) { tileInfoFields(io, tile); });
    settingsFields(io, m.settings);
}

void fields(auto& io, Is<Control> auto& m) {
    io.flag(m.granted), io.integer(m.waiting);
}

void fields(auto& io, Is<FrameDone> auto& m) {
    io.integer(m.sequence), io.integer(m.frame), io.real(m.timeMs), io.real(m.sinceSwapMs);
    io.require(m.sinceSwapMs >= 0, "a negative time");
    cameraFields(io, m.camera);
    io.array(m.tiles, kMaxTiles, kTileStatsBytes, [&](auto& tile) { tileStatsFields(io, tile); });
}

void fields(Writer& io, const TileImage& m) {
    io.integer(m.sequence), io.integer(m.tile, std::uint32_t{0}, kMaxTiles - 1);
    io.integer(static_cast<std::uint8_t>(m.kind)), io.blob(m.bytes);
}
void fields(Reader& io, TileImage& m) {
    std::uint8_t kind = 0;
    io.integer(m.sequence), io.integer(m.tile, std::uint32_t{0}, kMaxTiles - 1);
    io.integer(kind, std::uint8_t{0}, std::uint8_t{2}), io.blob(m.bytes);
    m.kind = static_cast<ImageKind>(kind);
}

void fields(auto& io, Is<Failure> auto& m) {
    io.text(m.reason);
}

void fields(auto& io, Is<ChangeSettings> auto& m) {
    settingsFields(io, m.settings);
}

void fields(auto& io, Is<SettingsNow> auto& m) {
    settingsFields(io, m.settings), io.text(m.refusal);
}

// A message's type on the wire is its place in the variant, from 1.
constexpr std::size_t kTypes = std::variant_size_v<Message>;
static_assert(std::is_same_v<std::variant_alternative_t<0, Message>, Hello>);
static_assert(std::is_same_v<std::variant_alternative_t<6, Message>, Failure>);

template <std::size_t Index = 0>
Message emptyMessage(std::size_t index) {
    if constexpr (Index + 1 < kTypes) {
        if (index != Index) return emptyMessage<Index + 1>(index);
    }
    return Message(std::in_place_index<Index>);
}

constexpr const char* kTypeNames[kTypes] = {"Hello",   "CameraRequest",  "Welcome",
                                            "Control", "FrameDone",      "TileImage",
                                            "Failure", "ChangeSettings", "SettingsNow"};

}  // namespace

std::vector<std::byte> encode(const Message& message) {
    std::vector<std::byte> out(kHeaderBytes);
    if (const auto* image = std::get_if<TileImage>(&message)) out.reserve(image->bytes.size() + 64);
    Writer writer(out);
    std::visit([&](const auto& m) { fields(writer, m); }, message);

    const std::size_t payload = out.size() - kHeaderBytes;
    CHECK_OP(payload, <=, kMaxServerPayload);
    std::vector<std::byte> header;
    Writer headerWriter(header);
    headerWriter.integer(static_cast<std::uint32_t>(payload));
    headerWriter.integer(static_cast<std::uint16_t>(message.index() + 1));
    headerWriter.integer(std::uint16_t{0});
    std::copy(header.begin(), header.end(), out.begin());
    return out;
}

Result<Header> decodeHeader(std::span<const std::byte, kHeaderBytes> bytes, std::uint32_t limit) {
    Reader reader(bytes);
    Header header;
    std::uint16_t reserved = 0;
    reader.integer(header.payloadBytes), reader.integer(header.type), reader.integer(reserved);
    if (header.type < 1 || header.type > kTypes || reserved != 0) return fail("this is not iWalk's protocol");
    if (header.payloadBytes > limit) {
        return fail("a message of {} bytes; the limit is {}", header.payloadBytes, limit);
    }
    return header;
}

Result<Message> decodePayload(const Header& header, std::span<const std::byte> payload) {
    if (header.type < 1 || header.type > kTypes) return fail("a message of unknown type {}", header.type);
    const std::size_t index = header.type - std::size_t{1};
    if (payload.size() != header.payloadBytes)
        return fail("{}: the message ends too early", kTypeNames[index]);

    Message message = emptyMessage(index);
    Reader reader(payload);
    std::visit([&](auto& m) { fields(reader, m); }, message);
    reader.end();
    if (!reader.ok()) return fail("{}: {}", kTypeNames[index], reader.error());
    return message;
}

}  // namespace iwalk::protocol
