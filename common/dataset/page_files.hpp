#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/dataset/manifest.hpp"
#include "common/file.hpp"

namespace iwalk {

// By their place in Manifest::pageFiles, which page records name.
using PageFiles = std::vector<std::unique_ptr<RandomAccessFile>>;
Result<PageFiles> openPageFiles(const std::string& dataset, const Manifest& manifest);

}  // namespace iwalk
