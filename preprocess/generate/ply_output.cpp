#include "preprocess/generate/ply_output.hpp"

#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace iwalk {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they are in memory");
static_assert(sizeof(glm::vec3) == 12);

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
constexpr std::size_t kCountDigits = 10;  // indices of 32 bits have no more

std::string temporaryName(const std::string& path) {
    return path + ".part";
}

std::string parentOf(const std::string& path) {
    const std::string parent = std::filesystem::path(path).parent_path().string();
    return parent.empty() ? "." : parent;
}

// What would otherwise show only after all the work.
Result<void> checkPlace(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(parentOf(path), ignored)) {
        return fail("{}: there is no directory {}: make it first", path, parentOf(path));
    }
    const auto status = std::filesystem::status(path, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
        return fail("{}: is there and no file: give another name", path);
    }
    return {};
}

}  // namespace

Result<std::unique_ptr<PlyOutput>> PlyOutput::create(const std::string& path, VertexLayout layout,
                                                     const std::string& note) {
    RETURN_IF_ERROR(checkPlace(path));
    ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(temporaryName(path)));
    std::unique_ptr<PlyOutput> output(new PlyOutput(path, std::move(file), layout, note));
    RETURN_IF_ERROR(output->file_.write(std::as_bytes(std::span<const char>(output->header()))));
    return output;
}

PlyOutput::PlyOutput(std::string path, OutputFile file, VertexLayout layout, std::string note)
    : path_(std::move(path)),
      file_(std::move(file)),
      layout_(layout),
      note_(std::move(note)),
      buffer_(kBufferBytes) {}

PlyOutput::~PlyOutput() {
    if (!finished_) ::unlink(temporaryName(path_).c_str());
}

// Equally long whatever the counts are.
std::string PlyOutput::header() const {
    const std::string vertices = std::to_string(vertices_), triangles = std::to_string(triangles_);
    const std::string padding(2 * kCountDigits - vertices.size() - triangles.size(), '-');
    return "ply\nformat binary_little_endian 1.0\ncomment " + note_ + "\nelement vertex " + vertices +
           fmt::format("\nproperty {0} x\nproperty {0} y\nproperty {0} z\n",
                       layout_.doubles ? "double" : "float") +
           (layout_.colors ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "") +
           "element face " + triangles + "\nproperty list uchar int vertex_indices\ncomment " + padding +
           "\nend_header\n";
}

void PlyOutput::flush() {
    if (!error_) {
        const auto written = file_.write(std::span(buffer_).first(used_));
        if (!written) error_ = written.error();
    }
    used_ = 0;
}

std::string PlyOutput::directory() const {
    return parentOf(path_);
}

Result<void> PlyOutput::status() const {
    if (error_) return *error_;
    return {};
}

Result<void> PlyOutput::finish() {
    flush();
    RETURN_IF_ERROR(status());
    RETURN_IF_ERROR(file_.overwrite(0, std::as_bytes(std::span<const char>(header()))));
    RETURN_IF_ERROR(file_.sync());
    if (std::rename(temporaryName(path_).c_str(), path_.c_str()) != 0) {
        return fail("{}: cannot be replaced: {}", path_, std::generic_category().message(errno));
    }
    finished_ = true;
    return syncDirectory(parentOf(path_));
}

}  // namespace iwalk
