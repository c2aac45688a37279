#pragma once

#include <memory>
#include <string>

#include "preprocess/import/importer.hpp"

namespace iwalk {

// Reads the full resolution of a dataset as if it were a model, a page at a time. Positions on the dataset's
// lattice, colours and normals come out as they were stored.
Result<std::unique_ptr<Importer>> openDatasetImporter(const std::string& dataset);

}  // namespace iwalk
