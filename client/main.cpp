#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "client/client.hpp"
#include "client/progress.hpp"
#include "common/version.hpp"

namespace {

namespace client = iwalk::client;

constexpr int kFailure = 1, kUsage = 2;

int complain(const std::string& message, int code) {
    std::fprintf(stderr, "iwalk-client: %s\n", message.c_str());
    return code;
}

void addOptions(CLI::App& app, client::Options& options) {
    app.set_version_flag("--version", std::string("iwalk-client ") + iwalk::kVersion);
    app.add_option_function<std::string>(
           "--connect",
           [&options](const std::string& text) {
               const auto address = client::parseAddress(text);
               if (!address) throw CLI::ValidationError("--connect", address.error().message);
               options.server = *address;
           },
           "where the server listens")
        ->type_name("HOST:PORT")
        ->required();
    app.add_option("--path", options.path, "camera path to play, JSON")->type_name("PATH.json")->required();
    auto* capture = app.add_option("--capture", options.captureDir,
                                   "write the tiles of every frame and the stitched wall as PNG below DIR")
                        ->type_name("DIR");
    app.add_flag("--capture-depth", options.captureDepth,
                 "write the depth of every tile too: EXR, one float channel Z, model units from the eye")
        ->needs(capture);
    app.add_option("--report", options.report, "write frame times and counters as JSON")->type_name("FILE");
    app.add_option_function<std::string>(
           "--pace",
           [&options](const std::string& text) {
               if (text != "lockstep" && text != "realtime") {
                   throw CLI::ValidationError("--pace", "choose lockstep or realtime");
               }
               options.pace = text == "lockstep" ? client::Pace::lockstep : client::Pace::realtime;
           },
           "lockstep (default): every frame of the path is drawn, none twice; realtime: by the clock, what "
           "is "
           "late is dropped")
        ->type_name("lockstep|realtime");
    app.add_option("--fps", options.fps, "frames of the path per second with --pace realtime, default 30")
        ->type_name("N")
        ->check(CLI::Range(0.01, 1000.0).description(""));
    app.add_option(
           "--timeout", options.timeoutSeconds,
           "seconds to keep trying to reach the server, and then to wait for control of the wall, default 10")
        ->type_name("SECONDS")
        ->check(CLI::Range(0.1, 86400.0).description(""));
}

int play(const client::Options& options) {
    iwalk::Result<std::string> done = iwalk::fail("");
    {
        client::TerminalProgress progress;
        done = client::run(options,
                           [&](std::size_t played, std::size_t total) { progress.show(played, total); });
    }
    if (!done) return complain(done.error().message, kFailure);
    std::printf("%s\n", done->c_str());
    return 0;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Plays a camera path on an iWalk wall, and saves what the wall shows.");
    client::Options options;
    addOptions(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        return complain(std::string(error.what()) + "; see iwalk-client --help", kUsage);
    }
    return play(options);
} catch (const std::exception& error) {
    return complain(error.what(), kFailure);
}
