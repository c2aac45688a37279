#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "common/camera_path.hpp"
#include "common/result.hpp"

namespace iwalk::client {

// Ten views to come back to, in a file that is a camera path of ten frames: `--path` plays it.
class SavedViews {
  public:
    static constexpr std::size_t kViews = 10;

    // Reads `file` if it is there.
    static Result<SavedViews> open(const std::string& file);

    // Nothing where none was saved.
    const std::optional<Camera>& view(std::size_t number) const { return views_.at(number); }
    // Keeps a view and writes the file; there the views that were not saved are `home`, and all have its
    // field of view.
    Result<void> save(std::size_t number, const Camera& view, const Camera& home);
    const std::string& file() const { return file_; }

  private:
    std::string file_;
    std::array<std::optional<Camera>, kViews> views_;
};

}  // namespace iwalk::client
