// What iwalk-preprocess starts for files that libraries read. It may crash: nobody depends on it but the
// file.
#include <fmt/format.h>
#include <malloc.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fstream>

#include "common/version.hpp"
#include "preprocess/import/foreign/image_reader.hpp"
#include "preprocess/import/foreign/scene_reader.hpp"

namespace {

using namespace iwalk;

constexpr int kFailure = 1, kUsage = 2;

struct Limits {
    std::uint64_t memory = std::uint64_t{1} << 30, file = std::uint64_t{64} << 30;
    std::uint64_t seconds = 600;
};

// Addresses that are taken already, by libraries for the most part.
std::uint64_t mappedBytes() {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limit(int what, std::uint64_t value) {
    const rlimit limits{value, value};
    ::setrlimit(static_cast<__rlimit_resource>(what), &limits);
}

void setLimits(const Limits& limits) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    // A heap for all threads: each of its own would take 64 MB of addresses, and the libraries have threads.
    ::mallopt(M_ARENA_MAX, 1);
    std::signal(SIGXFSZ, SIG_IGN);  // writing fails instead
    limit(RLIMIT_AS, mappedBytes() + limits.memory);
    limit(RLIMIT_CPU, limits.seconds);
    limit(RLIMIT_FSIZE, limits.file);
    limit(RLIMIT_CORE, 0);
}

int run(int argc, char** argv) {
    CLI::App app(
        "Reads a model or an image of heights for iwalk-preprocess, under limits, and writes triangles or "
        "heights to standard output.",
        "iwalk-import");
    app.set_version_flag("--version", std::string("iwalk-import ") + kVersion);
    Limits limits;
    std::string input;
    bool heights = false;
    app.add_option("input", input, "File to read")->required()->type_name("INPUT");
    app.add_option("--memory", limits.memory, "Bytes of memory, besides the program itself")
        ->capture_default_str();
    app.add_option("--file", limits.file, "Bytes that it may write")->capture_default_str();
    app.add_option("--seconds", limits.seconds, "Time of a processor, in seconds")->capture_default_str();
    app.add_flag("--heights", heights, "The input is an image of heights");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "iwalk-import: {} (see --help)\n", error.what());
        return kUsage;
    }
    setLimits(limits);
    ExchangeWriter out(STDOUT_FILENO);
    Result<void> done;
    try {
        done = heights ? exportHeights(input, out) : exportScene(input, out);
    } catch (const std::bad_alloc&) {
        done = fail("takes more than {} MB of memory to read: give more --memory", limits.memory >> 20);
    } catch (const std::exception& exception) {
        done = fail("cannot be read: {}", exception.what());
    }
    std::fflush(stdout);
    if (!done) fmt::print(stderr, "iwalk-import: {}\n", done.error().message);
    // What the libraries have to tidy up is of no interest any more.
    std::fflush(stderr);
    ::_exit(done ? 0 : kFailure);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& exception) {
        fmt::print(stderr, "iwalk-import: {}\n", exception.what());
        return kFailure;
    }
}
