#include "tests/gateway/raw_client.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace iwalk::testing {

RawClient::RawClient(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval patience{30, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    const int yes = 1;
    ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
}

RawClient::RawClient(RawClient&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

void RawClient::close() {
    if (socket_ >= 0) ::close(std::exchange(socket_, -1));
}

bool RawClient::sendBytes(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) return false;
        bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
    return true;
}

bool RawClient::readBytes(std::span<std::byte> out) {
    while (!out.empty()) {
        const ssize_t got = ::recv(socket_, out.data(), out.size(), 0);
        EXPECT_FALSE(got < 0 && errno == EAGAIN) << "the server said nothing for 30 seconds";
        if (got <= 0) return false;
        out = out.subspan(static_cast<std::size_t>(got));
    }
    return true;
}

std::optional<protocol::Message> RawClient::receive() {
    std::array<std::byte, protocol::kHeaderBytes> bytes{};
    if (!readBytes(bytes)) return std::nullopt;
    const auto header = protocol::decodeHeader(bytes, protocol::kMaxServerPayload);
    EXPECT_TRUE(header.ok());
    if (!header) return std::nullopt;
    std::vector<std::byte> payload(header->payloadBytes);
    if (!readBytes(payload)) return std::nullopt;
    auto message = protocol::decodePayload(*header, payload);
    EXPECT_TRUE(message.ok()) << (message.ok() ? "" : message.error().message);
    if (!message) return std::nullopt;
    return *message;
}

bool RawClient::greet(bool control) {
    EXPECT_TRUE(send(protocol::Hello{protocol::kVersion, control}));
    const auto welcome = receive();
    EXPECT_TRUE(welcome && std::holds_alternative<protocol::Welcome>(*welcome));
    const auto granted = receiveA<protocol::Control>();
    EXPECT_TRUE(granted);
    return granted && granted->granted;
}

bool RawClient::sendCamera(std::uint64_t sequence, std::uint8_t flags) {
    protocol::CameraRequest request;
    request.sequence = sequence;
    request.flags = flags;
    request.camera.eye.x = request.camera.target.x = static_cast<double>(sequence);
    return send(request);
}

protocol::Welcome smallWall() {
    protocol::Welcome welcome;
    welcome.serverVersion = "9.8.7";
    welcome.datasetTriangles = 123;
    welcome.datasetBytes = 4567;
    welcome.bounds.add(glm::dvec3(-1));
    welcome.bounds.add(glm::dvec3(1));
    welcome.wallWidth = 36;
    welcome.wallHeight = 8;
    welcome.tiles = {{"left", "host-a", 0, 0, 0, 16, 8}, {"right", "host-b", 1, 20, 0, 16, 8}};
    welcome.settings = {{"cache", "1G"}, {"mode", "cplp"}};
    return welcome;
}

}  // namespace iwalk::testing
