#include "client/server_link.hpp"

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <charconv>
#include <thread>

namespace iwalk::client {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using protocol::Message;

constexpr std::chrono::milliseconds kRetry{100};
constexpr std::size_t kFirstStep = 64u << 10;  // bytes of a payload to allocate before any of it is there

// Frames may take as long as they need, so silence is no error; a machine that is gone is noticed within a
// minute.
void configure(tcp::socket& socket) {
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::keep_alive(true), ignored);
    const auto set = [&](int option, int value) {
        ::setsockopt(socket.native_handle(), IPPROTO_TCP, option, &value, sizeof value);
    };
    set(TCP_KEEPIDLE, 30), set(TCP_KEEPINTVL, 10), set(TCP_KEEPCNT, 3);
}

}  // namespace

Result<Address> parseAddress(const std::string& text) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos || colon == 0) return fail("'{}' is not HOST:PORT", text);
    Address address;
    address.host = text.substr(0, colon);
    if (address.host.front() == '[' && address.host.back() == ']') {
        address.host = address.host.substr(1, address.host.size() - 2);
    } else if (address.host.find(':') != std::string::npos) {
        return fail("'{}': write an IPv6 address in brackets, as in [::1]:4242", text);
    }
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, address.port);
    const bool number = error == std::errc() && stop == end && address.port != 0;
    if (!number) return fail("'{}': the port is not a number from 1 to 65535", text);
    return address;
}

ServerLink::ServerLink(const Address& server) : name_(fmt::format("{}:{}", server.host, server.port)) {}

Result<std::unique_ptr<ServerLink>> ServerLink::connect(const Address& server, const protocol::Hello& hello,
                                                        Clock::time_point deadline) {
    std::unique_ptr<ServerLink> link(new ServerLink(server));
    RETURN_IF_ERROR(link->reach(server, deadline));
    RETURN_IF_ERROR(link->greet(hello, deadline));
    return link;
}

Result<void> ServerLink::reach(const Address& server, Clock::time_point deadline) {
    error_code error;
    tcp::resolver resolver(io_);
    const auto endpoints = resolver.resolve(server.host, std::to_string(server.port), error);
    if (error) return fail("cannot find the host '{}': {}", server.host, error.message());

    for (;;) {
        error = tryConnect(endpoints, deadline);
        if (!error) break;
        if (Clock::now() + kRetry >= deadline) {
            return fail("cannot reach a server at {}: {}; is it running, and does it --listen there?", name_,
                        error.message());
        }
        std::this_thread::sleep_for(kRetry);
    }
    configure(socket_);
    return {};
}

error_code ServerLink::tryConnect(const tcp::resolver::results_type& endpoints, Clock::time_point deadline) {
    error_code result;
    bool done = false;
    asio::async_connect(socket_, endpoints, [&](const error_code& error, const tcp::endpoint&) {
        result = error;
        done = true;
    });
    if (runUntil(deadline, done)) return result;
    // The handler refers to this frame: let it end before we do.
    error_code ignored;
    socket_.close(ignored);
    runUntil(Clock::time_point::max(), done);
    return asio::error::timed_out;
}

Result<void> ServerLink::greet(const protocol::Hello& hello, Clock::time_point deadline) {
    RETURN_IF_ERROR(send(hello));
    ASSIGN_OR_RETURN(const std::optional<Message> message, receive(deadline));
    if (!message) return fail("{} took the connection and does not answer; is it an iwalk-server?", name_);
    const auto* welcome = std::get_if<protocol::Welcome>(&*message);
    if (!welcome) return fail("{} does not begin with a Welcome; is it an iwalk-server?", name_);
    welcome_ = *welcome;
    return {};
}

Result<void> ServerLink::send(const Message& message) {
    error_code error;
    asio::write(socket_, asio::buffer(protocol::encode(message)), error);
    // Why the server closed may be among what it sent before: the reader will find it.
    if (error && error != asio::error::broken_pipe && error != asio::error::connection_reset) {
        return fail("{}: {}", name_, error.message());
    }
    return {};
}

Result<std::optional<Message>> ServerLink::receive(Clock::time_point deadline) {
    if (!reading_) readHeader();
    if (!runUntil(deadline, ready_)) return std::optional<Message>();
    ready_ = false;
    if (!arrived_) return std::optional<Message>();  // woken
    reading_ = arrived_ = false;
    if (!message_->ok()) return message_->error();
    Message message = std::move(*message_).value();
    if (const auto* failure = std::get_if<protocol::Failure>(&message)) {
        return fail("the server at {} ends the connection: {}", name_, failure->reason);
    }
    return std::optional<Message>(std::move(message));
}

void ServerLink::readHeader() {
    reading_ = true;
    asio::async_read(socket_, asio::buffer(headerBytes_), [this](const error_code& error, std::size_t) {
        if (error) return finish(fail("the server at {} is gone", name_));
        const auto header = protocol::decodeHeader(headerBytes_, protocol::kMaxServerPayload);
        if (!header) return finish(fail("{}: {}", name_, header.error().message));
        header_ = *header;
        payload_.clear();
        payloadRead_ = 0;
        readPayload();
    });
}

// In steps that double: a length that is a lie costs no more memory than was sent.
void ServerLink::readPayload() {
    const std::size_t missing = header_.payloadBytes - payloadRead_;
    if (missing == 0) {
        auto message = protocol::decodePayload(header_, payload_);
        if (!message) return finish(fail("{}: {}", name_, message.error().message));
        return finish(std::move(message));
    }
    const std::size_t step = std::min(missing, std::max(kFirstStep, payloadRead_));
    payload_.resize(payloadRead_ + step);
    asio::async_read(socket_, asio::buffer(payload_.data() + payloadRead_, step),
                     [this](const error_code& error, std::size_t bytes) {
                         if (error) return finish(fail("the server at {} is gone", name_));
                         payloadRead_ += bytes;
                         readPayload();
                     });
}

void ServerLink::finish(Result<Message> message) {
    message_ = std::move(message);
    arrived_ = ready_ = true;
}

void ServerLink::wake() {
    asio::post(io_, [this] { ready_ = true; });
}

bool ServerLink::runUntil(Clock::time_point deadline, const bool& done) {
    io_.restart();
    while (!done && io_.poll_one() != 0) {
    }
    while (!done && io_.run_one_until(deadline) != 0) {
    }
    return done;
}

}  // namespace iwalk::client
