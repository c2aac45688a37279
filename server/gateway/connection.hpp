#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "common/protocol.hpp"
#include "server/gateway/requests.hpp"

namespace iwalk {

// One client's socket: bytes in, whole valid messages out, and the other way round. Knows limits and
// deadlines, not what messages mean. Lives on the gateway's thread; its pending operations keep it alive
// until the socket is closed.
class Connection : public std::enable_shared_from_this<Connection> {
  public:
    using Buffer =
        std::shared_ptr<const std::vector<std::byte>>;  // an encoded message, shared by its receivers

    struct Limits {
        std::uint64_t unsentBytes = 0;
        std::chrono::milliseconds helloTimeout{0};  // from start() to greeted()
        std::chrono::milliseconds stallTimeout{0};  // without a byte taken while some wait
    };

    class Owner {
      public:
        virtual ~Owner() = default;
        // False: read no more until resumeReading().
        virtual bool received(Connection& connection, const protocol::Message& message) = 0;
        // Once, when no more messages come or go; also from within send(). `fault`: the client misbehaved.
        virtual void ended(Connection& connection, const std::string& reason, bool fault) = 0;
    };

    // `owner` outlives the io_context's run. `slot` is held until the socket is closed, to count sockets by.
    Connection(boost::asio::ip::tcp::socket socket, SenderPtr sender, Owner& owner, const Limits& limits,
               std::shared_ptr<void> slot);

    void start();
    void greeted() { disarm(); }
    void resumeReading();
    // `counted` bytes of it are in the sender's unsentBytes already.
    void send(Buffer message, std::uint64_t counted = 0);
    // Sends `reason` as the last message as far as that goes, then closes; waits a little for the client to
    // read it.
    void refuse(const std::string& reason);
    // Closes at once.
    void close(const std::string& reason, bool fault);
    // The same at the end of the program: closes as soon as it is sent.
    void sayGoodbye(const std::string& reason);

    const SenderPtr& sender() const { return sender_; }
    const std::string& peer() const { return peer_; }  // address:port

  private:
    enum class State { open, closing, closed };

    void readHeader();
    void readPayload(const protocol::Header& header);
    void takeMessage(const protocol::Header& header);
    void discardInput();
    void sendLast(const std::string& reason);
    void writeSome();
    void wrote(const boost::system::error_code& error, std::size_t bytes);
    void dropUnsent(std::size_t keep);
    void end(const std::string& reason, bool fault);
    void closeSocket();
    void arm(std::chrono::milliseconds time, void (Connection::*late)());
    void disarm();
    void lateHello();
    void lateReader();

    boost::asio::ip::tcp::socket socket_;
    boost::asio::steady_timer
        deadline_;  // of the Hello, then of each write, then of the linger: never two at once
    SenderPtr sender_;
    Owner& owner_;
    const Limits limits_;
    std::shared_ptr<void> slot_;
    std::string peer_;
    State state_ = State::open;
    bool reading_ = false;  // a read is pending
    bool linger_ = true;    // after the last message
    std::array<std::byte, protocol::kHeaderBytes> header_{};
    std::array<std::byte, protocol::kMaxClientPayload> payload_{};
    std::deque<Buffer> unsent_;
    std::size_t sentOfFirst_ = 0;  // bytes of unsent_.front() that are gone already
};

}  // namespace iwalk
