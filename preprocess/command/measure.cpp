#include <fmt/format.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "preprocess/build/budget.hpp"
#include "preprocess/build/inputs.hpp"
#include "preprocess/build/reading_threads.hpp"
#include "preprocess/command/commands.hpp"

namespace iwalk {
namespace {

using nlohmann::ordered_json;

ordered_json toJson(const std::string& input, const ImportSummary& summary) {
    ordered_json json{{"input", input},
                      {"vertices", summary.vertices},
                      {"triangles_at_most", summary.triangleBound},
                      {"colors", summary.colors},
                      {"normals", summary.normals}};
    if (!summary.bounds.empty()) {
        const glm::dvec3 &low = summary.bounds.min, &high = summary.bounds.max;
        json["bounds"] = {{"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}};
    }
    return json;
}

void print(const std::string& input, const ImportSummary& summary) {
    const glm::dvec3 &low = summary.bounds.min, &high = summary.bounds.max;
    fmt::print("{}: {} vertices{}{}", input, summary.vertices, summary.colors ? ", colours" : "",
               summary.normals ? ", normals" : "");
    if (!summary.bounds.empty()) {
        fmt::print(", ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})", low.x, low.y, low.z, high.x, high.y, high.z);
    }
    fmt::print("\n");
}

}  // namespace

Result<void> runMeasure(const BuildOptions& options, bool json) {
    BuildOptions one = options;
    ASSIGN_OR_RETURN(const std::vector<std::string> inputs, findInputs(options.inputs));
    ASSIGN_OR_RETURN(const Budget budget, makeBudget(options));
    ReadingThreads threads(budget.threads);
    const char* const temporary = std::getenv("TMPDIR");
    ordered_json all = ordered_json::array();
    for (const std::string& input : inputs) {
        one.inputs = {input};
        Inputs file(one, budget, temporary != nullptr ? temporary : "/tmp", openImporter);
        ASSIGN_OR_RETURN(const auto summaries, threads.lead([&] { return file.scan({}, {}); }));
        json ? all.push_back(toJson(input, summaries[0])) : print(input, summaries[0]);
    }
    if (json) fmt::print("{}\n", all.dump(1));
    return {};
}

}  // namespace iwalk
