#include "preprocess/build/vertex_errors.hpp"

namespace iwalk {

Result<VertexErrors> VertexErrors::create(const std::string& directory) {
    VertexErrors errors;
    ASSIGN_OR_RETURN(errors.file_, SpillFile::create(directory));
    return errors;
}

Result<void> VertexErrors::add(std::uint32_t page, std::span<const std::uint8_t> errors) {
    if (errors.empty()) return {};
    RETURN_IF_ERROR(file_->writeAt(end_, std::as_bytes(errors)));
    places_[page] = {end_, errors.size()};
    end_ += errors.size();
    return {};
}

Result<std::vector<std::uint8_t>> VertexErrors::of(std::uint32_t page) const {
    const auto found = places_.find(page);
    if (found == places_.end()) return std::vector<std::uint8_t>();
    std::vector<std::uint8_t> errors(found->second.count);
    RETURN_IF_ERROR(file_->readAt(found->second.offset, std::as_writable_bytes(std::span(errors))));
    return errors;
}

}  // namespace iwalk
