#include "preprocess/import/importer.hpp"

#include <algorithm>
#include <filesystem>

#include "preprocess/import/assembly.hpp"
#include "preprocess/import/foreign_importer.hpp"
#include "preprocess/import/obj_importer.hpp"
#include "preprocess/import/ply_importer.hpp"
#include "preprocess/import/stl_importer.hpp"
#include "preprocess/import/vrml_importer.hpp"

namespace iwalk {
namespace {

// Models that are read here; that another program reads, of many more that it can; images that are heights.
constexpr std::array<std::string_view, 5> kOwn{".obj", ".ply", ".stl", ".vrml", ".wrl"};
constexpr std::array<std::string_view, 8> kForeign{".3ds", ".3mf",  ".dae", ".fbx",
                                                   ".glb", ".gltf", ".off", ".x"};
constexpr std::array<std::string_view, 5> kHeightMaps{".exr", ".hdr", ".png", ".tif", ".tiff"};

bool isOneOf(std::string_view extension, std::span<const std::string_view> list) {
    return std::ranges::find(list, extension) != list.end();
}

// Devices, pipes and directories have no size to check claims against.
Result<std::unique_ptr<RandomAccessFile>> openModel(const std::string& path) {
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    if (is_directory(status)) return fail("{}: is a directory: give a model file", path);
    if (exists(status) && !is_regular_file(status))
        return fail("{}: is not a regular file: give a model file", path);
    ASSIGN_OR_RETURN(auto file, openForReading(path));
    if (file->size() == 0) return fail("{}: is empty", path);
    return file;
}

std::string lowerExtension(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return extension;
}

}  // namespace

Result<std::unique_ptr<Importer>> openImporter(const std::string& path, const ImportLimits& limits) {
    ASSIGN_OR_RETURN(auto file, openModel(path));
    std::array<char, 4> magic{};
    const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(magic.size(), file->size()));
    RETURN_IF_ERROR(file->readAt(0, std::as_writable_bytes(std::span(magic.data(), count))));
    const std::string extension = lowerExtension(path);
    if (std::string_view(magic.data(), 3) == "ply" || extension == ".ply") {
        return openPly(path, std::move(file), limits);
    }
    if (extension == ".obj") return openObj(path, std::move(file), limits);
    if (extension == ".stl") return openStl(path, std::move(file));
    if (extension == ".wrl" || extension == ".vrml") return openVrml(path, std::move(file), limits);
    if (extension == ".json") return openAssembly(path, std::move(file), limits);
    if (isOneOf(extension, kHeightMaps)) return openForeign(path, ForeignKind::heights, file->size(), limits);
    return openForeign(path, ForeignKind::triangles, file->size(), limits);
}

bool isModelName(const std::string& path) {
    const std::string extension = lowerExtension(path);
    return isOneOf(extension, kOwn) || isOneOf(extension, kForeign);
}

}  // namespace iwalk
