#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/options.hpp"
#include "common/protocol.hpp"
#include "common/result.hpp"

namespace iwalk::client {

// The client's end of the connection. One thread: the socket is read within receive() only.
class ServerLink {
  public:
    using Clock = std::chrono::steady_clock;

    // Connects, trying again until `deadline` (a server may still be loading), and greets with `hello`.
    // Errors name the server.
    static Result<std::unique_ptr<ServerLink>> connect(const Address& server, const protocol::Hello& hello,
                                                       Clock::time_point deadline);

    const protocol::Welcome& welcome() const { return welcome_; }

    // Blocks until the message is handed to the network.
    Result<void> send(const protocol::Message& message);
    // The next message, or nothing at `deadline` (what has arrived by then is returned even when it is past).
    // An error when the server ends the connection, with its reason if it gave one. Nothing, too, when
    // wake() was called.
    Result<std::optional<protocol::Message>> receive(Clock::time_point deadline);
    // Ends a receive(), the one under way or the next. From any thread.
    void wake();

  private:
    explicit ServerLink(const Address& server);
    Result<void> reach(const Address& server, Clock::time_point deadline);
    Result<void> greet(const protocol::Hello& hello, Clock::time_point deadline);
    boost::system::error_code tryConnect(const boost::asio::ip::tcp::resolver::results_type& endpoints,
                                         Clock::time_point deadline);
    void readHeader();
    void readPayload();
    void finish(Result<protocol::Message> message);
    bool runUntil(Clock::time_point deadline, const bool& done);

    std::string name_;  // host:port
    boost::asio::io_context io_{1};
    boost::asio::ip::tcp::socket socket_{io_};
    protocol::Welcome welcome_;

    bool reading_ = false, arrived_ = false, ready_ = false;  // ready_: to return from receive()
    std::optional<Result<protocol::Message>> message_;        // when arrived_
    std::array<std::byte, protocol::kHeaderBytes> headerBytes_{};
    protocol::Header header_;
    std::vector<std::byte> payload_;
    std::size_t payloadRead_ = 0;
};

}  // namespace iwalk::client
