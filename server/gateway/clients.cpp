#include "server/gateway/clients.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <new>

namespace iwalk {
namespace {

// Refused connections that may linger to read why, besides the clients; more are closed without a word.
constexpr std::size_t kLingering = 32;

Connection::Buffer buffer(const protocol::Message& message) {
    return std::make_shared<const std::vector<std::byte>>(protocol::encode(message));
}

}  // namespace

Clients::Clients(Requests& requests, const protocol::Welcome& welcome, const Gateway::Limits& limits)
    : requests_(requests), limits_(limits), welcome_(buffer(welcome)), slots_(std::make_shared<char>()) {}

void Clients::add(boost::asio::ip::tcp::socket socket) {
    if (sockets() >= limits_.clients + kLingering) return;  // closes it

    const Connection::Limits limits{limits_.unsentBytes, limits_.helloTimeout, limits_.stallTimeout};
    auto connection = std::make_shared<Connection>(std::move(socket), std::make_shared<Sender>(++lastId_),
                                                   *this, limits, slots_);
    const bool full = clients_.size() >= limits_.clients;
    clients_.push_back({connection, false});
    connection->start();
    if (full)
        connection->refuse(
            fmt::format("the server has {} clients already; try again later", limits_.clients));
}

void Clients::resumeReading() {
    for (const Client& client : std::vector<Client>(clients_)) client.connection->resumeReading();
}

bool Clients::received(Connection& connection, const protocol::Message& message) {
    Client* client = find(*connection.sender());
    CHECK(client != nullptr);
    if (const auto* hello = std::get_if<protocol::Hello>(&message)) {
        if (client->greeted) wishControl(connection.sender(), hello->control);
        if (!client->greeted) greet(*client, hello->control);
        return true;
    }
    if (const auto* failure = std::get_if<protocol::Failure>(&message)) {
        connection.close("left: " + failure->reason, false);
        return false;
    }
    const auto* request = std::get_if<protocol::CameraRequest>(&message);
    if (!request || !client->greeted) {
        connection.refuse(request ? "a request before the Hello" : "a message that only servers send");
        return false;
    }
    // Cameras of those who only watch do not count; a client may not know yet that it lost control.
    return controls(*connection.sender()) ? requests_.add(connection.sender(), *request) : true;
}

void Clients::ended(Connection& connection, const std::string& reason, bool fault) {
    spdlog::log(fault ? spdlog::level::warn : spdlog::level::info, "client {}: {}", connection.peer(),
                reason);
    const SenderPtr sender = connection.sender();
    std::erase_if(clients_, [&](const Client& client) { return client.connection.get() == &connection; });
    leaveLine(sender);
}

Clients::Client* Clients::find(const Sender& sender) {
    const auto found = std::find_if(clients_.begin(), clients_.end(),
                                    [&](const Client& c) { return c.connection->sender().get() == &sender; });
    return found == clients_.end() ? nullptr : &*found;
}

void Clients::greet(Client& client, bool wantsControl) {
    spdlog::info("client {}: connected", client.connection->peer());
    client.greeted = true;
    const auto connection = client.connection;  // sending may end it and remove `client`
    connection->greeted();
    const SenderPtr sender = connection->sender();
    connection->send(welcome_);
    if (sender->gone) return;
    if (wantsControl) line_.push_back(sender);
    tellControl(*sender, controls(*sender));
}

void Clients::wishControl(const SenderPtr& sender, bool wanted) {
    const bool inLine = std::find(line_.begin(), line_.end(), sender) != line_.end();
    if (wanted == inLine) return;
    if (!wanted) {
        const bool had = controls(*sender);
        leaveLine(sender);
        if (had) tellControl(*sender, false);
        return;
    }
    line_.push_back(sender);
    if (controls(*sender)) tellControl(*sender, true);
}

// Requests of one who controls no more would delay those of the next.
void Clients::leaveLine(const SenderPtr& sender) {
    const bool had = controls(*sender);
    std::erase(line_, sender);
    if (!had) return;
    requests_.drop(*sender);
    if (!line_.empty()) tellControl(*line_.front(), true);
}

void Clients::tellControl(const Sender& sender, bool granted) {
    Client* client = find(sender);
    if (!client) return;
    if (granted) spdlog::info("client {}: controls", client->connection->peer());
    const auto connection = client->connection;
    connection->send(buffer(protocol::Control{granted}));
}

void Clients::sendFrame(protocol::FrameDone frame, const SenderPtr& sender, std::uint64_t sequence) {
    frame.sequence = 0;
    const Connection::Buffer forOthers = buffer(frame);
    frame.sequence = sequence;
    const Connection::Buffer forSender = sender ? buffer(frame) : forOthers;
    // A copy: sending may end a connection, and that changes the list.
    for (const Client& client : std::vector<Client>(clients_)) {
        if (client.greeted)
            client.connection->send(client.connection->sender() == sender ? forSender : forOthers);
    }
}

void Clients::sendImage(const protocol::TileImage& image, const SenderPtr& sender, std::uint64_t counted) {
    constexpr std::size_t kOtherFields = 64;
    Client* client = find(*sender);
    if (!client) return;
    const auto connection = client->connection;
    if (image.bytes.size() > protocol::kMaxServerPayload - kOtherFields) {
        return connection->refuse(
            fmt::format("the picture of tile {} has {} bytes, more than the protocol can carry", image.tile,
                        image.bytes.size()));
    }
    try {
        connection->send(buffer(image), counted);
    } catch (const std::bad_alloc&) {
        connection->refuse("the server's memory does not suffice for the pictures");
    }
}

void Clients::sayGoodbye(const std::string& reason) {
    line_.clear();  // nobody takes over
    for (const Client& client : std::vector<Client>(clients_)) client.connection->sayGoodbye(reason);
}

}  // namespace iwalk
