#pragma once

#include <cstdint>
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
    std::string path;        // camera path to play, JSON
    std::string captureDir;  // empty: no pictures
    bool captureDepth = false;
    std::string report;  // file; empty: none
    Pace pace = Pace::lockstep;
    double fps = 30;             // frames of the path per second; realtime only
    double timeoutSeconds = 10;  // to reach the server, and then to be given control
};

}  // namespace iwalk::client
