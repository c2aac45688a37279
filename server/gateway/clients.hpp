#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol.hpp"
#include "server/gateway/connection.hpp"
#include "server/gateway/gateway.hpp"
#include "server/gateway/requests.hpp"

namespace iwalk {

// All clients and what messages mean: greeting, who controls, requests in, frames and pictures out.
// Everything here runs on the gateway's thread.
class Clients : public Connection::Owner {
  public:
    // `requests` outlives this.
    Clients(Requests& requests, const protocol::Welcome& welcome, const Gateway::Limits& limits,
            const std::string& token);

    // A new connection, welcome or one too many.
    void add(boost::asio::ip::tcp::socket socket);
    // The queue of requests is full no more.
    void resumeReading();
    // `sequence` is the sender's own number; `sender` may be null: nobody's request.
    void sendFrame(protocol::FrameDone frame, const SenderPtr& sender, std::uint64_t sequence);
    // `counted`: what of it is in the sender's unsentBytes already.
    void sendImage(const protocol::TileImage& image, const SenderPtr& sender, std::uint64_t counted);
    // To all that want previews and keep up.
    void sendPreview(const protocol::TileImage& image);
    void sayGoodbye(const std::string& reason);
    // Sockets that are not closed yet.
    std::size_t sockets() const { return static_cast<std::size_t>(slots_.use_count() - 1); }

  private:
    struct Client {
        std::shared_ptr<Connection> connection;
        bool greeted = false;
        bool preview = false;  // wants small pictures
    };

    bool received(Connection& connection, const protocol::Message& message) override;
    void ended(Connection& connection, const std::string& reason, bool fault) override;

    Client* find(const Sender& sender);
    void greet(Client& client, const protocol::Hello& hello);
    void wishPreview(Client& client, bool wanted);
    void wishControl(const SenderPtr& sender, bool wanted);
    void leaveLine(const SenderPtr& sender);
    void tellControl(const Sender& sender);
    void sendToAll(const protocol::Message& message);
    void changeSettings(Connection& connection, const protocol::ChangeSettings& changes);
    bool controls(const Sender& sender) const { return !line_.empty() && line_.front().get() == &sender; }

    Requests& requests_;
    const Gateway::Limits limits_;
    const std::string token_;  // empty: none is asked for
    protocol::Welcome welcome_;
    Settings settings_;                             // as welcome_ says them
    std::vector<Client> clients_;                   // open connections
    std::optional<protocol::FrameDone> lastFrame_;  // on the wall, as nobody's
    std::deque<SenderPtr> line_;                 // who wants control, longest waiting first; the first has it
    std::shared_ptr<void> slots_;                // one more owner for every socket that is not closed yet
    std::uint64_t lastId_ = 0, controller_ = 0;  // controller_: that was said to be it last
};

}  // namespace iwalk
