#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "client/client.hpp"
#include "client/fly/navigator.hpp"
#include "client/progress.hpp"
#include "client/window/window.hpp"
#include "common/version.hpp"

namespace {

namespace client = iwalk::client;

constexpr int kFailure = 1, kUsage = 2;

int complain(const std::string& message, int code) {
    std::fprintf(stderr, "iwalk-client: %s\n", message.c_str());
    return code;
}

// What makes sense with a window only.
void addFlyingOptions(CLI::App& app, CLI::Option* path, client::Options& options) {
    const char* const group = "By hand";
    app.add_option("--record", options.record, "records the flight as a camera path, 30 frames a second")
        ->type_name("PATH.json")
        ->group(group)
        ->excludes(path);
    app.add_option("--views", options.views, "saved views, default iwalk-views.json")
        ->type_name("FILE")
        ->group(group)
        ->excludes(path);
    app.add_option_function<std::string>(
           "--up",
           [&options](const std::string& text) {
               const auto up = client::parseUp(text);
               if (!up) throw CLI::ValidationError("--up", up.error().message);
               options.up = *up;
           },
           "which way is up in the model: x, y, z (default), -x, -y or -z")
        ->type_name("AXIS")
        ->group(group)
        ->excludes(path);
    app.add_option(
           "--fov", options.fovY,
           "vertical field of view of the whole wall, degrees, default what the wall shows already, or 60")
        ->type_name("DEGREES")
        ->group(group)
        ->excludes(path)
        ->check(CLI::Range(1.1, 178.9).description(""));
    app.add_flag_callback(
           "--no-preview", [&options] { options.preview = false; },
           "begin without small pictures of the wall (V turns them on)")
        ->group(group)
        ->excludes(path);
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
    app.add_option("--token-file", options.tokenFile, "file with the secret that the server has, too")
        ->type_name("FILE");
    auto* path =
        app.add_option("--path", options.path,
                       "plays this camera path, JSON, without a window; else a window opens to fly by hand")
            ->type_name("PATH.json");
    auto* capture = app.add_option("--capture", options.captureDir,
                                   "write the tiles of every frame and the stitched wall as PNG below DIR")
                        ->type_name("DIR")
                        ->needs(path);
    app.add_flag("--capture-depth", options.captureDepth,
                 "write the depth of every tile too: EXR, one float channel Z, model units from the eye")
        ->needs(capture);
    app.add_option("--report", options.report, "write frame times and counters as JSON")
        ->type_name("FILE")
        ->needs(path);
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
        ->type_name("lockstep|realtime")
        ->needs(path);
    app.add_option("--fps", options.fps, "frames of the path per second with --pace realtime, default 30")
        ->type_name("N")
        ->needs(path)
        ->check(CLI::Range(0.01, 1000.0).description(""));
    app.add_option(
           "--timeout", options.timeoutSeconds,
           "seconds to keep trying to reach the server, and then to wait for control of the wall, default 10")
        ->type_name("SECONDS")
        ->needs(path)
        ->check(CLI::Range(0.1, 86400.0).description(""));
    addFlyingOptions(app, path, options);
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
    CLI::App app("Flies an iWalk wall by hand, or plays a camera path on it and saves what the wall shows.");
    client::Options options;
    addOptions(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        return complain(std::string(error.what()) + "; see iwalk-client --help", kUsage);
    }
    if (!options.path.empty()) return play(options);
    const iwalk::Result<void> flown = client::flyByHand(options);
    return flown ? 0 : complain(flown.error().message, kFailure);
} catch (const std::exception& error) {
    return complain(error.what(), kFailure);
}
