#pragma once

#include <memory>

#include "common/file.hpp"
#include "preprocess/import/importer.hpp"
#include "preprocess/import/placement.hpp"

namespace iwalk {

// What an assembly says: files, and where each is placed.
struct Assembly {
    std::vector<std::string> files;                  // each once; relative names made absolute
    std::vector<std::vector<Placement>> placements;  // by file; at least one each
    std::size_t count = 0;                           // of placements
    bool colors = false;                             // a placement has one
};

// Understands the text of the assembly `path`, a JSON object:
//   {"parts": [{"file": "pump.ply", "matrix": [16 numbers], "color": "#rrggbb"}, ...]}
// `file` is relative to the assembly's folder. `matrix`, row by row, takes column vectors of the file's
// coordinates to the assembly's; its last row is 0 0 0 1; none: the file stays where it is. `color` replaces
// the file's own.
Result<Assembly> parseAssembly(std::string_view text, const std::string& path);

// Reads each file of an assembly once a pass, however often it is placed. The files may be assemblies.
Result<std::unique_ptr<Importer>> openAssembly(const std::string& path,
                                               std::unique_ptr<RandomAccessFile> file,
                                               const ImportLimits& limits);

}  // namespace iwalk
