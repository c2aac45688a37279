#pragma once

#include <string>

#include "preprocess/import/exchange.hpp"

namespace iwalk {

// Reads a model with assimp and writes its triangles: those of all nodes, moved by the nodes' transforms,
// with colours of corners times the colour of their material, and normals. Up axis and unit stay as they are
// in the file. Other files that the model names are read when they lie in its folder or below it.
Result<void> exportScene(const std::string& path, ExchangeWriter& out);

}  // namespace iwalk
