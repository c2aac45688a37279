#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>

#include "common/result.hpp"

namespace iwalk {

// How hosts come together: over TCP, each with one connection to the hub, so that who waits sleeps until the
// kernel wakes it. One process of a host speaks for it. Errors are lost connections: after one, no more.
class HostLinks {
  public:
    static constexpr std::size_t kMostInvitation = 1023;
    using IdleWork = std::function<void()>;  // done every millisecond of a wait; may be empty

    // The hub: listens at all addresses of this host. The result is for the guests alone: where they find the
    // hub, and how each knows the other; at most kMostInvitation characters.
    Result<std::string> invite();
    // The hub, after invite(): returns when all of these have joined.
    Result<void> welcome(std::span<const int> guests, std::chrono::milliseconds within);
    // A guest, `number` of those: connects to the first of the hub's addresses where the hub answers.
    Result<void> join(const std::string& invitation, int number, std::chrono::milliseconds within);

    // The hub: returns when all guests have come to follow(), after giving them these bytes.
    Result<void> lead(std::span<const std::byte> bytes, const IdleWork& idle);
    // A guest: returns after the hub's lead() with its bytes. As many as it gives are asked for.
    Result<void> follow(std::span<std::byte> bytes, const IdleWork& idle);

  private:
    using Clock = std::chrono::steady_clock;
    using Socket = boost::asio::ip::tcp::socket;
    struct Link {
        Socket socket;
        std::string name;  // of the host at its other end
    };
    struct Stranger;

    void accept();
    void hear(Socket socket);
    bool knock(const boost::asio::ip::tcp::endpoint& hub, const std::string& hello, Clock::time_point end);
    void keep(int number, Socket socket);
    Result<void> receive(Link& from, std::span<std::byte> bytes, const IdleWork& idle);
    Result<void> send(Link& to, std::span<const std::byte> bytes);

    boost::asio::io_context io_{1};
    boost::asio::ip::tcp::acceptor door_{io_};
    std::string question_, answer_;  // what a guest says first, and what the hub says to it
    std::map<int, Link> links_;      // the hub's: by guest; a guest's: 0, the hub
};

}  // namespace iwalk
