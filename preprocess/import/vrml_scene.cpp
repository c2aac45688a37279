// ISO/IEC 14772-1:1997, 4.3 (scene graph structure), 6 (nodes). Prototypes and Inline files are left out.
#include "preprocess/import/vrml_scene.hpp"

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

using Kind = VrmlLexer::Kind;

constexpr unsigned kMaxDepth = 128;  // of nodes in nodes; a node that uses itself ends here
// Of nodes, in one walk: as many as the file has bytes, within these. A few lines can ask for any number.
constexpr std::uint64_t kFewUses = 100'000, kMaxUses = 1'000'000;
constexpr std::uint64_t kNameOverheadBytes = 96;  // of an entry in the map
constexpr std::size_t kMaxLeftOut = 64;           // kinds that are counted

bool isOneOf(std::string_view word, std::initializer_list<std::string_view> words) {
    return std::ranges::find(words, word) != words.end();
}
bool isGroup(std::string_view type) {
    return isOneOf(type, {"Transform", "Group", "Switch", "LOD", "Anchor", "Billboard", "Collision"});
}
bool isOtherGeometry(std::string_view type) {
    return isOneOf(type,
                   {"Box", "Cone", "Cylinder", "ElevationGrid", "Extrusion", "Inline", "Sphere", "Text"});
}

// The fields of a Transform, with their defaults.
struct TransformFields {
    glm::dvec3 center{0}, scale{1}, translation{0};
    glm::dvec4 rotation{0, 0, 1, 0}, scaleOrientation{0, 0, 1, 0};

    glm::dmat4 matrix() const {
        const glm::dmat4 turned = turn(scaleOrientation, 1);
        return glm::translate(glm::dmat4(1), translation + center) * turn(rotation, 1) * turned *
               glm::scale(glm::dmat4(1), scale) * turn(scaleOrientation, -1) *
               glm::translate(glm::dmat4(1), -center);
    }

  private:
    static glm::dmat4 turn(const glm::dvec4& axisAngle, double sign) {
        const glm::dvec3 axis(axisAngle);
        if (!(glm::length(axis) > 0)) return glm::dmat4(1);
        return glm::rotate(glm::dmat4(1), sign * axisAngle.w, axis);
    }
};

}  // namespace

VrmlScene::VrmlScene(const RandomAccessFile& file, const std::string& path, std::uint64_t memoryBytes,
                     const Visit& visit)
    : lexer_(file, path),
      memoryBytes_(memoryBytes),
      maxUses_(std::clamp(file.size(), kFewUses, kMaxUses)),
      visit_(visit),
      mesh_(memoryBytes / 4 * 3) {}

void VrmlScene::define(std::string_view name, const VrmlLexer::Place& place) {
    const auto [at, added] = definitions_.insert_or_assign(std::string(name), place);
    if (added) nameBytes_ += at->first.size() + kNameOverheadBytes;
}

Result<std::string> VrmlScene::name() {
    ASSIGN_OR_RETURN(const VrmlLexer::Token token, lexer_.next());
    if (token.kind != Kind::word) return lexer_.bad("a name is wanted here");
    if (nameBytes_ > memoryBytes_ / 4)
        return lexer_.bad("more names (DEF) than memory holds: give more --memory");
    return std::string(token.text);
}

Result<void> VrmlScene::walk() {
    for (;;) {
        ASSIGN_OR_RETURN(const VrmlLexer::Token token, lexer_.next());
        if (token.kind == Kind::end) return {};
        if (token.kind != Kind::word) return lexer_.bad("a node is wanted here");
        RETURN_IF_ERROR(statement(std::string(token.text), {}));
    }
}

Result<void> VrmlScene::statement(std::string_view word, const Context& context) {
    if (word == "PROTO" || word == "EXTERNPROTO") return skipPrototype(word == "EXTERNPROTO");
    if (word != "ROUTE") return node(word, context);
    for (int words = 0; words < 3; ++words) {
        if (auto skipped = name(); !skipped) return skipped.error();
    }
    return {};
}

// PROTO NAME [ interface ] { body }, EXTERNPROTO NAME [ interface ] "URL" or [ "URL"... ]
Result<void> VrmlScene::skipPrototype(bool external) {
    if (auto skipped = name(); !skipped) return skipped.error();
    for (int part = 0; part < 2; ++part) {
        ASSIGN_OR_RETURN(const VrmlLexer::Token token, lexer_.next());
        if (token.kind == Kind::string && external && part == 1) return {};
        if (token.kind != Kind::openBracket && token.kind != Kind::openBrace)
            return lexer_.bad("a prototype without brackets");
        RETURN_IF_ERROR(lexer_.skipNested(*this));
    }
    return {};
}

// Calls `field` for each word of a body, behind its '{', that may be the name of a field, until its '}'. What
// `field` leaves of values is skipped.
Result<void> VrmlScene::eachField(const Field& field) {
    for (;;) {
        ASSIGN_OR_RETURN(const VrmlLexer::Token token, lexer_.next());
        switch (token.kind) {
            case Kind::closeBrace:
                return {};
            case Kind::end:
                return lexer_.bad("the file ends within a node, it is cut short");
            case Kind::closeBracket:
                return lexer_.bad("a ']' without '['");
            case Kind::openBrace:
            case Kind::openBracket:
                RETURN_IF_ERROR(lexer_.skipNested(*this));
                break;
            case Kind::string:
                break;
            case Kind::word:
                if (token.text == "DEF") {
                    ASSIGN_OR_RETURN(const std::string defined, name());
                    define(defined, lexer_.place());
                } else if (token.text == "USE") {
                    if (auto skipped = name(); !skipped) return skipped.error();
                } else {
                    RETURN_IF_ERROR(field(token.text));
                }
        }
    }
}

Result<void> VrmlScene::node(const Context& context) {
    ASSIGN_OR_RETURN(const VrmlLexer::Token token, lexer_.next());
    if (token.kind != Kind::word) return lexer_.bad("a node is wanted here");
    return node(std::string(token.text), context);
}

// A node that begins with `word`: [DEF NAME] TYPE { fields }, USE NAME, or NULL.
Result<void> VrmlScene::node(std::string_view word, const Context& context) {
    if (context.depth == kMaxDepth) {
        return lexer_.bad(
            fmt::format("nodes stand in one another more than {} deep: does one use itself?", kMaxDepth));
    }
    Context inner = context;
    ++inner.depth;
    if (word == "NULL") return {};
    if (word == "USE") return use(inner);
    if (word == "DEF") {
        ASSIGN_OR_RETURN(const std::string defined, name());
        define(defined, lexer_.place());
        return node(inner);
    }
    const std::string type(word);
    ASSIGN_OR_RETURN(const VrmlLexer::Token token, lexer_.next());
    if (token.kind != Kind::openBrace)
        return lexer_.bad(fmt::format("a '{{' is wanted behind {}", quote(type)));
    return body(type, inner);
}

Result<void> VrmlScene::use(const Context& context) {
    ASSIGN_OR_RETURN(const std::string used, name());
    const auto found = definitions_.find(used);
    if (found == definitions_.end())
        return lexer_.bad(fmt::format("USE {}, but nothing has that name", quote(used)));
    if (++uses_ > maxUses_) return lexer_.bad(fmt::format("nodes are used more than {} times", maxUses_));
    const VrmlLexer::Place behind = lexer_.place();
    furthest_ = std::max(furthest_, behind.offset);
    lexer_.seek(found->second);
    RETURN_IF_ERROR(node(context));
    lexer_.seek(behind);
    return {};
}

Result<void> VrmlScene::body(const std::string& type, const Context& context) {
    furthest_ = std::max(furthest_, lexer_.offset());
    if (isGroup(type)) return group(type, context);
    if (type == "Shape") return shape(context);
    if (type == "IndexedFaceSet") return faceSet(context);
    if (type == "Material") return material();
    if (type == "Appearance") {
        return eachField(
            [&](std::string_view field) { return field == "material" ? node(context) : Result<void>(); });
    }
    if (type == "Coordinate") {
        return eachField([&](std::string_view field) {
            return field == "point" ? mesh_.readPoints(lexer_) : Result<void>();
        });
    }
    if (type == "Color") {
        return eachField([&](std::string_view field) {
            return field == "color" ? mesh_.readColors(lexer_) : Result<void>();
        });
    }
    if (isOtherGeometry(type) && leftOut_.size() < kMaxLeftOut) ++leftOut_[type];
    return lexer_.skipNested(*this);
}

// The nodes of a list, or a single one; `only`: of a list that one, counted from 0.
Result<void> VrmlScene::children(const Context& context, std::optional<std::int64_t> only) {
    ASSIGN_OR_RETURN(VrmlLexer::Token token, lexer_.next());
    const bool list = token.kind == Kind::openBracket;
    for (std::int64_t index = 0;; ++index) {
        if (list) {
            ASSIGN_OR_RETURN(token, lexer_.next());
            if (token.kind == Kind::closeBracket) return {};
        }
        if (token.kind != Kind::word) return lexer_.bad("a node is wanted here");
        const std::string word(token.text);
        if (!only || *only == index) {
            RETURN_IF_ERROR(statement(word, context));
            if (only) return {};  // the caller knows where the list ends
        } else if (word == "USE") {
            if (auto skipped = name(); !skipped) return skipped.error();
        } else if (word == "DEF" || word != "NULL") {
            while (token.kind == Kind::word) {
                ASSIGN_OR_RETURN(token, lexer_.next());
            }
            if (token.kind != Kind::openBrace) return lexer_.bad("a '{' is wanted here");
            RETURN_IF_ERROR(lexer_.skipNested(*this));
        }
        if (!list) return {};
    }
}

// A group's fields may come in any order, so its children are passed over until all fields are known.
Result<void> VrmlScene::group(const std::string& type, const Context& context) {
    TransformFields transform;
    std::optional<VrmlLexer::Place> list;
    double choice = -1;
    const auto read = [&](auto& value, std::size_t count) -> Result<void> {
        ASSIGN_OR_RETURN(const glm::dvec4 values, numbers(count));
        value = std::decay_t<decltype(value)>(values);
        return {};
    };
    RETURN_IF_ERROR(eachField([&](std::string_view field) -> Result<void> {
        if (field == "children" || field == "choice" || field == "level") {
            list = lexer_.place();
            return {};
        }
        if (field == "whichChoice") {
            ASSIGN_OR_RETURN(const glm::dvec4 values, numbers(1));
            choice = values.x;
        }
        if (type != "Transform") return {};
        if (field == "translation") return read(transform.translation, 3);
        if (field == "center") return read(transform.center, 3);
        if (field == "scale") return read(transform.scale, 3);
        if (field == "rotation") return read(transform.rotation, 4);
        if (field == "scaleOrientation") return read(transform.scaleOrientation, 4);
        return {};
    }));
    if (!list) return {};
    const VrmlLexer::Place behind = lexer_.place();
    lexer_.seek(*list);
    Context inner = context;
    if (type == "Transform") inner.matrix = context.matrix * transform.matrix();
    std::optional<std::int64_t> only;
    if (type == "LOD") only = 0;  // the finest
    if (type == "Switch") only = choice >= 0 && choice < 1e9 ? static_cast<std::int64_t>(choice) : -1;
    if (only != -1) RETURN_IF_ERROR(children(inner, only));
    lexer_.seek(behind);
    return {};
}

Result<void> VrmlScene::shape(const Context& context) {
    hasMesh_ = false;
    color_.reset();
    mesh_.clear();
    RETURN_IF_ERROR(eachField([&](std::string_view field) {
        return field == "appearance" || field == "geometry" ? node(context) : Result<void>();
    }));
    if (!hasMesh_) return {};
    RETURN_IF_ERROR(mesh_.check(lexer_));
    return visit_(mesh_, context.matrix, color_);
}

Result<void> VrmlScene::material() {
    color_ = vrmlColor(glm::dvec3(0.8));
    return eachField([&](std::string_view field) -> Result<void> {
        if (field != "diffuseColor") return {};
        ASSIGN_OR_RETURN(const glm::dvec4 rgb, numbers(3));
        color_ = vrmlColor(glm::dvec3(rgb));
        return {};
    });
}

Result<void> VrmlScene::faceSet(const Context& context) {
    mesh_.clear();
    mesh_.place = lexer_.place();
    hasMesh_ = true;
    return eachField([&](std::string_view field) {
        if (field == "coord" || field == "color") return node(context);
        if (field == "coordIndex") return mesh_.readIndices(lexer_);
        if (field == "colorIndex") return mesh_.readColorIndices(lexer_);
        if (field == "colorPerVertex") return flag(mesh_.colorPerVertex);
        if (field == "ccw") return flag(mesh_.counterClockwise);
        return Result<void>();
    });
}

Result<void> VrmlScene::flag(bool& value) {
    ASSIGN_OR_RETURN(const VrmlLexer::Token token, lexer_.next());
    if (token.kind != Kind::word || (token.text != "TRUE" && token.text != "FALSE"))
        return lexer_.bad("TRUE or FALSE is wanted here");
    value = token.text == "TRUE";
    return {};
}

Result<glm::dvec4> VrmlScene::numbers(std::size_t count) {
    glm::dvec4 values(0);
    for (std::size_t i = 0; i < count; ++i) {
        ASSIGN_OR_RETURN(const bool found, lexer_.number(values[i]));
        if (!found) return lexer_.bad("a number is wanted here");
    }
    return values;
}

}  // namespace iwalk
