#include "preprocess/import/foreign/scene_reader.hpp"

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <new>

#include "preprocess/import/placement.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kMaxNodes = 10'000'000, kMaxDepth = 1000;

// Opens regular files in one folder and below it.
class FolderFiles : public Assimp::DefaultIOSystem {
  public:
    explicit FolderFiles(const fs::path& folder) : folder_(folder) {}

    Assimp::IOStream* Open(const char* file, const char* mode) override {
        return allowed(file) && std::strchr(mode, 'r') != nullptr ? DefaultIOSystem::Open(file, mode)
                                                                  : nullptr;
    }
    bool Exists(const char* file) const override { return allowed(file) && DefaultIOSystem::Exists(file); }

  private:
    bool allowed(const char* file) const {
        std::error_code error;
        const fs::path path = fs::canonical(file, error);
        if (error || !fs::is_regular_file(path, error)) return false;
        return std::ranges::mismatch(folder_, path).in1 == folder_.end();
    }
    fs::path folder_;
};

glm::dmat4 matrixOf(const aiMatrix4x4& m) {
    glm::dmat4 out;
    for (unsigned row = 0; row < 4; ++row) {
        for (unsigned column = 0; column < 4; ++column)
            out[column][row] = static_cast<double>(m[row][column]);
    }
    return out;
}

double clampUnit(double value) {
    return value > 0 ? std::min(value, 1.0) : 0;
}
double toSrgb(double linear) {
    return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

class SceneExport {
  public:
    SceneExport(const aiScene& scene, bool linear, ExchangeWriter& out)
        : scene_(scene), linear_(linear), out_(out) {
        for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
            aiColor4D color(1, 1, 1, 1);
            // glTF's base colour, or what is diffuse elsewhere.
            const bool found = scene.mMaterials[i]->Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
                               scene.mMaterials[i]->Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS;
            colored_ = colored_ || found;
            materials_.push_back(color);
        }
        for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
            colored_ = colored_ || scene.mMeshes[i]->HasVertexColors(0);
            normals_ = normals_ || scene.mMeshes[i]->HasNormals();
        }
    }

    Result<void> run() {
        ExchangeHeader header;
        header.flags = (colored_ ? ExchangeHeader::kColors : 0u) | (normals_ ? ExchangeHeader::kNormals : 0u);
        RETURN_IF_ERROR(out_.header(header));
        if (scene_.mRootNode != nullptr) RETURN_IF_ERROR(node(*scene_.mRootNode, glm::dmat4(1), 0));
        RETURN_IF_ERROR(flush());
        return out_.finish();
    }

  private:
    Result<void> node(const aiNode& node, const glm::dmat4& parent, unsigned depth) {
        if (depth > kMaxDepth || ++nodes_ > kMaxNodes)
            return fail("has too many nodes, or they nest too deep");
        const glm::dmat4 matrix = parent * matrixOf(node.mTransformation);
        const Placement placement(matrix);
        for (unsigned i = 0; i < node.mNumMeshes; ++i) {
            if (node.mMeshes[i] >= scene_.mNumMeshes) return fail("names a mesh that it does not have");
            RETURN_IF_ERROR(mesh(*scene_.mMeshes[node.mMeshes[i]], placement));
        }
        for (unsigned i = 0; i < node.mNumChildren; ++i)
            RETURN_IF_ERROR(this->node(*node.mChildren[i], matrix, depth + 1));
        return {};
    }

    // Points and lines are passed over.
    Result<void> mesh(const aiMesh& mesh, const Placement& placement) {
        for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
            const aiFace& face = mesh.mFaces[i];
            if (face.mNumIndices != 3) continue;
            Triangle triangle;
            for (unsigned c = 0; c < 3; ++c) {
                if (face.mIndices[c] >= mesh.mNumVertices)
                    return fail("names a vertex that it does not have");
                triangle[c] = corner(mesh, face.mIndices[c]);
            }
            placement.append(std::span(&triangle, 1), batch_);
            if (batch_.size() >= kBlockTriangles) RETURN_IF_ERROR(flush());
        }
        return {};
    }

    Corner corner(const aiMesh& mesh, unsigned vertex) const {
        const aiVector3D& p = mesh.mVertices[vertex];
        Corner corner;
        corner.position = glm::dvec3(p.x, p.y, p.z);
        if (mesh.HasNormals()) {
            const aiVector3D& n = mesh.mNormals[vertex];
            corner.normal = glm::vec3(n.x, n.y, n.z);
        }
        if (colored_) corner.color = color(mesh, vertex);
        return corner;
    }

    std::uint32_t color(const aiMesh& mesh, unsigned vertex) const {
        aiColor4D color(1, 1, 1, 1);
        if (mesh.mMaterialIndex < materials_.size()) color = materials_[mesh.mMaterialIndex];
        if (mesh.HasVertexColors(0)) color = color * mesh.mColors[0][vertex];
        std::array<std::uint8_t, 4> bytes{0, 0, 0, 255};
        const std::array<float, 3> rgb{color.r, color.g, color.b};
        for (std::size_t i = 0; i < 3; ++i) {
            const double part = clampUnit(static_cast<double>(rgb[i]));
            bytes[i] = static_cast<std::uint8_t>(std::lround((linear_ ? toSrgb(part) : part) * 255));
        }
        std::uint32_t packed = 0;
        std::memcpy(&packed, bytes.data(), sizeof packed);
        return packed;
    }

    Result<void> flush() {
        if (batch_.empty()) return {};
        RETURN_IF_ERROR(out_.block(std::as_bytes(std::span(batch_))));
        batch_.clear();
        return {};
    }

    const aiScene& scene_;
    bool linear_;  // its colours are, as glTF's; else they are sRGB
    ExchangeWriter& out_;
    std::vector<aiColor4D> materials_;
    bool colored_ = false, normals_ = false;
    std::vector<Triangle> batch_;
    unsigned nodes_ = 0;
};

// One line of what the library says.
std::string firstLine(std::string_view text) {
    text = trim(text);
    std::string line(text.substr(0, std::min<std::size_t>(text.find('\n'), 200)));
    for (char& c : line) c = static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
    return line;
}

std::string lowerExtension(const std::string& path) {
    std::string extension = fs::path(path).extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

}  // namespace

Result<void> exportScene(const std::string& path, ExchangeWriter& out) {
    const std::string extension = lowerExtension(path);
    Assimp::Importer importer;
    std::error_code error;
    importer.SetIOHandler(new FolderFiles(fs::canonical(path, error).parent_path()));  // becomes its own
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    if (extension.empty() || !importer.IsExtensionSupported(extension))
        return fail("unknown kind of model: there is no reader for {} files", quote(extension));
    const aiScene* const scene = importer.ReadFile(path, aiProcess_Triangulate);
    if (scene == nullptr) {
        const std::string said = firstLine(importer.GetErrorString());
        if (said.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
        return fail("cannot be read: {}", said);
    }
    if (scene->mNumMeshes == 0) return fail("has no meshes");
    return SceneExport(*scene, extension == ".gltf" || extension == ".glb", out).run();
}

}  // namespace iwalk
