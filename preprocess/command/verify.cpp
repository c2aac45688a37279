#include "preprocess/build/verify.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/settings.hpp"
#include "preprocess/command/commands.hpp"
#include "preprocess/command/progress_bar.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kShownProblems = 20;

void printJson(const Verification& result) {
    nlohmann::ordered_json json;
    json["good"] = result.problems.empty();
    json["pages"] = result.pages;
    json["triangles"] = result.triangles;
    json["bytes"] = result.bytes;
    json["problems"] = result.problems;
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace

Result<void> runVerify(const std::string& dataset, bool json) {
    Result<Verification> result = [&] {
        ProgressBar progress;
        return verifyDataset(dataset, progress);
    }();
    if (!result) return result.error();
    if (json) printJson(*result);
    if (result->problems.empty()) {
        if (!json) {
            fmt::print("good: {} pages, {} triangles, {}\n", result->pages, result->triangles,
                       formatBytes(result->bytes));
        }
        return {};
    }
    if (result->problems.size() == 1) return fail("{}; build the dataset again", result->problems[0]);
    for (std::size_t i = 0; i < std::min(result->problems.size(), kShownProblems); ++i) {
        fmt::print(stderr, "iwalk-preprocess: {}\n", result->problems[i]);
    }
    return fail("{}: {} problems found: build the dataset again", dataset, result->problems.size());
}

}  // namespace iwalk
