#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "common/settings.hpp"
#include "common/version.hpp"
#include "preprocess/command/commands.hpp"

namespace {

using namespace iwalk;

constexpr int kSuccess = 0, kFailure = 1, kUsage = 2;
constexpr int kLargeBlock = 4 << 20;  // bytes

int report(const Result<void>& result) {
    if (result) return kSuccess;
    fmt::print(stderr, "iwalk-preprocess: {}\n", result.error().message);
    return kFailure;
}

// Everything that can be said on the command line.
struct Arguments {
    BuildOptions build;
    std::string memory = "512M", up = "z";
    int step = 0;
    double noData = 0, seaLevel = 0;
    std::string dataset, picture;
    bool json = false;
    GenerateOptions generate;
};

void addLimits(CLI::App* command, Arguments& arguments) {
    command
        ->add_option(
            "--memory", arguments.memory,
            "Peak memory of this program, in bytes with suffix k, M or G; at least 64M. More is faster "
            "where the model is larger than this")
        ->type_name("BYTES")
        ->capture_default_str();
    command->add_option("--threads", arguments.build.threads, "Threads; 0: as many as there are cores")
        ->type_name("N")
        ->capture_default_str();
}

// What is read, and how.
void addInputs(CLI::App* command, Arguments& arguments) {
    ImportChoices& choices = arguments.build.import;
    command
        ->add_option(
            "input", arguments.build.inputs,
            "Models (.ply, .stl, .obj, .wrl, .gltf and others), assemblies (.json), height maps (.tif, "
            ".png, .exr), directories of models, or patterns")
        ->required()
        ->type_name("INPUT");
    command->add_option("--up", arguments.up, "The inputs' axis that points up: y is turned into z")
        ->check(CLI::IsMember({"y", "z"}))
        ->type_name("y|z")
        ->capture_default_str();
    command
        ->add_option("--spacing", choices.spacing,
                     "Of height maps: the distance of neighbouring samples, in model units")
        ->check(CLI::PositiveNumber)
        ->type_name("UNITS")
        ->capture_default_str();
    command
        ->add_option("--height-scale", choices.heightScale,
                     "Of height maps: what a sample's value is multiplied by, to be model units")
        ->type_name("FACTOR")
        ->capture_default_str();
    command
        ->add_option("--no-data", arguments.noData, "Of height maps: the sample value that stands for a hole")
        ->type_name("VALUE");
    command
        ->add_option("--sea-level", arguments.seaLevel,
                     "Of height maps: colours by height, blue up to this height in model units, green to "
                     "white above. Without it they have no colours, which takes less room")
        ->type_name("UNITS");
}

CLI::App* addBuild(CLI::App& app, Arguments& arguments) {
    CLI::App* command = app.add_subcommand("build", "Build a dataset from models");
    addInputs(command, arguments);
    command
        ->add_option("-o,--output", arguments.build.output,
                     "Directory of the dataset; made when it is not there, replaced when it is a dataset")
        ->required()
        ->type_name("DATASET");
    addLimits(command, arguments);
    command
        ->add_option(
            "--leaf-triangles", arguments.build.leafTriangles,
            "A node of the octree with more triangles is split (16 to 65536). Raised: fewer and larger "
            "reads, smaller hierarchy, coarser choice of what to read")
        ->type_name("N")
        ->capture_default_str();
    command
        ->add_option(
            "--step", arguments.step,
            "The lattice step is 2^E model units. Default: chosen from the models' precision and size. "
            "It cannot change once the dataset is built")
        ->type_name("E");
    return command;
}

CLI::App* addInsert(CLI::App& app, Arguments& arguments) {
    CLI::App* command = app.add_subcommand("insert",
                                           "Add models to a dataset, in place: what they do not touch stays "
                                           "as it is. Colours and normals that the "
                                           "dataset does not have are dropped");
    command->add_option("dataset", arguments.build.output, "Directory of the dataset")
        ->required()
        ->type_name("DATASET");
    addInputs(command, arguments);
    addLimits(command, arguments);
    return command;
}

CLI::App* addMeasure(CLI::App& app, Arguments& arguments) {
    CLI::App* command = app.add_subcommand(
        "measure", "Say how large models are and what they have, without building anything");
    addInputs(command, arguments);
    command->add_flag("--json", arguments.json, "Print JSON");
    return command;
}

CLI::App* addCompact(CLI::App& app, Arguments& arguments) {
    CLI::App* command = app.add_subcommand(
        "compact",
        "Write a dataset's files anew without what inserts have left in them. Needs disk for all that stays");
    command->add_option("dataset", arguments.dataset, "Directory of the dataset")
        ->required()
        ->type_name("DATASET");
    return command;
}

CLI::App* addReader(CLI::App& app, Arguments& arguments, const char* name, const char* help) {
    CLI::App* command = app.add_subcommand(name, help);
    command->add_option("dataset", arguments.dataset, "Directory of the dataset")
        ->required()
        ->type_name("DATASET");
    command->add_flag("--json", arguments.json, "Print JSON");
    return command;
}

CLI::App* addGenerate(CLI::App& app, GenerateOptions& options) {
    CLI::App* command = app.add_subcommand(
        "generate",
        "Make a model of any size for tests and measurements; the same bytes on every machine\n"
        "  sphere       closed, with noise, no colours\n"
        "  plant        storeys, pipes, tanks, cable trays; coloured, to be seen from inside\n"
        "  isosurface   a turbulent layer between two fluids, coloured by height\n"
        "  terrain      mountains, hills and sea, coloured by height\n"
        "and scenes that break what is careless:\n"
        "  hard-far      millimetres, ten thousand kilometres from the origin\n"
        "  hard-slivers  a million times as long as wide, without area, twice, upon one another\n"
        "  hard-point    all around one vertex\n"
        "  hard-flat     all in one plane\n"
        "  hard-outlier  one vertex a million times as far away as all others\n"
        "  hard-huge     one triangle as large as all others together");
    command->add_option("scene", options.scene, "One of the above")->required()->type_name("SCENE");
    command
        ->add_option(
            "--triangles", options.triangles,
            "How many, 1000 to 1000000000; the result has the nearest number that the scene can make, "
            "within 1 %. About 20 bytes on disk each")
        ->required()
        ->type_name("N");
    command->add_option("--seed", options.seed, "Another number makes another model of the same kind")
        ->type_name("S")
        ->capture_default_str();
    command->add_option("-o,--output", options.output, "PLY file to write; replaced when it is there")
        ->required()
        ->type_name("OUT.ply");
    return command;
}

int usage(const std::string& message) {
    fmt::print(stderr, "iwalk-preprocess: {} (see --help)\n", message);
    return kUsage;
}

int run(int argc, char** argv) {
    CLI::App app("Turns triangle models into datasets that iwalk-server draws, and makes models to try.",
                 "iwalk-preprocess");
    app.set_version_flag("--version", std::string("iwalk-preprocess ") + kVersion);
    app.require_subcommand(1);
    Arguments arguments;
    const CLI::App* build = addBuild(app, arguments);
    const CLI::App* insert = addInsert(app, arguments);
    const CLI::App* measure = addMeasure(app, arguments);
    const CLI::App* compact = addCompact(app, arguments);
    const CLI::App* generate = addGenerate(app, arguments.generate);
    CLI::App* info = addReader(app, arguments, "info", "Say what a dataset has");
    info->add_option("--draw", arguments.picture,
                     "Draw the model and the cells of the octree's leaves, coloured by depth, into this file")
        ->type_name("OUT.png");
    const CLI::App* verify = addReader(app, arguments, "verify", "Read all of a dataset and check it");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        return usage(error.what());
    }

    if (generate->parsed()) return report(runGenerate(arguments.generate));
    if (compact->parsed()) return report(runCompact(arguments.dataset));
    if (info->parsed()) return report(runInfo(arguments.dataset, arguments.json, arguments.picture));
    if (verify->parsed()) return report(runVerify(arguments.dataset, arguments.json));
    arguments.build.import.yUp = arguments.up == "y";
    for (const CLI::App* reader : {build, insert, measure}) {
        if (reader->count("--no-data") > 0) arguments.build.import.noData = arguments.noData;
        if (reader->count("--sea-level") > 0) arguments.build.import.seaLevel = arguments.seaLevel;
    }
    if (measure->parsed()) return report(runMeasure(arguments.build, arguments.json));
    const Result<std::uint64_t> memory = parseBytes(arguments.memory);
    if (!memory) return usage("--memory: " + memory.error().message);
    arguments.build.memoryBytes = *memory;
    if (insert->parsed()) return report(runInsert(arguments.build));
    if (build->count("--step") > 0) arguments.build.stepExponent = arguments.step;
    return report(runBuild(arguments.build));
}

}  // namespace

int main(int argc, char** argv) {
    try {
        // Large blocks go back to the system when they are freed. By itself malloc soon keeps them, in
        // pieces, so that memory depends on the order of blocks (50 or 70 MB for the same build).
        ::mallopt(M_MMAP_THRESHOLD, kLargeBlock);
        // Standard output is for results.
        spdlog::set_default_logger(spdlog::stderr_logger_mt("iwalk-preprocess"));
        spdlog::set_pattern("%l: %v");
        return run(argc, argv);
    } catch (const std::exception& exception) {  // out of memory, for instance
        fmt::print(stderr, "iwalk-preprocess: {}\n", exception.what());
        return kFailure;
    }
}
