#include "server/gateway/clients.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <new>
#include <utility>

#include "common/token.hpp"

namespace iwalk {
namespace {

// Refused connections that may linger to read why, besides the clients; more are closed without a word.
constexpr std::size_t kLingering = 32;
// More than the kernel's buffers let through, to a client that reads nothing.
constexpr std::uint64_t kMostUnsentAnswers = 16u << 20;
// Later previews are better than late ones.
constexpr std::uint64_t kMostUnsentPreviews = 256u << 10;

Connection::Buffer buffer(const protocol::Message& message) {
    return std::make_shared<const std::vector<std::byte>>(protocol::encode(message));
}

}  // namespace

Clients::Clients(Requests& requests, const protocol::Welcome& welcome, const Gateway::Limits& limits,
                 const std::string& token)
    : requests_(requests),
      limits_(limits),
      token_(token),
      welcome_(welcome),
      slots_(std::make_shared<char>()) {
    for (const protocol::NamedValue& setting : welcome.settings) {
        const Result<void> set = setSetting(settings_, setting.name, setting.value);
        CHECK(set.ok());
    }
}

void Clients::add(boost::asio::ip::tcp::socket socket) {
    if (sockets() >= limits_.clients + kLingering) return;  // closes it

    const Connection::Limits limits{limits_.unsentBytes, limits_.helloTimeout, limits_.stallTimeout};
    auto connection = std::make_shared<Connection>(std::move(socket), std::make_shared<Sender>(++lastId_),
                                                   *this, limits, slots_);
    const bool full = clients_.size() >= limits_.clients;
    clients_.push_back({connection});
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
        if (!client->greeted && !token_.empty() && !sameToken(token_, hello->token)) {
            connection.refuse(hello->token.empty() ? "this server asks for a token: use --token-file"
                                                   : "this is not the server's token");
            return false;
        }
        wishPreview(*client, hello->preview);
        if (client->greeted) wishControl(connection.sender(), hello->control);
        if (!client->greeted) greet(*client, *hello);
        return true;
    }
    if (const auto* failure = std::get_if<protocol::Failure>(&message)) {
        connection.close("left: " + failure->reason, false);
        return false;
    }
    const auto* request = std::get_if<protocol::CameraRequest>(&message);
    const auto* changes = std::get_if<protocol::ChangeSettings>(&message);
    if ((!request && !changes) || !client->greeted) {
        connection.refuse(request || changes ? "a request before the Hello"
                                             : "a message that only servers send");
        return false;
    }
    if (changes) return changeSettings(connection, *changes), true;
    // Cameras of those who only watch do not count; a client may not know yet that it lost control.
    return controls(*connection.sender()) ? requests_.add(connection.sender(), *request) : true;
}

void Clients::ended(Connection& connection, const std::string& reason, bool fault) {
    spdlog::log(fault ? spdlog::level::warn : spdlog::level::info, "client {}: {}", connection.peer(),
                reason);
    const SenderPtr sender = connection.sender();
    if (Client* client = find(*sender)) wishPreview(*client, false);
    std::erase_if(clients_, [&](const Client& client) { return client.connection.get() == &connection; });
    leaveLine(sender);
}

Clients::Client* Clients::find(const Sender& sender) {
    const auto found = std::find_if(clients_.begin(), clients_.end(),
                                    [&](const Client& c) { return c.connection->sender().get() == &sender; });
    return found == clients_.end() ? nullptr : &*found;
}

void Clients::greet(Client& client, const protocol::Hello& hello) {
    spdlog::info("client {}: connected", client.connection->peer());
    client.greeted = true;
    const auto connection = client.connection;  // sending may end it and remove `client`
    connection->greeted();
    const SenderPtr sender = connection->sender();
    connection->send(buffer(welcome_));
    if (sender->gone) return;
    if (lastFrame_) connection->send(buffer(*lastFrame_));
    if (sender->gone) return;
    if (hello.control) line_.push_back(sender);
    tellControl(*sender);
    if (hello.control && !controls(*sender)) tellControl(*line_.front());
}

void Clients::wishPreview(Client& client, bool wanted) {
    if (client.preview == wanted) return;
    client.preview = wanted;
    requests_.previewClients += wanted ? 1 : -1;
    if (wanted) ++requests_.previewsJoined;
}

void Clients::wishControl(const SenderPtr& sender, bool wanted) {
    const bool inLine = std::find(line_.begin(), line_.end(), sender) != line_.end();
    if (wanted == inLine) return;
    if (!wanted) {
        const bool had = controls(*sender);
        leaveLine(sender);
        if (had) tellControl(*sender);
        return;
    }
    line_.push_back(sender);
    tellControl(*line_.front());
}

// Requests of one who controls no more would delay those of the next.
void Clients::leaveLine(const SenderPtr& sender) {
    const bool had = controls(*sender);
    if (std::erase(line_, sender) == 0) return;
    if (had) requests_.drop(*sender);
    if (!line_.empty()) tellControl(*line_.front());
}

void Clients::tellControl(const Sender& sender) {
    Client* client = find(sender);
    if (!client) return;
    const auto connection = client->connection;
    if (controls(sender) && std::exchange(controller_, sender.id) != sender.id)
        spdlog::info("client {}: controls", connection->peer());
    const auto waiting = static_cast<std::uint32_t>(line_.empty() ? 0 : line_.size() - 1);
    connection->send(buffer(protocol::Control{controls(sender), waiting}));
}

// Who does not read must not fill our memory with answers.
void Clients::changeSettings(Connection& connection, const protocol::ChangeSettings& changes) {
    if (connection.sender()->unsentBytes > kMostUnsentAnswers)
        return connection.refuse("does not read the answers to its settings");
    Settings changed = settings_;
    Result<void> fine;
    if (!controls(*connection.sender())) fine = fail("another client controls the wall");
    for (const protocol::NamedValue& setting : changes.settings)
        if (fine) fine = changeSetting(changed, setting.name, setting.value);
    if (!fine) return connection.send(buffer(protocol::SettingsNow{welcome_.settings, fine.error().message}));
    if (changed == settings_) return;

    settings_ = changed;
    for (protocol::NamedValue& setting : welcome_.settings) {
        const std::string value = settingText(settings_, setting.name);
        if (value != setting.value)
            spdlog::info("client {}: {} = {}", connection.peer(), setting.name, value);
        setting.value = value;
    }
    requests_.changeSettings(settings_);
    sendToAll(protocol::SettingsNow{welcome_.settings, {}});
}

// A copy of the list: sending may end a connection, and that changes it.
void Clients::sendToAll(const protocol::Message& message) {
    const Connection::Buffer bytes = buffer(message);
    for (const Client& client : std::vector<Client>(clients_))
        if (client.greeted) client.connection->send(bytes);
}

void Clients::sendFrame(protocol::FrameDone frame, const SenderPtr& sender, std::uint64_t sequence) {
    frame.sequence = 0;
    lastFrame_ = frame;
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

void Clients::sendPreview(const protocol::TileImage& image) {
    const Connection::Buffer bytes = buffer(image);
    for (const Client& client : std::vector<Client>(clients_)) {
        const bool keepsUp = client.connection->sender()->unsentBytes < kMostUnsentPreviews;
        if (client.greeted && client.preview && keepsUp) client.connection->send(bytes);
    }
}

void Clients::sayGoodbye(const std::string& reason) {
    line_.clear();  // nobody takes over
    for (const Client& client : std::vector<Client>(clients_)) client.connection->sayGoodbye(reason);
}

}  // namespace iwalk
