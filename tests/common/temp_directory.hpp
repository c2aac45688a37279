#pragma once

#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/check.hpp"

namespace iwalk {

// A directory of one test, gone with it.
class TempDirectory {
  public:
    TempDirectory() {
        std::string name = (std::filesystem::temp_directory_path() / "iwalk-test-XXXXXX").string();
        CHECK(mkdtemp(name.data()) != nullptr);
        root_ = name;
    }
    TempDirectory(const TempDirectory&) = delete;
    TempDirectory& operator=(const TempDirectory&) = delete;
    ~TempDirectory() {
        std::error_code ignored;
        std::filesystem::remove_all(root_, ignored);
    }

    // `name` in the directory; the directory itself for "".
    std::string path(const std::string& name) const { return name.empty() ? root_ : root_ + "/" + name; }
    void write(const std::string& name, const std::string& contents) const {
        std::ofstream(path(name), std::ios::binary) << contents;
    }
    // Everything below, relative and sorted.
    std::vector<std::string> list() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root_)) {
            names.push_back(entry.path().lexically_relative(root_).string());
        }
        std::ranges::sort(names);
        return names;
    }

  private:
    std::string root_;
};

}  // namespace iwalk
