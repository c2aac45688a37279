#pragma once

#include <cstdint>
#include <string>

#include "common/result.hpp"
#include "preprocess/import/spill_file.hpp"

namespace iwalk {

struct ImportProcessLimits {
    std::uint64_t memoryBytes = 0;  // besides what its libraries take
    std::uint64_t fileBytes = 0;    // that it may write
    unsigned cpuSeconds = 0;
    unsigned seconds = 0;  // by the clock
};

// Runs iwalk-import, which lies beside the program that calls this, on a file; what it writes goes to
// `output`. The error is one line that names the file, whatever becomes of the program.
Result<void> runImportProcess(const std::string& path, bool heights, const ImportProcessLimits& limits,
                              const SpillFile& output, const std::string& spillDirectory);

}  // namespace iwalk
