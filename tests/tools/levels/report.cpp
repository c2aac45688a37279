#include "tests/tools/levels/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace iwalk::levels {
namespace {

using nlohmann::ordered_json;

// A deviation's three samples by name.
template <class Use>
void forSpreads(const Deviation& deviation, const Use& use) {
    use("full to it", "from_full", deviation.fromFull);
    use("it to full", "to_full", deviation.toFull);
    use("its lines to full", "lines_to_full", deviation.linesToFull);
}

std::string rows(const char* surface, const Deviation& deviation) {
    std::string text;
    forSpreads(deviation, [&](const char* name, const char*, const Spread& s) {
        text += fmt::format("    {:<11}{:<19}{:9.4f}{:9.4f}{:9.4f}{:9.4f}\n", surface, name, s.median, s.p99,
                            s.p999, s.max);
    });
    return text;
}

ordered_json toJson(const Deviation& deviation) {
    ordered_json json;
    forSpreads(deviation, [&](const char*, const char* key, const Spread& s) {
        json[key] = {{"median", s.median}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
    });
    return json;
}

std::string printed(const ordered_json& json) {
    return json.dump(2) + "\n";
}

double share(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

double largestRatio(const std::vector<LevelErrors>& levels) {
    double largest = 0;
    for (const LevelErrors& level : levels)
        largest = std::max({largest, level.whole.largest(), level.halfMorph.largest()});
    return largest;
}

std::string errorsText(const std::vector<LevelErrors>& levels, double limit) {
    std::string text = "Sampled distances as multiples of the stated error\n";
    for (const LevelErrors& level : levels) {
        text += fmt::format("level {}: {} triangles, stated error {:.6g}\n", level.level, level.triangles,
                            level.error);
        text += fmt::format("    {:<30}{:>9}{:>9}{:>9}{:>9}\n", "", "median", "99 %", "99.9 %", "largest");
        text += rows("level", level.whole) + rows("half-morph", level.halfMorph);
    }
    const double largest = largestRatio(levels);
    return text + fmt::format("largest: {:.4f}, {} the limit of {}\n", largest,
                              largest <= limit ? "within" : "beyond", limit);
}

std::string errorsJson(const std::vector<LevelErrors>& levels, double limit) {
    ordered_json json{{"largest", largestRatio(levels)}, {"limit", limit}, {"levels", ordered_json::array()}};
    for (const LevelErrors& level : levels) {
        json["levels"].push_back({{"level", level.level},
                                  {"triangles", level.triangles},
                                  {"error", level.error},
                                  {"whole", toJson(level.whole)},
                                  {"half_morph", toJson(level.halfMorph)}});
    }
    return printed(json);
}

std::string cracksText(const CrackReport& r, const CrackOptions& options) {
    std::string text =
        fmt::format("input: {} triangles, {} open edges\n", r.full.triangles, r.full.openEdges);
    text += fmt::format("{} cuts: {} of 2 levels, {} of 3 or more; {:.0f} triangles on average ({} to {})\n",
                        options.pairs, r.twoLevels, r.moreLevels, share(r.triangles, options.pairs),
                        r.leastTriangles, r.mostTriangles);
    text += fmt::format("cracks: {} open edges, in {} cuts\n", r.openEdges, r.openCuts);
    if (r.vanished > 0)
        text += fmt::format("{} ranges' triangles are all gone at the next coarser level\n", r.vanished);
    if (r.looseBoxes > 0)
        text += fmt::format("{} ranges' boxes are not inside that of the coarser range\n", r.looseBoxes);
    return text;
}

std::string cracksJson(const CrackReport& r, const CrackOptions& options) {
    return printed({{"pairs", options.pairs},
                    {"seed", options.seed},
                    {"input", {{"triangles", r.full.triangles}, {"open_edges", r.full.openEdges}}},
                    {"open_edges", r.openEdges},
                    {"open_cuts", r.openCuts},
                    {"cuts_of_2_levels", r.twoLevels},
                    {"cuts_of_more_levels", r.moreLevels},
                    {"triangles", r.triangles},
                    {"least_triangles", r.leastTriangles},
                    {"most_triangles", r.mostTriangles},
                    {"vanished", r.vanished},
                    {"loose_boxes", r.looseBoxes}});
}

std::string viewsText(const ViewReport& r, const ViewOptions& options) {
    return fmt::format("{} views, {:.0f} triangles on average: {} of {} covered pixels show the background\n",
                       options.views, share(r.triangles, options.views), r.holes, r.covered);
}

std::string viewsJson(const ViewReport& r, const ViewOptions& options) {
    return printed({{"views", options.views},
                    {"seed", options.seed},
                    {"size", options.size},
                    {"triangles", r.triangles},
                    {"covered", r.covered},
                    {"holes", r.holes}});
}

std::string simplifyText(const std::vector<SimplifyRace>& levels) {
    std::string text = "Triangles at equal true error (99.9 % of sampled distances, in stated errors)\n";
    text += fmt::format("{:>5}{:>12}{:>10}{:>14}{:>8}\n", "level", "triangles", "error", "meshoptimizer",
                        "ratio");
    for (const SimplifyRace& level : levels) {
        text +=
            fmt::format("{:>5}{:>12}{:>10.4f}{:>14}{:>8.3f}{}\n", level.level, level.triangles, level.p999,
                        level.theirTriangles, level.ratio(), level.stuck ? "  theirs goes no lower" : "");
    }
    return text;
}

std::string simplifyJson(const std::vector<SimplifyRace>& levels) {
    ordered_json json{{"levels", ordered_json::array()}};
    for (const SimplifyRace& level : levels) {
        json["levels"].push_back({{"level", level.level},
                                  {"triangles", level.triangles},
                                  {"p999", level.p999},
                                  {"meshoptimizer_triangles", level.theirTriangles},
                                  {"ratio", level.ratio()},
                                  {"stuck", level.stuck}});
    }
    return printed(json);
}

}  // namespace iwalk::levels
