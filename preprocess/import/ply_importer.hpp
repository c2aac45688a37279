#pragma once

#include "common/file.hpp"
#include "preprocess/import/importer.hpp"

namespace iwalk {

// Reads the header of a PLY file at once; see openImporter().
Result<std::unique_ptr<Importer>> openPly(const std::string& path, std::unique_ptr<RandomAccessFile> file,
                                          const ImportLimits& limits);

}  // namespace iwalk
