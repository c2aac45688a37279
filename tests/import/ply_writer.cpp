#include "tests/import/ply_writer.hpp"

#include <algorithm>
#include <cstring>

namespace iwalk {
namespace {

struct Property {
    std::string type, name;
    double value = 0;
    std::vector<double> list;
    std::string countType;  // of a list; empty otherwise
};
using Record = std::vector<Property>;

template <class T>
std::string bytesOfValue(double value, bool swap) {
    // By way of 64 bits, so that 4294967295 as an int becomes -1.
    const T typed =
        std::is_integral_v<T> ? static_cast<T>(static_cast<std::int64_t>(value)) : static_cast<T>(value);
    std::string bytes(sizeof typed, '\0');
    std::memcpy(bytes.data(), &typed, sizeof typed);
    if (swap) std::ranges::reverse(bytes);
    return bytes;
}

std::array<std::uint8_t, 4> channels(std::uint32_t color) {
    std::array<std::uint8_t, 4> rgba{};
    std::memcpy(rgba.data(), &color, sizeof color);
    return rgba;
}

double scaledColor(const std::string& type, std::uint8_t value) {
    if (type == "float" || type == "double") return value / 255.0;
    return type == "ushort" ? value * 257.0 : value;
}

Record vertexRecord(const Corner& v, const PlyFlavor& flavor) {
    Record record;
    const char* const names[] = {"x", "y", "z"};
    for (glm::length_t i = 0; i < 3; ++i)
        record.push_back({flavor.coordinate, names[i], v.position[i], {}, {}});
    if (flavor.extras) record.push_back({"double", "quality", 0.25, {}, {}});
    if (flavor.vertexLists) record.push_back({"short", "weights", 0, {1, 2, 3}, "uint"});
    if (flavor.normals) {
        const char* const normal[] = {"nx", "ny", "nz"};
        for (glm::length_t i = 0; i < 3; ++i) record.push_back({"float", normal[i], v.normal[i], {}, {}});
    }
    if (!flavor.color.empty()) {
        const char* const color[] = {"red", "green", "blue", "alpha"};
        for (std::size_t i = 0; i < (flavor.alpha ? 4u : 3u); ++i) {
            const double value = scaledColor(flavor.color, channels(v.color)[i]);
            record.push_back({flavor.color, flavor.colorPrefix + color[i], value, {}, {}});
        }
    }
    if (flavor.reversed) std::ranges::reverse(record);
    return record;
}

Record faceRecord(const std::vector<unsigned>& polygon, const PlyFlavor& flavor) {
    Record record;
    record.push_back({flavor.index, flavor.indexName, 0, {polygon.begin(), polygon.end()}, flavor.count});
    if (flavor.extras) {
        record.push_back({"uchar", "flags", 7, {}, {}});
        record.push_back({"float", "texcoord", 0, {0.5, 0.25}, "uchar"});
    }
    if (flavor.reversed) std::ranges::reverse(record);
    return record;
}

void addElement(const std::string& name, const std::vector<Record>& records, const PlyFlavor& flavor,
                std::string& header, std::string& data) {
    header += "element " + name + " " + std::to_string(records.size()) + flavor.lineEnd;
    for (const Property& p : records.front()) {
        const std::string list = p.countType.empty() ? "" : "list " + p.countType + " ";
        header += "property " + list + p.type + " " + p.name + flavor.lineEnd;
    }
    for (const Record& record : records) {
        for (const Property& p : record) {
            if (p.countType.empty()) {
                data += plyValue(flavor.format, p.type, p.value);
                continue;
            }
            data += plyValue(flavor.format, p.countType, static_cast<double>(p.list.size()));
            for (const double item : p.list) data += plyValue(flavor.format, p.type, item);
        }
        if (flavor.format == "ascii") data.replace(data.size() - 1, 1, flavor.lineEnd);
    }
}

}  // namespace

TestMesh testCube() {
    TestMesh mesh;
    for (unsigned i = 0; i < 8; ++i) {
        Corner corner;
        corner.position = glm::dvec3(i & 1 ? 20 : 1, i & 2 ? 30 : 2, i & 4 ? 127 : 3);
        corner.color = 0xff000000u | (i * 30) << 16 | (255 - i) << 8 | (i * 3 + 1);
        corner.normal = i & 1 ? glm::vec3(0, 0, -1) : glm::vec3(1, 0, 0);
        mesh.vertices.push_back(corner);
    }
    mesh.polygons = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5}, {0, 1, 3, 2, 6}, {2, 3, 7, 6}};
    return mesh;
}

std::vector<Triangle> fanned(const TestMesh& mesh, bool colors, bool normals) {
    std::vector<Triangle> triangles;
    const auto corner = [&](unsigned index) {
        Corner c = mesh.vertices[index];
        if (!colors) c.color = 0;
        if (!normals) c.normal = glm::vec3(0);
        return c;
    };
    for (const auto& polygon : mesh.polygons) {
        for (std::size_t i = 2; i < polygon.size(); ++i) {
            triangles.push_back({corner(polygon[0]), corner(polygon[i - 1]), corner(polygon[i])});
        }
    }
    return triangles;
}

std::string plyValue(const std::string& format, const std::string& type, double value) {
    if (format == "ascii") return fmt::format("{} ", value);
    const bool swap = format == "binary_big_endian";
    if (type == "char" || type == "int8") return bytesOfValue<std::int8_t>(value, swap);
    if (type == "uchar" || type == "uint8") return bytesOfValue<std::uint8_t>(value, swap);
    if (type == "short" || type == "int16") return bytesOfValue<std::int16_t>(value, swap);
    if (type == "ushort" || type == "uint16") return bytesOfValue<std::uint16_t>(value, swap);
    if (type == "int" || type == "int32") return bytesOfValue<std::int32_t>(value, swap);
    if (type == "uint" || type == "uint32") return bytesOfValue<std::uint32_t>(value, swap);
    if (type == "float" || type == "float32") return bytesOfValue<float>(value, swap);
    return bytesOfValue<double>(value, swap);
}

std::string writePly(const TestMesh& mesh, const PlyFlavor& flavor) {
    std::string header = "ply" + flavor.lineEnd + "format " + flavor.format + " 1.0" + flavor.lineEnd +
                         "comment made by a test" + flavor.lineEnd;
    std::string data;
    std::vector<Record> vertices, faces;
    for (const Corner& v : mesh.vertices) vertices.push_back(vertexRecord(v, flavor));
    for (const auto& polygon : mesh.polygons) faces.push_back(faceRecord(polygon, flavor));

    if (flavor.extras) addElement("camera", {{{"float", "fov", 60, {}, {}}}}, flavor, header, data);
    if (flavor.facesFirst) addElement("face", faces, flavor, header, data);
    addElement("vertex", vertices, flavor, header, data);
    if (flavor.extras)
        addElement("edge", {{{"int", "pair", 0, {3, 4}, "uchar"}}, {{"int", "pair", 0, {}, "uchar"}}}, flavor,
                   header, data);
    if (!flavor.facesFirst) addElement("face", faces, flavor, header, data);
    return header + "end_header" + flavor.lineEnd + data;
}

}  // namespace iwalk
