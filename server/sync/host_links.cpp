#include "server/sync/host_links.hpp"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <charconv>
#include <cstring>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <thread>
#include <vector>

#include "common/token.hpp"

namespace iwalk {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::milliseconds;

constexpr milliseconds kIdleEvery{1}, kKnock{2000}, kBetweenKnocks{50};
constexpr std::size_t kSecretLetters = 32, kNumberLetters = 8;
constexpr std::size_t kHelloLetters = kSecretLetters + kNumberLetters;

// 128 bits that nobody else knows, as hexadecimal digits.
std::string makeSecret() {
    std::random_device device;  // the kernel's
    std::string secret;
    while (secret.size() < kSecretLetters) secret += fmt::format("{:08x}", device());
    return secret;
}

// Where others may find this host, what only it can reach last.
std::vector<asio::ip::address> ownAddresses() {
    ifaddrs* first = nullptr;
    if (getifaddrs(&first) != 0) return {};
    const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(first, freeifaddrs);
    std::vector<asio::ip::address> addresses;
    for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
        if (one->ifa_addr == nullptr || !(one->ifa_flags & IFF_UP)) continue;
        if (one->ifa_addr->sa_family == AF_INET) {
            sockaddr_in v4;
            std::memcpy(&v4, one->ifa_addr, sizeof v4);
            addresses.emplace_back(asio::ip::address_v4(ntohl(v4.sin_addr.s_addr)));
        } else if (one->ifa_addr->sa_family == AF_INET6) {
            sockaddr_in6 v6;
            std::memcpy(&v6, one->ifa_addr, sizeof v6);
            asio::ip::address_v6::bytes_type bytes;
            std::memcpy(bytes.data(), &v6.sin6_addr, bytes.size());
            const asio::ip::address_v6 address(bytes);
            if (!address.is_link_local()) addresses.emplace_back(address);
        }
    }
    std::stable_partition(addresses.begin(), addresses.end(),
                          [](const asio::ip::address& address) { return !address.is_loopback(); });
    return addresses;
}

// At every address of the host, of both kinds where it has both.
error_code listen(tcp::acceptor& door) {
    error_code error;
    door.open(tcp::v6(), error);
    if (!error) door.set_option(asio::ip::v6_only(false), error);
    if (!error) door.bind({tcp::v6(), 0}, error);
    if (error) {
        error_code ignored;
        door.close(ignored);
        door.open(tcp::v4(), error);
        if (!error) door.bind({tcp::v4(), 0}, error);
    }
    if (!error) door.listen(asio::socket_base::max_listen_connections, error);
    return error;
}

Error lost(const std::string& host, const error_code& why) {
    return fail("the connection to {} is lost: {}", host, why.message());
}

}  // namespace

struct HostLinks::Stranger {
    Socket socket;
    std::array<char, kHelloLetters> hello{};
};

Result<std::string> HostLinks::invite() {
    if (const error_code error = listen(door_))
        return fail("cannot listen for other hosts: {}", error.message());
    question_ = makeSecret();
    answer_ = makeSecret();
    std::string invitation = fmt::format("{} {} {}", door_.local_endpoint().port(), question_, answer_);
    for (const asio::ip::address& address : ownAddresses()) {
        const std::string text = address.to_string();
        if (invitation.size() + 1 + text.size() <= kMostInvitation) invitation += " " + text;
    }
    return invitation;
}

Result<void> HostLinks::welcome(std::span<const int> guests, milliseconds within) {
    accept();
    const auto missing = [&] {
        return std::find_if(guests.begin(), guests.end(), [&](int guest) { return !links_.contains(guest); });
    };
    const auto end = Clock::now() + within;
    io_.restart();
    while (missing() != guests.end() && io_.run_one_until(end) > 0) continue;
    error_code ignored;
    door_.close(ignored);
    if (missing() == guests.end()) return {};
    return fail("rank {} has not connected by TCP within {} ms", *missing(), within.count());
}

void HostLinks::accept() {
    door_.async_accept([this](const error_code& error, Socket socket) {
        if (!door_.is_open() || (error && error != asio::error::connection_aborted)) return;
        if (!error) hear(std::move(socket));
        accept();
    });
}

// Whoever does not say what a guest must is sent away.
void HostLinks::hear(Socket socket) {
    const auto stranger = std::make_shared<Stranger>(Stranger{std::move(socket)});
    const auto heard = [this, stranger](error_code error, std::size_t) {
        if (error || !door_.is_open()) return;
        const std::string_view hello(stranger->hello.data(), stranger->hello.size());
        if (!sameToken(question_, hello.substr(0, kSecretLetters))) return;
        int number = 0;
        std::from_chars(&hello[kSecretLetters], hello.data() + hello.size(), number, 16);
        asio::write(stranger->socket, asio::buffer(answer_), error);
        if (!error) keep(number, std::move(stranger->socket));
    };
    asio::async_read(stranger->socket, asio::buffer(stranger->hello), heard);
}

Result<void> HostLinks::join(const std::string& invitation, int number, milliseconds within) {
    std::istringstream words(invitation);
    std::uint16_t port = 0;
    std::vector<tcp::endpoint> hubs;
    words >> port >> question_ >> answer_;
    for (std::string word; words >> word;) {
        error_code error;
        const asio::ip::address address = asio::ip::make_address(word, error);
        if (!error) hubs.emplace_back(address, port);
    }
    const std::string hello = fmt::format("{}{:08x}", question_, number);
    const auto end = Clock::now() + within;
    while (Clock::now() < end) {
        for (const tcp::endpoint& hub : hubs)
            if (knock(hub, hello, std::min(end, Clock::now() + kKnock))) return {};
        std::this_thread::sleep_for(kBetweenKnocks);
    }
    const std::size_t addresses = invitation.find(answer_) + answer_.size();
    return fail("cannot reach rank 0 by TCP at port {} of any of its addresses:{}", port,
                invitation.substr(addresses));
}

// Whether the hub is there and answers.
bool HostLinks::knock(const tcp::endpoint& hub, const std::string& hello, Clock::time_point end) {
    Socket socket(io_);
    std::string reply(kSecretLetters, '\0');
    bool answered = false;
    socket.async_connect(hub, [&](error_code error) {
        if (!error) asio::write(socket, asio::buffer(hello), error);
        if (error) return;
        asio::async_read(socket, asio::buffer(reply),
                         [&](const error_code& failed, std::size_t) { answered = !failed; });
    });
    io_.restart();
    io_.run_until(end);
    if (!answered || !sameToken(answer_, reply)) {
        error_code ignored;
        socket.close(ignored);
        io_.restart();
        io_.run();  // what was cancelled refers to this function's variables
        return false;
    }
    keep(0, std::move(socket));
    return true;
}

void HostLinks::keep(int number, Socket socket) {
    error_code error;
    socket.set_option(tcp::no_delay(true), error);  // messages are small, and somebody waits for each
    asio::ip::address peer = socket.remote_endpoint(error).address();
    if (peer.is_v6() && peer.to_v6().is_v4_mapped())
        peer = asio::ip::make_address_v4(asio::ip::v4_mapped, peer.to_v6());
    links_.insert_or_assign(number, Link{std::move(socket), peer.to_string()});
}

// One byte goes before the bytes, of which there may be none.
Result<void> HostLinks::lead(std::span<const std::byte> bytes, const IdleWork& idle) {
    std::vector<std::byte> message(1 + bytes.size());
    std::copy(bytes.begin(), bytes.end(), message.begin() + 1);
    for (auto& [guest, link] : links_) {
        std::byte here{};
        if (Result<void> received = receive(link, {&here, 1}, idle); !received) return received;
    }
    for (auto& [guest, link] : links_)
        if (Result<void> sent = send(link, message); !sent) return sent;
    return {};
}

Result<void> HostLinks::follow(std::span<std::byte> bytes, const IdleWork& idle) {
    Link& hub = links_.at(0);
    const std::byte here{};
    if (Result<void> sent = send(hub, {&here, 1}); !sent) return sent;
    std::vector<std::byte> message(1 + bytes.size());
    if (Result<void> received = receive(hub, message, idle); !received) return received;
    std::copy(message.begin() + 1, message.end(), bytes.begin());
    return {};
}

Result<void> HostLinks::receive(Link& from, std::span<std::byte> bytes, const IdleWork& idle) {
    std::optional<error_code> result;
    asio::async_read(from.socket, asio::buffer(bytes.data(), bytes.size()),
                     [&](const error_code& error, std::size_t) { result = error; });
    io_.restart();
    while (!result)
        if (io_.run_one_for(kIdleEvery) == 0 && idle) idle();
    if (*result) return lost(from.name, *result);
    return {};
}

Result<void> HostLinks::send(Link& to, std::span<const std::byte> bytes) {
    error_code error;
    asio::write(to.socket, asio::buffer(bytes.data(), bytes.size()), error);
    if (error) return lost(to.name, error);
    return {};
}

}  // namespace iwalk
