#pragma once

#include <string>

#include "common/dataset/manifest.hpp"
#include "common/result.hpp"

namespace iwalk {

// A dataset's directory while it is written: locked against other writers; everything new is made in a
// directory of its own inside, and either committed as a whole or gone without a trace.
class OutputDirectory {
  public:
    // Makes the directory when it is not there. Refuses one that has files and is no dataset, or that another
    // build is at work in. Removes what a killed build left.
    static Result<OutputDirectory> open(const std::string& path);
    OutputDirectory(OutputDirectory&& other) noexcept;
    OutputDirectory& operator=(OutputDirectory&& other) = delete;
    ~OutputDirectory();

    std::string temporary(const std::string& name) const;  // the path for a new file
    std::string temporaryDirectory() const;
    std::uint32_t generation() const { return generation_; }  // of the next dataset

    // Moves the files of the new generation out of the temporary directory, makes the manifest valid, and
    // removes the files of older generations that it does not name. The new files were fsynced.
    Result<void> commit(const Manifest& manifest);

  private:
    OutputDirectory() = default;
    Result<void> lock();
    Result<void> inspect();
    Result<void> moveInto(const std::string& name);
    void removeLeftovers(const Manifest* keep) const;

    std::string path_;
    int lock_ = -1;
    bool made_ = false, committed_ = false;
    std::uint32_t generation_ = 1;
};

}  // namespace iwalk
