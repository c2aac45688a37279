#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>

#include "common/result.hpp"

namespace iwalk::client {

// Where a server listens.
struct Address {
    std::string host;  // a name or an IP address, without brackets
    std::uint16_t port = 0;
};
// "HOST:PORT" or "[IPv6]:PORT".
Result<Address> parseAddress(const std::string& text);

enum class Pace : std::uint8_t {
    lockstep,  // every frame of the path is drawn, none twice
    realtime,  // by the clock; what is late is dropped
};

// What the command line asks for.
struct Options {
    Address server;
    std::string tokenFile;   // of the secret that the server asks for; empty: none
    std::string path;        // camera path to play, JSON; empty: fly by hand
    std::string captureDir;  // empty: no pictures
    bool captureDepth = false;
    std::string report;  // file; empty: none
    Pace pace = Pace::lockstep;
    double fps = 30;             // frames of the path per second; realtime only
    double timeoutSeconds = 10;  // to reach the server, and then to be given control

    // Of flying by hand.
    std::string record;                      // camera path to write; empty: none
    std::string views = "iwalk-views.json";  // saved views
    glm::dvec3 up{0, 0, 1};                  // the model's
    std::optional<double> fovY;              // degrees, of the whole wall; else what the wall shows
    bool preview = true;
};

}  // namespace iwalk::client
