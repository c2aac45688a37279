#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "common/settings.hpp"
#include "server/present/patterns.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// What a server's command line and wall file say.
struct ServerOptions {
    std::string dataset, wallFile;
    std::string address = "127.0.0.1";  // to listen at (rank 0)
    std::uint16_t port = 0;             // 0: any free one
    std::string tokenFile;              // of the secret that clients must bring; empty: none
    std::string outputDirectory;        // of --present file; empty: tiles are not written
    std::string resumeFile;             // empty: none
    int startTimeout = 120;             // s
    bool window = false;                // --present window
    Pattern pattern = Pattern::none;    // instead of a dataset
    bool tilesOnly = false;             // just say how many tiles the wall has
    Settings settings;
    Wall wall;
    std::vector<std::pair<std::string, std::string>>
        given;  // settings on the command line: name, value as text
};

enum class CommandLine { run, done, wrong };

// Reads the command line; texts for the reader (help, version, what is wrong) go to `message`. With `run` the
// options are complete but for the wall file, which is read by readWallFile().
CommandLine parseCommandLine(int argc, char** argv, ServerOptions& options, std::string& message);

// Loads the wall. Its [settings] count where the command line says nothing.
Result<void> readWallFile(ServerOptions& options);

}  // namespace iwalk
