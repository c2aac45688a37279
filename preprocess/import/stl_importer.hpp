#pragma once

#include <memory>

#include "common/file.hpp"
#include "preprocess/import/importer.hpp"

namespace iwalk {

// STL, binary and ASCII. Nothing is kept: each pass reads the file. Facet normals are not used.
Result<std::unique_ptr<Importer>> openStl(const std::string& path, std::unique_ptr<RandomAccessFile> file);

}  // namespace iwalk
