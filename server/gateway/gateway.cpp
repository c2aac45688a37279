#include "server/gateway/gateway.hpp"

#include <spdlog/spdlog.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <thread>

#include "server/gateway/clients.hpp"
#include "server/gateway/requests.hpp"

namespace iwalk {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::milliseconds kAcceptRetry{200};
constexpr std::chrono::milliseconds kGoodbyeLook{5};
constexpr int kGoodbyeLooks = 50;

class SocketGateway : public Gateway {
  public:
    SocketGateway(const protocol::Welcome& welcome, const Limits& limits, const std::string& token)
        : requests_({limits.queuedRequests, limits.unsentBytes / 4}),
          clients_(requests_, welcome, limits, token),
          open_(token.empty()) {}

    ~SocketGateway() override {
        if (!thread_.joinable()) return;
        asio::post(io_, [this] {
            error_code ignored;
            acceptor_.close(ignored);
            clients_.sayGoodbye("the server is shutting down");
            stopSoon(kGoodbyeLooks);
        });
        thread_.join();
    }

    Result<void> open(const std::string& address, std::uint16_t port);

    std::uint16_t port() const override { return port_; }

    std::optional<protocol::CameraRequest> nextRequest() override {
        const auto taken = requests_.take();
        if (!taken) return std::nullopt;
        if (taken->madeRoom) asio::post(io_, [this] { clients_.resumeReading(); });
        return taken->request;
    }

    std::optional<Settings> newSettings() override { return requests_.takeSettings(); }

    void frameDone(protocol::FrameDone frame) override {
        const auto origin = requests_.origin(frame.sequence).value_or(Requests::Origin{});
        asio::post(io_, [this, frame = std::move(frame), origin]() mutable {
            clients_.sendFrame(std::move(frame), origin.sender, origin.sequence);
        });
    }

    PreviewWish previewWish() const override {
        return {requests_.previewClients > 0, requests_.previewsJoined};
    }

    void tileImage(protocol::TileImage image) override {
        if (image.kind == protocol::ImageKind::preview) {
            asio::post(io_, [this, image = std::move(image)] { clients_.sendPreview(image); });
            return;
        }
        const auto origin = requests_.origin(image.sequence);
        if (!origin || origin->sender->gone) return;
        image.sequence = origin->sequence;
        // Counted from now on, so that the next capture is held back even before the other thread gets to
        // this one.
        const std::uint64_t bytes = image.bytes.size();
        origin->sender->unsentBytes += bytes;
        asio::post(io_, [this, image = std::move(image), sender = origin->sender, bytes] {
            clients_.sendImage(image, sender, bytes);
        });
    }

  private:
    Result<void> bind(const tcp::endpoint& endpoint);
    void accept();
    void acceptLater(const error_code& why);
    void stopSoon(int looks);
    void run();

    Requests requests_;
    asio::io_context io_{1};
    Clients clients_;  // after io_, without which sockets cannot be closed
    tcp::acceptor acceptor_{io_};
    asio::steady_timer retry_{io_};
    const bool open_;            // to everybody who can reach it
    bool acceptFailed_ = false;  // said so already
    std::uint16_t port_ = 0;
    std::thread thread_;
};

Result<void> SocketGateway::open(const std::string& address, std::uint16_t port) {
    const std::string place = fmt::format("{}:{}", address, port);
    error_code error;
    tcp::resolver resolver(io_);
    const auto found = resolver.resolve(address, std::to_string(port), tcp::resolver::passive, error);
    if (error || found.empty()) return fail("cannot listen on {}: there is no such address here", place);

    if (open_ && !found.begin()->endpoint().address().is_loopback())
        return fail("cannot listen on {}: others can reach it: give --token-file FILE", place);
    const Result<void> bound = bind(found.begin()->endpoint());
    if (!bound) return fail("cannot listen on {}: {}", place, bound.error().message);
    port_ = acceptor_.local_endpoint(error).port();
    accept();
    thread_ = std::thread([this] { run(); });
    return {};
}

// SO_REUSEADDR lets a server start again while old connections still linger; on Linux it does not let two
// listen.
Result<void> SocketGateway::bind(const tcp::endpoint& endpoint) {
    error_code error;
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error == asio::error::address_in_use) {
        return fail("the port is in use; end the program that has it, or choose another port");
    }
    if (error == asio::error::access_denied) return fail("not permitted; choose a port above 1023");
    if (error) return fail("{}", error.message());
    return {};
}

void SocketGateway::accept() {
    acceptor_.async_accept([this](const error_code& error, tcp::socket socket) {
        if (!acceptor_.is_open()) return;  // the end
        if (error && error != asio::error::connection_aborted) return acceptLater(error);
        if (!error) {
            acceptFailed_ = false;
            clients_.add(std::move(socket));
        }
        accept();
    });
}

// Out of descriptors, most likely: the connection stays in the kernel's queue, so trying at once would spin.
void SocketGateway::acceptLater(const error_code& why) {
    if (!acceptFailed_) spdlog::warn("cannot take a new client for now: {}", why.message());
    acceptFailed_ = true;
    retry_.expires_after(kAcceptRetry);
    retry_.async_wait([this](const error_code& error) {
        if (!error) accept();
    });
}

// When every good-bye is out, or after so many looks whether it is.
void SocketGateway::stopSoon(int looks) {
    if (looks == 0 || clients_.sockets() == 0) return io_.stop();
    retry_.expires_after(kGoodbyeLook);
    retry_.async_wait([this, looks](const error_code&) { stopSoon(looks - 1); });
}

// Nothing here throws but memory that runs out; that must not end the wall.
void SocketGateway::run() {
    for (bool done = false; !done;) {
        try {
            io_.run();
            done = true;
        } catch (const std::exception& error) {
            spdlog::error("gateway: {}", error.what());
        }
    }
}

}  // namespace

Result<std::unique_ptr<Gateway>> Gateway::listen(const std::string& address, std::uint16_t port,
                                                 const protocol::Welcome& welcome, const std::string& token) {
    return listen(address, port, welcome, Limits{}, token);
}

Result<std::unique_ptr<Gateway>> Gateway::listen(const std::string& address, std::uint16_t port,
                                                 const protocol::Welcome& welcome, const Limits& limits,
                                                 const std::string& token) {
    try {
        auto gateway = std::make_unique<SocketGateway>(welcome, limits, token);
        RETURN_IF_ERROR(gateway->open(address, port));
        return std::unique_ptr<Gateway>(std::move(gateway));
    } catch (const std::exception& error) {
        return fail("cannot listen on {}:{}: {}", address, port, error.what());
    }
}

}  // namespace iwalk
