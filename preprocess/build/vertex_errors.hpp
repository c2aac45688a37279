#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "preprocess/import/spill_file.hpp"

namespace iwalk {

// Errors of pages' vertices, a byte each, in a nameless file: what memory holds does not grow with vertices.
class VertexErrors {
  public:
    static Result<VertexErrors> create(const std::string& directory);

    Result<void> add(std::uint32_t page, std::span<const std::uint8_t> errors);
    // Of a page, by vertex; empty when none were added. For any thread while nothing is added.
    Result<std::vector<std::uint8_t>> of(std::uint32_t page) const;

  private:
    struct Place {
        std::uint64_t offset;
        std::size_t count;
    };
    std::unique_ptr<SpillFile> file_;
    std::uint64_t end_ = 0;
    std::unordered_map<std::uint32_t, Place> places_;  // by page
};

}  // namespace iwalk
