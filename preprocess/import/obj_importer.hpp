#pragma once

#include "common/file.hpp"
#include "preprocess/import/importer.hpp"

namespace iwalk {

// Reads Wavefront OBJ; see openImporter().
Result<std::unique_ptr<Importer>> openObj(const std::string& path, std::unique_ptr<RandomAccessFile> file,
                                          const ImportLimits& limits);

}  // namespace iwalk
