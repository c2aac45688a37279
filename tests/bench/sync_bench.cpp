// How long the wall's barrier takes, how far apart ranks leave it, and what waiting at it costs:
//   mpirun -np N iwalk-sync-bench
// All ranks on one host, whose clock they share.

#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <thread>

#include "server/sync/sync.hpp"

namespace {

using namespace iwalk;
using Clock = std::chrono::steady_clock;
using Ms = std::chrono::duration<double, std::milli>;

struct Options {
    int rounds = 300;
    double frameMs = 10, lateMs = 20;
};

double nowMs() {
    return Ms(Clock::now().time_since_epoch()).count();
}

// Of all threads of this process.
double cpuMs() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto ms = [](const timeval& t) {
        return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
    };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
}

struct Passage {
    double arrival = 0, departure = 0;  // ms of the host's steady clock
};

struct Spread {
    double median = 0, p99 = 0;
};
Spread spreadOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return {values[values.size() / 2], values[values.size() * 99 / 100]};
}

// Every rank's values of what this one has, by rank.
std::vector<Passage> gather(Sync& sync, const Passage& mine) {
    std::vector<Passage> all;
    for (const std::string& text : sync.gatherText(fmt::format("{} {}", mine.arrival, mine.departure))) {
        char* rest = nullptr;
        const double first = std::strtod(text.c_str(), &rest);
        all.push_back({first, std::strtod(rest, nullptr)});
    }
    return all;
}

template <class Work>
std::vector<Passage> pass(Sync& sync, int rounds, Work work) {
    std::vector<Passage> passages(static_cast<std::size_t>(rounds));
    sync.barrier();
    for (int round = 0; round < rounds; ++round) {
        std::this_thread::sleep_for(Ms(work(round)));
        Passage& passage = passages[static_cast<std::size_t>(round)];
        passage.arrival = nowMs();
        sync.barrier();
        passage.departure = nowMs();
    }
    return passages;
}

void printTimes(Sync& sync, const char* name, const std::vector<Passage>& mine) {
    std::vector<double> takes, skews;
    for (const Passage& passage : mine) {
        double lastArrival = 0, firstDeparture = 1e300, lastDeparture = 0;
        for (const Passage& one : gather(sync, passage)) {
            lastArrival = std::max(lastArrival, one.arrival);
            firstDeparture = std::min(firstDeparture, one.departure);
            lastDeparture = std::max(lastDeparture, one.departure);
        }
        takes.push_back(lastDeparture - lastArrival);
        skews.push_back(lastDeparture - firstDeparture);
    }
    const Spread take = spreadOf(takes), skew = spreadOf(skews);
    if (sync.rank() == 0)
        std::printf(
            "ranks %d, %s: last arrival to last departure %.3f ms median, %.3f ms 99 %%; first to last "
            "departure %.3f ms median, %.3f ms 99 %%\n",
            sync.size(), name, take.median, take.p99, skew.median, skew.p99);
}

void run(Sync& sync, const Options& options) {
    // Frames of about the same length, as the tiles of a wall have them.
    std::mt19937 random(static_cast<unsigned>(sync.rank()) + 1);
    std::uniform_real_distribution<double> frame(0.75 * options.frameMs, 1.25 * options.frameMs);
    printTimes(sync, "alike", pass(sync, options.rounds, [&](int) { return frame(random); }));

    // The last rank is late, the others are there at once and wait.
    const bool late = sync.rank() + 1 == sync.size();
    const double cpu = cpuMs(), start = nowMs();
    const std::vector<Passage> passages =
        pass(sync, options.rounds, [&](int) { return late ? options.lateMs : 0; });
    const double share = 100 * (cpuMs() - cpu) / (nowMs() - start);
    printTimes(sync, "one late", passages);
    std::vector<double> waiting;
    for (const Passage& one : gather(sync, {share, 0})) waiting.push_back(one.arrival);
    waiting.pop_back();
    if (sync.rank() == 0)
        std::printf(
            "ranks %d, one late by %.0f ms: waiting ranks use %.1f %% of a core, at the most %.1f %%\n",
            sync.size(), options.lateMs, spreadOf(waiting).median,
            *std::max_element(waiting.begin(), waiting.end()));
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures the barrier of a wall: mpirun -np N iwalk-sync-bench, N from 2, on one host.");
    Options options;
    app.add_option("--rounds", options.rounds, "frames of each kind, default 300")
        ->check(CLI::Range(10, 100000));
    app.add_option("--frame-ms", options.frameMs, "a frame's length, +- 25 %, default 10")
        ->check(CLI::Range(0.0, 1000.0));
    app.add_option("--late-ms", options.lateMs, "then one rank is late by so much, default 20")
        ->check(CLI::Range(0.0, 1000.0));
    CLI11_PARSE(app, argc, argv);
    const Result<std::unique_ptr<Sync>> sync = startMpi(argc, argv, 120);
    if (!sync || (*sync)->size() < 2) {
        std::fprintf(
            stderr, "iwalk-sync-bench: %s\n",
            sync ? "one rank waits for nobody: mpirun -np 2, or more" : sync.error().message.c_str());
        return EXIT_FAILURE;
    }
    run(**sync, options);
    return EXIT_SUCCESS;
}
