#pragma once

#include <memory>

#include "common/file.hpp"
#include "preprocess/import/importer.hpp"

namespace iwalk {

// VRML97: IndexedFaceSets with their Transforms, diffuse colours of materials, and colours of corners and
// faces. Memory is bounded by the largest IndexedFaceSet; where that takes more than the limit, it fails.
Result<std::unique_ptr<Importer>> openVrml(const std::string& path, std::unique_ptr<RandomAccessFile> file,
                                           const ImportLimits& limits);

}  // namespace iwalk
