// What a client may say: to the decoder, and over a socket to a gateway, whose state it must not break.
#include "common/protocol.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <thread>

#include "server/gateway/gateway.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace iwalk;
using Bytes = std::span<const std::byte>;

protocol::Welcome wall() {
    protocol::Welcome welcome;
    welcome.bounds.add(glm::dvec3(0));
    welcome.tiles = {{"tile", "host", 0, 0, 0, 16, 8}};
    for (const SettingInfo& setting : settingTable())
        welcome.settings.push_back({setting.name, settingText(Settings(), setting.name)});
    return welcome;
}

Gateway& gateway() {
    static const std::unique_ptr<Gateway> door = Gateway::listen("127.0.0.1", 0, wall()).value();
    return *door;
}

// What is accepted can be said again, and then is the same.
void decode(Bytes rest, std::uint32_t limit) {
    while (rest.size() >= protocol::kHeaderBytes) {
        const auto header = protocol::decodeHeader(rest.first<protocol::kHeaderBytes>(), limit);
        if (!header) return;
        rest = rest.subspan(protocol::kHeaderBytes);
        const Bytes payload = rest.first(std::min<std::size_t>(rest.size(), header->payloadBytes));
        rest = rest.subspan(payload.size());
        const auto message = protocol::decodePayload(*header, payload);
        if (!message) continue;
        const std::vector<std::byte> again = protocol::encode(*message);
        CHECK_OP(again.size(), ==, protocol::kHeaderBytes + payload.size());
        CHECK(std::equal(payload.begin(), payload.end(), again.begin() + protocol::kHeaderBytes));
    }
}

// From another address of the loopback each time, since each connection keeps its port for a while.
int connectToGateway() {
    static std::uint32_t count = 0;
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    const auto at = [](std::uint32_t address, std::uint16_t port) {
        sockaddr_in place{};
        place.sin_family = AF_INET;
        place.sin_addr.s_addr = htonl(address);
        place.sin_port = htons(port);
        return place;
    };
    constexpr std::uint32_t kFirst = 0x7f000002, kAddresses = 1u << 20;
    const sockaddr_in from = at(kFirst + count++ % kAddresses, 0), to = at(INADDR_LOOPBACK, gateway().port());
    CHECK_OP(::bind(socket, reinterpret_cast<const sockaddr*>(&from), sizeof from), ==, 0);
    // libFuzzer's timer may interrupt it.
    while (::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
        CHECK_OP(errno, ==, EINTR);
    return socket;
}

// Draws what is asked for. Every answer is in order, or the message before the end.
void draw() {
    while (const auto request = gateway().nextRequest()) {
        CHECK(checkCamera(request->camera).ok());
        gateway().frameDone({request->sequence, 1, 1, {{}}, request->camera});
    }
    if (const auto settings = gateway().newSettings()) CHECK(checkSettings(*settings).ok());
}

void say(Bytes bytes) {
    const int socket = connectToGateway();
    std::size_t sent = 0;
    std::vector<std::byte> heard(64u << 10);
    for (bool open = true; open; draw()) {
        const ssize_t some =
            ::send(socket, bytes.data() + sent, bytes.size() - sent, MSG_DONTWAIT | MSG_NOSIGNAL);
        if (some > 0) sent += static_cast<std::size_t>(some);
        if (sent == bytes.size()) ::shutdown(socket, SHUT_WR);
        const ssize_t got = ::recv(socket, heard.data(), heard.size(), MSG_DONTWAIT);
        open = got > 0 || (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK));
        if (got < 0 && open) std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
    ::close(socket);
}

std::string text(const std::vector<protocol::Message>& messages) {
    std::string all;
    for (const protocol::Message& message : messages) {
        const std::vector<std::byte> bytes = protocol::encode(message);
        all.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const Bytes bytes = std::as_bytes(std::span(data, size));
    decode(bytes, protocol::kMaxServerPayload);
    say(bytes);
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    using namespace protocol;
    const CameraRequest one{1, 0, {}}, two{2, kLockstep | kCaptureColor | kCaptureDepth, {}};
    return {text({Hello{}, one, two, ChangeSettings{{{"mode", "plp"}, {"max-fps", "30"}}}, one}),
            text({Hello{kVersion, false, true, "token"}, ChangeSettings{{{"mode", "plp"}}},
                  Hello{kVersion, true, false, ""}, Failure{"gr\xc3\xbcn"}}),
            text({wall(), FrameDone{1, 2, 3.5, {{}, {}}}, Control{true, 3}}),
            text({TileImage{1, 0, ImageKind::exr, std::vector<std::byte>(50)},
                  SettingsNow{{{"near", "1"}}, "no"}})};
}
