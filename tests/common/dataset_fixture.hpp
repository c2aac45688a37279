#pragma once

#include <gtest/gtest.h>

#include "common/dataset/hierarchy.hpp"
#include "common/dataset/manifest.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk {

// A root with three leaves, levels 0 to 2, seven pages in one file and their morph blocks in another:
//   root:    level 0 of all; own triangles at level 1 and full
//   leaf 1:  level 1 and full
//   leaf 2:  full alone
//   leaf 3:  levels 1 and 2; full on two pages
Hierarchy makeHierarchy();
Manifest makeManifest();

// The dataset of these, on disk. The page files hold nothing of use.
class DatasetTest : public testing::Test {
  protected:
    DatasetTest();

    TempDirectory directory_;
};

}  // namespace iwalk
