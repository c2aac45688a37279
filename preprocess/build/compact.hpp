#pragma once

#include <string>

#include "common/dataset/manifest.hpp"
#include "common/result.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

// Writes the dataset's pages and morph blocks, byte for byte, into one new file in the order in which a build
// writes them, without what inserts have left behind. Killed at any moment, the dataset is as before or
// complete. Needs room on disk for all that is kept.
Result<Manifest> compactDataset(const std::string& dataset, Progress& progress);

// Of all files that the manifest names.
std::uint64_t bytesOnDisk(const Manifest& manifest);
// Of these, what no page and no morph block takes: inserts leave it behind.
std::uint64_t garbageBytes(const Manifest& manifest);

}  // namespace iwalk
