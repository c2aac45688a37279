#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <string>

#include "common/version.hpp"
#include "tests/tools/levels/report.hpp"

namespace {

using namespace iwalk;
using namespace iwalk::levels;

constexpr int kWithin = 0, kNotWithin = 1, kError = 2;
constexpr const char* kDescription =
    "Judges the levels of a dataset by what is in its files, by other means than they were made.";
constexpr const char* kFooter = "Exit codes: 0 within what was asked, 1 not within it, 2 error.";

// The command line, as it was typed.
struct Options {
    std::string dataset;
    SampleOptions sampling;
    CrackOptions cracks;
    ViewOptions views;
    double limit = 1;
    bool json = false;
};

// Whether the dataset is within what was asked; prints the report.
Result<bool> runErrors(const DatasetPages& pages, const Options& options) {
    ASSIGN_OR_RETURN(const auto levels, measureErrors(pages, options.sampling));
    std::fputs((options.json ? errorsJson : errorsText)(levels, options.limit).c_str(), stdout);
    return largestRatio(levels) <= options.limit;
}

// Of the levels, in lattice steps.
std::vector<double> errorsOf(const DatasetPages& pages) {
    std::vector<double> errors;
    for (const LevelSummary& level : pages.manifest().levels)
        errors.push_back(std::ldexp(level.error, -pages.manifest().stepExponent));
    return errors;
}

Result<bool> runCracks(const DatasetPages& pages, const Options& options) {
    ASSIGN_OR_RETURN(RangeModel model, loadRangeModel(pages));
    const CrackReport report = countCracks(std::move(model), errorsOf(pages), options.cracks);
    std::fputs((options.json ? cracksJson : cracksText)(report, options.cracks).c_str(), stdout);
    return report.looseBoxes == 0 && report.openEdges == 0;
}

Result<bool> runViews(const DatasetPages& pages, const Options& options) {
    ASSIGN_OR_RETURN(const RangeModel model, loadRangeModel(pages));
    const ViewReport report = countHoles(model, errorsOf(pages), options.views);
    std::fputs((options.json ? viewsJson : viewsText)(report, options.views).c_str(), stdout);
    return report.holes == 0;
}

Result<bool> runSimplify(const DatasetPages& pages, const Options& options) {
    ASSIGN_OR_RETURN(const auto levels, raceSimplify(pages, options.sampling));
    std::fputs((options.json ? simplifyJson : simplifyText)(levels).c_str(), stdout);
    return true;
}

CLI::App* addCommand(CLI::App& app, const char* name, const char* description, Options& options) {
    CLI::App* command = app.add_subcommand(name, description);
    command->add_option("DATASET", options.dataset, "Directory of the dataset")->required();
    command->add_flag("--json", options.json, "Print the report as JSON");
    return command;
}

void addSampling(CLI::App* command, SampleOptions& sampling) {
    command->add_option("--samples", sampling.samples, "Points on each surface; more find rarer faults")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000'000}))
        ->capture_default_str();
    command->add_option("--seed", sampling.seed, "Of the random numbers")->capture_default_str();
}

void addErrors(CLI::App& app, Options& options) {
    CLI::App* command =
        addCommand(app, "errors", "Distances between each level, also half morphed, and the input", options);
    addSampling(command, options.sampling);
    command
        ->add_option("--limit", options.limit,
                     "Largest distance allowed, as a multiple of the level's stated error")
        ->capture_default_str();
}

void addCracks(CLI::App& app, Options& options) {
    CLI::App* command =
        addCommand(app, "cracks", "Open edges in cuts for random eyes and screen errors", options);
    command->add_option("--pairs", options.cracks.pairs, "Cuts")->capture_default_str();
    command->add_option("--seed", options.cracks.seed, "Of the random numbers")->capture_default_str();
    const std::map<std::string, Diagonals> diagonals{
        {"none", Diagonals::kNone}, {"levels", Diagonals::kLevels}, {"all", Diagonals::kLevelsAndInput}};
    command
        ->add_option(
            "--diagonals", options.cracks.diagonals,
            "Whose largest diagonals push the distances of levels out: none, levels (default) or all\n"
            "(the input's ranges too, for all levels that are finer than theirs)")
        ->transform(CLI::CheckedTransformer(diagonals))
        ->type_name("WHOSE");
    command->add_option("--min-error", options.cracks.minScreenError, "Least screen error, px")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command->add_option("--max-error", options.cracks.maxScreenError, "Greatest screen error, px")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
}

void addViews(CLI::App& app, Options& options) {
    CLI::App* command =
        addCommand(app, "views",
                   "Background that shows through cuts for random eyes and screen errors, by rays", options);
    command->add_option("--views", options.views.views, "Pictures")->capture_default_str();
    command->add_option("--seed", options.views.seed, "Of the random numbers")->capture_default_str();
    command->add_option("--size", options.views.size, "Width and height of a picture, px")
        ->check(CLI::Range(16, 4096))
        ->capture_default_str();
}

Result<bool> run(const CLI::App& app, const Options& options) {
    ASSIGN_OR_RETURN(const DatasetPages pages, DatasetPages::open(options.dataset));
    const std::string command = app.get_subcommands().front()->get_name();
    return (command == "errors"   ? runErrors
            : command == "cracks" ? runCracks
            : command == "views"  ? runViews
                                  : runSimplify)(pages, options);
}

int failed(const char* message, const char* advice = "") {
    std::fprintf(stderr, "iwalk-levels: %s%s\n", message, advice);
    return kError;
}

int runProgram(int argc, char** argv) {
    CLI::App app(kDescription, "iwalk-levels");
    app.set_version_flag("--version", kVersion);
    app.footer(kFooter);
    app.require_subcommand(1);
    Options options;
    addErrors(app, options);
    addCracks(app, options);
    addViews(app, options);
    addSampling(addCommand(app, "simplify",
                           "Triangles of each level against meshoptimizer's at the same true error", options),
                options.sampling);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return failed(error.what(), "; see --help");
    }
    const Result<bool> within = run(app, options);
    if (!within) return failed(within.error().message.c_str());
    return *within ? kWithin : kNotWithin;
}

}  // namespace

int main(int argc, char** argv) try {
    return runProgram(argc, argv);
} catch (const std::exception& error) {  // no memory for the model, for instance
    return failed(error.what());
}
