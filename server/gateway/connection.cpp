#include "server/gateway/connection.hpp"

#include <fmt/format.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <span>

namespace iwalk {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::milliseconds kLinger{1000};  // for the client to read why it is dropped

// Small messages go out at once; a client whose machine is gone without a word is noticed within a minute.
void configure(tcp::socket& socket) {
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::keep_alive(true), ignored);
    const auto set = [&](int option, int value) {
        ::setsockopt(socket.native_handle(), IPPROTO_TCP, option, &value, sizeof value);
    };
    set(TCP_KEEPIDLE, 30), set(TCP_KEEPINTVL, 10), set(TCP_KEEPCNT, 3);
}

std::string nameOf(const tcp::socket& socket) {
    error_code error;
    const tcp::endpoint peer = socket.remote_endpoint(error);
    if (error) return "a client that is gone already";
    const std::string address = peer.address().to_string(error);
    return fmt::format("{}:{}", address, peer.port());
}

}  // namespace

Connection::Connection(tcp::socket socket, SenderPtr sender, Owner& owner, const Limits& limits,
                       std::shared_ptr<void> slot)
    : socket_(std::move(socket)),
      deadline_(socket_.get_executor()),
      sender_(std::move(sender)),
      owner_(owner),
      limits_(limits),
      slot_(std::move(slot)),
      peer_(nameOf(socket_)) {
    configure(socket_);
}

void Connection::start() {
    arm(limits_.helloTimeout, &Connection::lateHello);
    readHeader();
}

void Connection::resumeReading() {
    if (state_ == State::open && !reading_) readHeader();
}

void Connection::readHeader() {
    reading_ = true;
    asio::async_read(socket_, asio::buffer(header_),
                     [this, self = shared_from_this()](const error_code& error, std::size_t) {
                         reading_ = false;
                         if (state_ != State::open) return discardInput();
                         if (error) return close("closed the connection", false);
                         const auto header = protocol::decodeHeader(header_, protocol::kMaxClientPayload);
                         if (!header) return refuse(header.error().message);
                         readPayload(*header);
                     });
}

void Connection::readPayload(const protocol::Header& header) {
    reading_ = true;
    asio::async_read(socket_, asio::buffer(payload_, header.payloadBytes),
                     [this, self = shared_from_this(), header](const error_code& error, std::size_t) {
                         reading_ = false;
                         if (state_ != State::open) return discardInput();
                         if (error) return close("closed the connection within a message", false);
                         takeMessage(header);
                     });
}

void Connection::takeMessage(const protocol::Header& header) {
    const auto message = protocol::decodePayload(header, std::span(payload_).first(header.payloadBytes));
    if (!message) return refuse(message.error().message);
    const bool readOn = owner_.received(*this, *message);
    if (state_ == State::open && readOn) readHeader();
}

// What arrives after the end is read and thrown away: closing a socket with unread bytes resets the
// connection, and the client would lose the message that says why.
void Connection::discardInput() {
    if (state_ != State::closing || reading_) return;
    reading_ = true;
    socket_.async_read_some(asio::buffer(payload_),
                            [this, self = shared_from_this()](const error_code& error, std::size_t) {
                                reading_ = false;
                                if (error) return closeSocket();
                                discardInput();
                            });
}

void Connection::send(Buffer message, std::uint64_t counted) {
    if (state_ != State::open) return;
    const std::uint64_t unsent = sender_->unsentBytes += message->size() - counted;
    unsent_.push_back(std::move(message));
    if (unsent > limits_.unsentBytes) {
        return close(fmt::format("does not read: {} bytes are unsent", unsent), true);
    }
    if (unsent_.size() == 1) writeSome();
}

void Connection::writeSome() {
    if (state_ == State::open) arm(limits_.stallTimeout, &Connection::lateReader);
    const std::vector<std::byte>& first = *unsent_.front();
    socket_.async_write_some(asio::buffer(first.data() + sentOfFirst_, first.size() - sentOfFirst_),
                             [this, self = shared_from_this()](const error_code& error, std::size_t bytes) {
                                 wrote(error, bytes);
                             });
}

void Connection::wrote(const error_code& error, std::size_t bytes) {
    if (state_ == State::closed) return;
    if (error) return close("closed the connection", false);
    sender_->unsentBytes -= bytes;
    sentOfFirst_ += bytes;
    if (sentOfFirst_ == unsent_.front()->size()) {
        unsent_.pop_front();
        sentOfFirst_ = 0;
    }
    if (!unsent_.empty()) return writeSome();
    if (state_ == State::open) return disarm();
    if (!linger_) return closeSocket();
    error_code ignored;
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
}

void Connection::refuse(const std::string& reason) {
    if (state_ != State::open) return;
    sendLast(reason);
    discardInput();
    end(reason, true);
}

void Connection::sayGoodbye(const std::string& reason) {
    if (state_ != State::open) return;
    linger_ = false;
    sendLast(reason);
    end(reason, false);
}

void Connection::sendLast(const std::string& reason) {
    state_ = State::closing;
    arm(kLinger, &Connection::closeSocket);
    // What is being written must be finished, or the Failure would land in the middle of another message.
    dropUnsent(unsent_.empty() ? 0 : 1);
    auto failure =
        std::make_shared<const std::vector<std::byte>>(protocol::encode(protocol::Failure{reason}));
    sender_->unsentBytes += failure->size();
    unsent_.push_back(std::move(failure));
    if (unsent_.size() == 1) writeSome();
}

void Connection::close(const std::string& reason, bool fault) {
    const bool wasOpen = state_ == State::open;
    const auto self = shared_from_this();
    closeSocket();
    if (wasOpen) end(reason, fault);
}

void Connection::dropUnsent(std::size_t keep) {
    while (unsent_.size() > keep) {
        sender_->unsentBytes -= unsent_.back()->size() - (unsent_.size() == 1 ? sentOfFirst_ : 0);
        unsent_.pop_back();
    }
}

void Connection::end(const std::string& reason, bool fault) {
    sender_->gone = true;
    owner_.ended(*this, reason, fault);
}

// Buffers stay until the last pending write has been told of its end.
void Connection::closeSocket() {
    if (state_ == State::closed) return;
    state_ = State::closed;
    disarm();
    error_code ignored;
    socket_.close(ignored);
}

void Connection::arm(std::chrono::milliseconds time, void (Connection::*late)()) {
    deadline_.expires_after(time);
    deadline_.async_wait([this, self = shared_from_this(), late](const error_code&) {
        // Cancelled or set anew in the meantime, perhaps when this call was already on its way.
        if (deadline_.expiry() > std::chrono::steady_clock::now()) return;
        (this->*late)();
    });
}

void Connection::disarm() {
    deadline_.expires_at(std::chrono::steady_clock::time_point::max());
}

void Connection::lateHello() {
    refuse("no Hello within the time for it");
}

void Connection::lateReader() {
    close("does not read what is sent to it", true);
}

}  // namespace iwalk
