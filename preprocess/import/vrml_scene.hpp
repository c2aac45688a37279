#pragma once

#include <functional>
#include <glm/mat4x4.hpp>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "preprocess/import/vrml_mesh.hpp"

namespace iwalk {

// Walks the scene graph of a VRML97 text, and hands on its IndexedFaceSets one by one: where a node is used
// again (USE), the lexer goes back to where it is written, so that nothing but one face set and the nodes'
// names is in memory.
class VrmlScene : private VrmlLexer::Definitions {
  public:
    // A face set, where it stands in the scene, and its material's diffuse colour (RGBA8) if it has one.
    using Visit =
        std::function<Result<void>(const VrmlMesh&, const glm::dmat4&, std::optional<std::uint32_t>)>;

    // `file`, `path` and `visit` must outlive the scene. `memoryBytes` bounds a face set, and names.
    VrmlScene(const RandomAccessFile& file, const std::string& path, std::uint64_t memoryBytes,
              const Visit& visit);

    Result<void> walk();
    // Of the walk so far, bytes; USE makes it jump.
    std::uint64_t furthest() const { return furthest_; }
    // What was met that is geometry, but no IndexedFaceSet: how many of each node.
    const std::map<std::string, std::uint64_t>& leftOut() const { return leftOut_; }

  private:
    // Where a node stands.
    struct Context {
        glm::dmat4 matrix{1};
        unsigned depth = 0;
    };
    using Field = std::function<Result<void>(std::string_view)>;

    void define(std::string_view name, const VrmlLexer::Place& place) override;
    Result<std::string> name();
    Result<void> eachField(const Field& field);
    Result<void> statement(std::string_view word, const Context& context);
    Result<void> skipPrototype(bool external);
    Result<void> node(const Context& context);
    Result<void> node(std::string_view word, const Context& context);
    Result<void> use(const Context& context);
    Result<void> body(const std::string& type, const Context& context);
    Result<void> children(const Context& context, std::optional<std::int64_t> only);
    Result<void> group(const std::string& type, const Context& context);
    Result<void> shape(const Context& context);
    Result<void> material();
    Result<void> faceSet(const Context& context);
    Result<void> flag(bool& value);
    Result<glm::dvec4> numbers(std::size_t count);

    VrmlLexer lexer_;
    const std::uint64_t memoryBytes_, maxUses_;
    const Visit& visit_;
    std::unordered_map<std::string, VrmlLexer::Place> definitions_;
    std::uint64_t nameBytes_ = 0, uses_ = 0, furthest_ = 0;
    std::map<std::string, std::uint64_t> leftOut_;

    // Of the shape under way.
    VrmlMesh mesh_;
    bool hasMesh_ = false;
    std::optional<std::uint32_t> color_;
};

}  // namespace iwalk
