#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "common/version.hpp"
#include "tests/tools/compare.hpp"
#include "tests/tools/compare_limits.hpp"
#include "tests/tools/compare_report.hpp"

namespace {

using namespace iwalk;
using namespace iwalk::tools;

constexpr int kWithin = 0, kNotWithin = 1, kError = 2;
constexpr double kMaxTolerance = 1000;  // px
constexpr const char* kDescription =
    "Compares two pictures of the same view.\n"
    "Without --tolerance they must be identical: no pixel may differ in colour or, with --depth, in the bits "
    "of its\n"
    "depth. With --tolerance the depth of each pixel must be one that the reference shows nearby.\n"
    "MAX is a number of pixels (12) or a share of all pixels (0.5%).";
constexpr const char* kFooter =
    "Exit codes: 0 within what was asked, 1 not within it, 2 error.\n"
    "PNG: RGB of 8 bits. EXR: one float channel Z, eye-space depth in model units, 0 where there is no "
    "surface.";

// The command line, as it was typed.
struct Options {
    std::string reference, test;
    std::vector<std::string> depth;
    std::optional<double> tolerance;
    double depthSlack = 0;
    std::optional<std::string> different, ties, outside, seeThrough;
    bool json = false;
};

void addOptions(CLI::App& app, Options& options) {
    app.set_version_flag("--version", kVersion);
    app.footer(kFooter);
    app.add_option("REFERENCE", options.reference, "PNG that is right")->required();
    app.add_option("TEST", options.test, "PNG to judge")->required();
    app.add_option("--depth", options.depth, "Depth of the two, as EXR")
        ->expected(2)
        ->type_name("REFERENCE TEST");
    app.add_option(
           "--tolerance", options.tolerance,
           "Pixels (0 to 1000, fractions are rounded up) that a surface may be displaced: a pixel's depth\n"
           "must lie between the least and the greatest depth of the reference so far around. Needs --depth")
        ->type_name("PX");
    app.add_option(
           "--depth-slack", options.depthSlack,
           "With --tolerance: widen that range by this share of its depth, 0 (default) to 1; covers rounding")
        ->type_name("SHARE");
    app.add_option("--different", options.different,
                   "Pixels that may differ in colour or depth bits; default 0, with --tolerance: any")
        ->type_name("MAX");
    app.add_option(
           "--ties", options.ties,
           "Pixels of equal depth bits that may have another colour; default: they count as different.\n"
           "Needs --depth")
        ->type_name("MAX");
    app.add_option("--outside", options.outside,
                   "With --tolerance: pixels that may be outside the range; default 0")
        ->type_name("MAX");
    app.add_option(
           "--see-through", options.seeThrough,
           "With --tolerance: pixels that may be farther than the range (holes, missing parts); default: as\n"
           "many as --outside")
        ->type_name("MAX");
    app.add_flag("--json", options.json, "Print the report as JSON");
}

Result<void> checkOptions(const Options& options) {
    if (options.tolerance && !(*options.tolerance >= 0 && *options.tolerance <= kMaxTolerance)) {
        return fail("--tolerance must be from 0 to {} pixels", kMaxTolerance);
    }
    if (!(options.depthSlack >= 0 && options.depthSlack <= 1))
        return fail("--depth-slack must be from 0 to 1");
    if (options.depth.empty() && (options.tolerance || options.ties)) {
        return fail("--tolerance and --ties compare depths: add --depth REFERENCE.exr TEST.exr");
    }
    if (!options.tolerance && (options.outside || options.seeThrough || options.depthSlack != 0)) {
        return fail("--outside, --see-through and --depth-slack go with --tolerance PX");
    }
    return {};
}

Result<std::optional<PixelLimit>> parseLimit(const char* option, const std::optional<std::string>& text) {
    if (!text) return std::optional<PixelLimit>();
    const auto limit = parsePixelLimit(*text);
    if (!limit) return fail("{}: {}", option, limit.error().message);
    return std::optional(*limit);
}

Result<Limits> limitsOf(const Options& options) {
    Limits limits;
    ASSIGN_OR_RETURN(limits.different, parseLimit("--different", options.different));
    ASSIGN_OR_RETURN(limits.ties, parseLimit("--ties", options.ties));
    ASSIGN_OR_RETURN(limits.outside, parseLimit("--outside", options.outside));
    ASSIGN_OR_RETURN(limits.seeThrough, parseLimit("--see-through", options.seeThrough));
    auto& byDefault = options.tolerance ? limits.outside : limits.different;
    if (!byDefault) byDefault = PixelLimit{};
    return limits;
}

// A picture's files, checked so far that it can be compared.
Result<Picture> readPicture(const std::string& color, const std::string* depth) {
    Picture picture;
    ASSIGN_OR_RETURN(picture.color, readPng(color));
    if (!depth) return picture;
    ASSIGN_OR_RETURN(picture.depth, readExr(*depth));
    if (picture.depth.width != picture.color.width || picture.depth.height != picture.color.height) {
        return fail("{} is {} x {} pixels, {} is {} x {}; they must show the same picture", color,
                    picture.color.width, picture.color.height, *depth, picture.depth.width,
                    picture.depth.height);
    }
    for (const float z : picture.depth.pixels) {
        if (!std::isfinite(z) || z < 0)
            return fail("{}: {} is not a depth; it must be finite and at least 0", *depth, z);
    }
    return picture;
}

// Whether the pictures are within what was asked; prints the report.
Result<bool> run(const Options& options) {
    RETURN_IF_ERROR(checkOptions(options));
    ASSIGN_OR_RETURN(const Limits limits, limitsOf(options));
    const bool depth = !options.depth.empty();
    ASSIGN_OR_RETURN(const Picture reference,
                     readPicture(options.reference, depth ? &options.depth[0] : nullptr));
    ASSIGN_OR_RETURN(const Picture test, readPicture(options.test, depth ? &options.depth[1] : nullptr));
    if (reference.color.width != test.color.width || reference.color.height != test.color.height) {
        return fail("{} is {} x {} pixels, {} is {} x {}; only pictures of one size can be compared",
                    options.reference, reference.color.width, reference.color.height, options.test,
                    test.color.width, test.color.height);
    }
    std::optional<RangeOptions> range;
    if (options.tolerance) range = RangeOptions{*options.tolerance, options.depthSlack};
    const Comparison comparison = compare(reference, test, range);
    const auto broken = brokenLimits(comparison, limits);
    std::fputs((options.json ? jsonReport : textReport)(comparison, broken).c_str(), stdout);
    return broken.empty();
}

int failed(const char* message, const char* advice = "") {
    std::fprintf(stderr, "iwalk-compare: %s%s\n", message, advice);
    return kError;
}

int runProgram(int argc, char** argv) {
    CLI::App app(kDescription, "iwalk-compare");
    Options options;
    addOptions(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return failed(error.what(), "; see --help");
    }
    const Result<bool> within = run(options);
    if (!within) return failed(within.error().message.c_str());
    return *within ? kWithin : kNotWithin;
}

}  // namespace

int main(int argc, char** argv) try {
    return runProgram(argc, argv);
} catch (const std::exception& error) {  // no memory for the pictures, for instance
    return failed(error.what());
}
