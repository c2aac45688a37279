#pragma once

#include <string>

#include "common/result.hpp"
#include "preprocess/build/build.hpp"
#include "preprocess/generate/generate.hpp"

// The subcommands, after the command line is understood. What they have to say goes to standard output.
namespace iwalk {

Result<void> runBuild(BuildOptions options);
Result<void> runInsert(BuildOptions options);
Result<void> runCompact(const std::string& dataset);
Result<void> runMeasure(const BuildOptions& options, bool json);
Result<void> runGenerate(const GenerateOptions& options);
// `picture`: a PNG file to draw the octree into; empty: none.
Result<void> runInfo(const std::string& dataset, bool json, const std::string& picture);
Result<void> runVerify(const std::string& dataset, bool json);

}  // namespace iwalk
