#include "server/options.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <map>

#include "common/version.hpp"

namespace iwalk {
namespace {

constexpr const char* kDefaultListen = "127.0.0.1:7117";

// "ADDR:PORT", with the address in brackets if it is IPv6.
Result<void> parseListen(const std::string& text, ServerOptions& options) {
    const std::size_t colon = text.rfind(':');
    std::uint16_t port = 0;
    const char* const end = text.data() + text.size();
    if (colon == std::string::npos || colon == 0 || colon + 1 == text.size() ||
        std::from_chars(text.data() + colon + 1, end, port).ptr != end)
        return fail("--listen wants ADDRESS:PORT, as in {}, not '{}'", kDefaultListen, text);
    options.address = text.substr(0, colon);
    if (options.address.size() > 2 && options.address.front() == '[' && options.address.back() == ']')
        options.address = options.address.substr(1, options.address.size() - 2);
    options.port = port;
    return {};
}

}  // namespace

CommandLine parseCommandLine(int argc, char** argv, ServerOptions& options, std::string& message) {
    CLI::App app(
        "Draws a wall, each MPI rank one tile, or several of them where there are fewer ranks than tiles:\n"
        "  mpirun -np RANKS iwalk-server --dataset DATASET --wall WALL.toml");
    app.option_defaults()->always_capture_default();
    app.set_version_flag("--version", std::string("iwalk-server ") + kVersion);
    std::string listen = kDefaultListen, present = "none", patternName;
    std::map<std::string, std::string> given;
    const std::map<std::string, Pattern> patterns{{"", Pattern::none},
                                                  {"grid", Pattern::grid},
                                                  {"blend", Pattern::blend},
                                                  {"identity", Pattern::identity}};
    app.add_option("--dataset", options.dataset, "directory that iwalk-preprocess made; every rank reads it")
        ->type_name("DIR");
    app.add_option(
           "--wall", options.wallFile,
           "TOML file of the wall; ranks share its tiles in order, or each host's ranks those that name it")
        ->required()
        ->type_name("FILE");
    app.add_option("--listen", listen, "where rank 0 waits for clients; port 0 takes any free one")
        ->type_name("ADDR:PORT");
    app.add_option("--token-file", options.tokenFile,
                   "file with a secret that clients must have, too; needed where others than this machine "
                   "can reach the address")
        ->type_name("FILE");
    app.add_option(
           "--present", present,
           "where finished tiles go: none (clients may still capture), file (PNG), or window: on X displays, "
           "as the wall file says; Escape ends the wall")
        ->check(CLI::IsMember({"none", "file", "window"}))
        ->type_name("none|file|window");
    app.add_option("--out", options.outputDirectory, "for --present file: writes DIR/frame-000000/TILE.png")
        ->type_name("DIR");

    app.add_option(
           "--resume", options.resumeFile,
           "rank 0 keeps the wall's last camera and the settings that clients have changed in this file, and "
           "begins with them when it is there; it touches the file once a second while all ranks live")
        ->type_name("FILE");
    app.add_option(
           "--startup-timeout", options.startTimeout,
           "when not all ranks are ready after so many seconds, says who is missing and ends the wall; more "
           "for slow disks")
        ->check(CLI::Range(1, 86400))
        ->type_name("SECONDS");
    app.add_option("--pattern", patternName,
                   "shows a test pattern instead of a dataset, with --present window or file: grid (lines "
                   "and circles "
                   "across the wall), blend (grey bands), identity (names of tiles)")
        ->check(CLI::IsMember({"grid", "blend", "identity"}))
        ->type_name("grid|blend|identity")
        ->default_str("");
    app.add_flag("--tiles", options.tilesOnly,
                 "prints how many tiles the wall has, and so ranks at the most, and ends");

    for (const SettingInfo& setting : settingTable())
        app.add_option(std::string("--") + setting.name, given[setting.name], setting.help)
            ->type_name(setting.form)
            ->group("Settings")
            ->default_str(settingText(options.settings, setting.name));
    try {
        app.parse(argc, argv);
        options.pattern = patterns.at(patternName);
        const bool pattern = options.pattern != Pattern::none;
        if (options.dataset.empty() && !options.tilesOnly && !pattern) throw CLI::RequiredError("--dataset");
        if (Result<void> parsed = parseListen(listen, options); !parsed)
            throw CLI::ValidationError(parsed.error().message);
        if ((present == "file") == options.outputDirectory.empty())
            throw CLI::ValidationError("--present file and --out DIR go together");
        if (pattern && (present == "none" || !options.dataset.empty()))
            throw CLI::ValidationError("--pattern wants --present window or file, and no dataset");
        options.window = present == "window";
        for (const auto& [name, text] : given) {
            if (text.empty()) continue;
            options.given.emplace_back(name, text);
            if (Result<void> set = setSetting(options.settings, name, text); !set)
                throw CLI::ValidationError(set.error().message);
        }
    } catch (const CLI::Success& success) {
        std::ostringstream out;
        app.exit(success, out, out);
        message = out.str();
        return CommandLine::done;
    } catch (const CLI::ParseError& error) {
        message = std::string("iwalk-server: ") + error.what() + " (--help tells more)\n";
        return CommandLine::wrong;
    }
    return CommandLine::run;
}

Result<void> readWallFile(ServerOptions& options) {
    ASSIGN_OR_RETURN(options.wall, loadWall(options.wallFile));
    options.settings = {};
    for (const auto* list : {&options.wall.settings, &options.given})
        for (const auto& [name, text] : *list) RETURN_IF_ERROR(setSetting(options.settings, name, text));
    return {};
}

}  // namespace iwalk
