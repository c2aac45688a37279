#pragma once

#include <string>

#include "common/result.hpp"
#include "preprocess/build/build.hpp"

// The subcommands, after the command line is understood. What they have to say goes to standard output.
namespace iwalk {

Result<void> runBuild(const BuildOptions& options);
Result<void> runInfo(const std::string& dataset, bool json);
Result<void> runVerify(const std::string& dataset, bool json);

}  // namespace iwalk
