// Hosts that come together over TCP, as threads on the loopback address.
#include "server/sync/host_links.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <memory>
#include <numeric>
#include <sstream>
#include <thread>
#include <vector>

namespace iwalk {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace std::chrono_literals;

constexpr int kRounds = 200;
constexpr std::chrono::milliseconds kLong = 20s, kShort = 300ms;

std::vector<int> numbers(int guests) {
    std::vector<int> result(static_cast<std::size_t>(guests));
    std::iota(result.begin(), result.end(), 1);
    return result;
}

// A hub and one guest that have joined.
struct Pair {
    std::unique_ptr<HostLinks> hub = std::make_unique<HostLinks>(), guest = std::make_unique<HostLinks>();
    bool joined = false;

    Pair() {
        const Result<std::string> invitation = hub->invite();
        if (!invitation) return;
        bool came = false;
        std::thread other([&] { came = guest->join(*invitation, 1, kLong).ok(); });
        joined = hub->welcome(numbers(1), kLong).ok();
        other.join();
        joined = joined && came;
    }
};

class HostLinksTest : public testing::TestWithParam<int> {};

TEST_P(HostLinksTest, NobodyLeavesBeforeAllHaveCome) {
    const int guests = GetParam();
    std::vector<std::atomic<int>> come(static_cast<std::size_t>(guests) + 1);
    const auto meetOften = [&](HostLinks& links, int rank) {
        for (int round = 1; round <= kRounds; ++round) {
            if (round % 37 == rank) std::this_thread::sleep_for(2ms);
            come[static_cast<std::size_t>(rank)] = round;
            std::int64_t number = rank == 0 ? round * 1000 : 0;
            const std::span bytes = std::as_writable_bytes(std::span(&number, 1));
            const auto given = round % 2 ? bytes : bytes.first(0);  // a barrier gives nothing
            if (!(rank == 0 ? links.lead(given, {}) : links.follow(given, {}))) return false;
            if (round % 2 && number != round * 1000) return false;
            for (const std::atomic<int>& one : come)
                if (one < round) return false;
        }
        return true;
    };
    HostLinks hub;
    const Result<std::string> invitation = hub.invite();
    ASSERT_TRUE(invitation);
    EXPECT_LE(invitation->size(), HostLinks::kMostInvitation);
    std::atomic<int> good = 0;
    std::vector<std::jthread> others;
    for (int guest = 1; guest <= guests; ++guest)
        others.emplace_back([&, guest] {
            HostLinks links;
            if (links.join(*invitation, guest, kLong) && meetOften(links, guest)) ++good;
        });
    ASSERT_TRUE(hub.welcome(numbers(guests), kLong));
    EXPECT_TRUE(meetOften(hub, 0));
    others.clear();
    EXPECT_EQ(good, guests);
}
INSTANTIATE_TEST_SUITE_P(Guests, HostLinksTest, testing::Values(1, 3, 7));

TEST(HostLinks, WhoWaitsDoesIdleWork) {
    Pair pair;
    ASSERT_TRUE(pair.joined);
    std::atomic<int> led = 0, followed = 0;
    std::thread follower([&] {
        while (led < 3) std::this_thread::yield();
        EXPECT_TRUE(pair.guest->follow({}, [&] { ++followed; }));
        while (led < 6) std::this_thread::yield();
        EXPECT_TRUE(pair.guest->follow({}, {}));
    });
    EXPECT_TRUE(pair.hub->lead({}, [&] { ++led; }));
    EXPECT_GE(led, 3);
    EXPECT_TRUE(pair.hub->lead({}, [&] { ++led; }));
    EXPECT_GE(led, 6);
    follower.join();
}

TEST(HostLinks, StrangersAreNotLetIn) {
    HostLinks hub, guest;
    const Result<std::string> invitation = hub.invite();
    ASSERT_TRUE(invitation);
    asio::io_context io;
    const tcp::endpoint door(asio::ip::address_v4::loopback(),
                             static_cast<std::uint16_t>(std::stoi(*invitation)));
    tcp::socket silent(io), guessing(io), leaving(io);
    silent.connect(door);
    guessing.connect(door);
    asio::write(guessing, asio::buffer(std::string(1000, '0')));
    leaving.connect(door);
    leaving.close();
    std::thread other([&] { EXPECT_TRUE(guest.join(*invitation, 7, kLong)); });
    EXPECT_TRUE(hub.welcome(std::vector{7}, kLong));
    other.join();
    asio::write(silent, asio::buffer(std::string(1000, '0')));  // too late to matter
    std::thread follower([&] { EXPECT_TRUE(guest.follow({}, {})); });
    EXPECT_TRUE(hub.lead({}, {}));
    follower.join();
}

TEST(HostLinks, GuestBelievesOnlyItsHub) {
    HostLinks hub, guest;
    const Result<std::string> invitation = hub.invite();
    ASSERT_TRUE(invitation);
    std::istringstream words(*invitation);
    std::string port, question, answer;
    words >> port >> question >> answer;
    asio::io_context io;
    tcp::acceptor impostor(io, tcp::endpoint(asio::ip::address_v4::loopback(), 0));
    std::jthread answers([&] {
        tcp::socket socket = impostor.accept();
        asio::write(socket, asio::buffer(std::string(answer.size(), '0')));
        std::string said(1, ' ');
        boost::system::error_code ended;
        while (!ended) asio::read(socket, asio::buffer(said), ended);
    });
    const std::uint16_t wrong = impostor.local_endpoint().port();
    const Result<void> fooled =
        guest.join(fmt::format("{} {} {} no-address 127.0.0.1", wrong, question, answer), 1, kShort);
    ASSERT_FALSE(fooled);
    EXPECT_EQ(
        fooled.error().message,
        fmt::format("cannot reach rank 0 by TCP at port {} of any of its addresses: no-address 127.0.0.1",
                    wrong));
}

TEST(HostLinks, HubNamesWhoDoesNotCome) {
    HostLinks hub, guest;
    const Result<std::string> invitation = hub.invite();
    ASSERT_TRUE(invitation);
    std::thread other([&] { EXPECT_TRUE(guest.join(*invitation, 3, kLong)); });
    const Result<void> welcomed = hub.welcome(std::vector{3, 5}, kShort);
    other.join();
    ASSERT_FALSE(welcomed);
    EXPECT_EQ(welcomed.error().message, "rank 5 has not connected by TCP within 300 ms");
}

TEST(HostLinks, LostConnectionIsAnError) {
    for (const bool hubGoes : {false, true}) {
        Pair pair;
        ASSERT_TRUE(pair.joined);
        (hubGoes ? pair.hub : pair.guest).reset();
        const Result<void> met = hubGoes ? pair.guest->follow({}, {}) : pair.hub->lead({}, {});
        ASSERT_FALSE(met);
        EXPECT_EQ(met.error().message.rfind("the connection to ", 0), 0u) << met.error().message;
        EXPECT_NE(met.error().message.find(" is lost: "), std::string::npos) << met.error().message;
    }
}

}  // namespace
}  // namespace iwalk
