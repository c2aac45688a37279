// A target's seeds, then copies of them with some bytes changed, cut or doubled;
// or, with `--seeds DIR`, the seeds as files for libFuzzer; or files named on the command line, to see again
// what libFuzzer has found.
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/fuzz/fuzz.hpp"

namespace {

constexpr int kRounds = 1500;  // a seed

void run(const std::string& input) {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

std::string damaged(const std::string& seed, std::mt19937_64& random) {
    static constexpr std::string_view kTelling = "0123456789-+.e/ \n\r\\#[]{}\",fvn\xff\x7f\x80";
    const auto below = [&](std::size_t end) { return static_cast<std::size_t>(random() % end); };
    std::string out = seed;
    for (std::size_t changes = 1 + below(8); changes > 0 && !out.empty(); --changes) {
        const std::size_t at = below(out.size()), length = std::min(1 + below(32), out.size() - at);
        switch (below(8)) {
            case 0:
                out.erase(at, length);
                break;
            case 1:
                out.insert(at, out.substr(at, length));
                break;
            case 2:
                out.resize(at);
                break;
            default:
                out[at] =
                    random() % 2 != 0 ? kTelling[below(kTelling.size())] : static_cast<char>(random() & 255);
        }
    }
    return out;
}

int writeSeeds(const std::string& directory) {
    int number = 0;
    for (const std::string& seed : iwalk::fuzzSeeds()) {
        std::ofstream file(fmt::format("{}/seed-{}", directory, number++), std::ios::binary);
        if (!(file << seed)) return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
    spdlog::set_level(spdlog::level::off);
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() == 2 && words[0] == "--seeds") return writeSeeds(words[1]);
    for (const std::string& name : words) {
        std::ifstream file(name, std::ios::binary);
        run(std::string(std::istreambuf_iterator<char>(file), {}));
    }
    if (!words.empty()) return EXIT_SUCCESS;
    std::mt19937_64 random(20261122);
    for (const std::string& seed : iwalk::fuzzSeeds()) {
        run(seed);
        for (int round = 0; round < kRounds; ++round) run(damaged(seed, random));
    }
    return EXIT_SUCCESS;
}
