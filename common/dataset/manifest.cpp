#include "common/dataset/manifest.hpp"

#include <sys/stat.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "common/file.hpp"

namespace iwalk {
namespace {

using nlohmann::ordered_json;

constexpr const char* kFormatName = "iwalk-dataset";
constexpr std::uint64_t kManifestLimit = std::uint64_t{16} << 20;
constexpr int kMaxStepExponent = 1000;
constexpr const char* kRebuild = "the manifest is damaged: build the dataset again";

// Reads keys of one JSON object; the first thing wrong is kept, and everything after it is skipped.
class Reader {
  public:
    Reader(std::string path, const ordered_json& object) : path_(std::move(path)), object_(object) {}

    template <class T>
    void get(const char* key, T& out, T most = std::numeric_limits<T>::max()) {
        const ordered_json* value = find(key);
        if (value == nullptr) return;
        if constexpr (std::is_same_v<T, bool>) {
            if (!value->is_boolean()) return complain(key, "true or false");
        } else if constexpr (std::is_same_v<T, std::string>) {
            if (!value->is_string()) return complain(key, "a string");
        } else {
            if (!value->is_number_unsigned() || value->get<std::uint64_t>() > most) {
                return complain(key, fmt::format("a whole number from 0 to {}", most));
            }
        }
        out = value->get<T>();
    }

    // Of a key that may be missing.
    void getCount(const char* key, std::uint64_t& out) {
        if (object_.contains(key)) get(key, out);
    }

    void getExponent(const char* key, int& out) {
        const ordered_json* value = find(key);
        if (value == nullptr) return;
        if (!value->is_number_integer() || std::abs(value->get<double>()) > kMaxStepExponent) {
            return complain(key, "a whole number from -1000 to 1000");
        }
        out = value->get<int>();
    }

    void getPoint(const char* key, glm::dvec3& out) {
        const ordered_json* value = find(key);
        if (value == nullptr) return;
        bool good = value->is_array() && value->size() == 3;
        for (std::size_t axis = 0; good && axis < 3; ++axis) {
            good = (*value)[axis].is_number();
            if (good) out[axis] = (*value)[axis].get<double>();
            good = good && std::isfinite(out[axis]);
        }
        if (!good) complain(key, "three finite numbers");
    }

    void getDistance(const char* key, double& out) {
        const ordered_json* value = find(key);
        if (value == nullptr) return;
        if (value->is_number()) out = value->get<double>();
        if (!value->is_number() || !std::isfinite(out) || out < 0) complain(key, "a finite number from 0 on");
    }

    // The object, or list of objects, under `key`, each read by `read`.
    template <class Read>
    void getObject(const char* key, Read read) {
        const ordered_json* value = find(key);
        if (value != nullptr) readObject(key, *value, read);
    }
    template <class Read>
    void getList(const char* key, Read read) {
        const ordered_json* value = find(key);
        if (value == nullptr) return;
        if (!value->is_array()) return complain(key, "a list");
        for (const ordered_json& item : *value) readObject(key, item, read);
    }

    void complain(const std::string& key, const std::string& wanted) {
        if (!error_) error_ = fail("{}: \"{}\" must be {}; {}", path_, key, wanted, kRebuild);
    }
    const std::optional<Error>& error() const { return error_; }

  private:
    const ordered_json* find(const char* key) {
        if (error_) return nullptr;
        const auto found = object_.find(key);
        if (found != object_.end()) return &*found;
        error_ = fail("{}: \"{}\" is missing; {}", path_, key, kRebuild);
        return nullptr;
    }
    template <class Read>
    void readObject(const char* key, const ordered_json& value, Read read) {
        if (error_) return;
        if (!value.is_object()) return complain(key, "made of objects");
        Reader inner(path_, value);
        read(inner);
        error_ = inner.error_;
    }

    std::string path_;
    const ordered_json& object_;
    std::optional<Error> error_;
};

bool isPlainName(const std::string& name) {
    return !name.empty() && name != "." && name != ".." && name.size() < 256 &&
           name.find_first_of(std::string("/\\\0", 3)) == std::string::npos;
}

void readFile(Reader& reader, DatasetFile& file) {
    reader.get("name", file.name);
    reader.get("bytes", file.bytes);
    if (!reader.error() && !isPlainName(file.name)) reader.complain("name", "a plain file name");
}

Result<void> checkFile(const std::string& dataset, const DatasetFile& file) {
    const std::string path = dataset + "/" + file.name;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) {
        return fail("{}: missing, although {} names it; copy the dataset again or rebuild it", path,
                    kManifestName);
    }
    if (static_cast<std::uint64_t>(status.st_size) != file.bytes) {
        return fail("{}: {} bytes where {} says {}; copy the dataset again or rebuild it", path,
                    status.st_size, kManifestName, file.bytes);
    }
    return {};
}

void readCounts(Reader& reader, Manifest& manifest) {
    reader.get("generation", manifest.generation);
    reader.get("triangles", manifest.triangles);
    reader.get("vertices", manifest.vertices);
    reader.get("nodes", manifest.nodes, std::uint64_t{0xffffffff});
    reader.get("leaves", manifest.leaves, manifest.nodes);
    reader.get("pages", manifest.pages, std::uint64_t{0xffffffff});
    reader.get("leaf_triangles", manifest.leafTriangles, std::uint64_t{0xffffffff});
}

void readLevel(Reader& reader, LevelSummary& level) {
    reader.getDistance("error", level.error);
    reader.get("triangles", level.triangles);
    reader.get("bytes", level.bytes);
}

void readAll(Reader& reader, Manifest& manifest) {
    readCounts(reader, manifest);
    reader.getObject("attributes", [&](Reader& attributes) {
        attributes.get("colors", manifest.colors);
        attributes.get("normals", manifest.normals);
    });
    reader.getList("levels", [&](Reader& level) { readLevel(level, manifest.levels.emplace_back()); });
    reader.getObject("full", [&](Reader& level) { readLevel(level, manifest.full); });
    reader.getExponent("step_exponent", manifest.stepExponent);
    reader.getObject("bounds", [&](Reader& bounds) {
        bounds.getPoint("min", manifest.bounds.min);
        bounds.getPoint("max", manifest.bounds.max);
    });
    if (manifest.bounds.empty()) reader.complain("bounds", "a box with min <= max");
    reader.getObject("hierarchy", [&](Reader& file) { readFile(file, manifest.hierarchy); });
    reader.getList("page_files", [&](Reader& file) { readFile(file, manifest.pageFiles.emplace_back()); });
    reader.getList("provenance", [&](Reader& input) {
        Provenance& provenance = manifest.provenance.emplace_back();
        input.get("input", provenance.input);
        input.get("triangles", provenance.triangles);
        input.get("dropped_non_finite", provenance.droppedNonFinite);
        input.get("dropped_degenerate", provenance.droppedDegenerate);
        input.getCount("split", provenance.split);
        input.getCount("cut", provenance.cut);
    });
}

ordered_json pointJson(const glm::dvec3& point) {
    return ordered_json::array({point.x, point.y, point.z});
}

ordered_json fileJson(const DatasetFile& file) {
    ordered_json json;
    json["name"] = file.name;
    json["bytes"] = file.bytes;
    return json;
}

ordered_json levelJson(const LevelSummary& level) {
    ordered_json json;
    json["error"] = level.error;
    json["triangles"] = level.triangles;
    json["bytes"] = level.bytes;
    return json;
}

ordered_json provenanceJson(const Provenance& provenance) {
    ordered_json json;
    json["input"] = provenance.input;
    json["triangles"] = provenance.triangles;
    json["dropped_non_finite"] = provenance.droppedNonFinite;
    json["dropped_degenerate"] = provenance.droppedDegenerate;
    if (provenance.split > 0) json["split"] = provenance.split;
    if (provenance.cut > 0) json["cut"] = provenance.cut;
    return json;
}

ordered_json manifestJson(const Manifest& manifest) {
    ordered_json json;
    json["format"] = kFormatName;
    json["version"] = kDatasetVersion;
    json["generation"] = manifest.generation;
    json["triangles"] = manifest.triangles;
    json["vertices"] = manifest.vertices;
    json["nodes"] = manifest.nodes;
    json["leaves"] = manifest.leaves;
    json["pages"] = manifest.pages;
    json["leaf_triangles"] = manifest.leafTriangles;
    json["levels"] = ordered_json::array();
    for (const LevelSummary& level : manifest.levels) json["levels"].push_back(levelJson(level));
    json["full"] = levelJson(manifest.full);
    json["attributes"]["colors"] = manifest.colors;
    json["attributes"]["normals"] = manifest.normals;
    json["step_exponent"] = manifest.stepExponent;
    json["bounds"]["min"] = pointJson(manifest.bounds.min);
    json["bounds"]["max"] = pointJson(manifest.bounds.max);
    json["hierarchy"] = fileJson(manifest.hierarchy);
    json["page_files"] = ordered_json::array();
    for (const DatasetFile& file : manifest.pageFiles) json["page_files"].push_back(fileJson(file));
    json["provenance"] = ordered_json::array();
    for (const Provenance& input : manifest.provenance) json["provenance"].push_back(provenanceJson(input));
    return json;
}

// The version first: another version's keys are not ours to judge.
Result<void> checkVersion(const std::string& path, const ordered_json& json) {
    Reader reader(path, json);
    std::string format;
    std::uint32_t version = 0;
    reader.get("format", format);
    if (!reader.error() && format != kFormatName)
        reader.complain("format", std::string("\"") + kFormatName + "\"");
    reader.get("version", version);
    if (reader.error()) return *reader.error();
    if (version != kDatasetVersion) {
        return fail(
            "{}: dataset version {}, but this program reads version {}; build the dataset again with it",
            path, version, kDatasetVersion);
    }
    return {};
}

}  // namespace

Result<Manifest> loadManifest(const std::string& dataset) {
    const std::string path = dataset + "/" + kManifestName;
    ASSIGN_OR_RETURN(const std::string text, readWholeFile(path, kManifestLimit));
    const ordered_json json = ordered_json::parse(text, nullptr, false);
    if (!json.is_object()) return fail("{}: not a JSON object; {}", path, kRebuild);
    RETURN_IF_ERROR(checkVersion(path, json));

    Manifest manifest;
    Reader reader(path, json);
    readAll(reader, manifest);
    if (reader.error()) return *reader.error();

    RETURN_IF_ERROR(checkFile(dataset, manifest.hierarchy));
    for (const DatasetFile& file : manifest.pageFiles) RETURN_IF_ERROR(checkFile(dataset, file));
    return manifest;
}

Result<void> saveManifest(const std::string& dataset, const Manifest& manifest) {
    // Names that are not UTF-8 are written with replacement characters: they are for people only.
    const std::string text =
        manifestJson(manifest).dump(2, ' ', false, ordered_json::error_handler_t::replace);
    return replaceFile(dataset + "/" + kManifestName, text + "\n");
}

}  // namespace iwalk
