#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "preprocess/import/importer.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk {

// Everything that an importer hands out.
struct Imported {
    ImportSummary summary;
    ImportCounts counts;
    std::vector<glm::dvec3> vertices;
    std::vector<Triangle> triangles;
    std::vector<double> progress;
};

inline bool operator==(const Corner& a, const Corner& b) {
    return a.position == b.position && a.color == b.color && a.normal == b.normal;
}

// But for progress.
inline bool operator==(const Imported& a, const Imported& b) {
    const ImportSummary &s = a.summary, &t = b.summary;
    return a.triangles == b.triangles && a.vertices == b.vertices &&
           a.counts.triangles == b.counts.triangles &&
           a.counts.droppedNonFinite == b.counts.droppedNonFinite && s.vertices == t.vertices &&
           s.triangleBound == t.triangleBound && s.bounds == t.bounds && s.precision == t.precision &&
           s.colors == t.colors && s.normals == t.normals;
}

class ImportTest : public testing::Test {
  protected:
    Result<Imported> import(const std::string& name, std::uint64_t memoryBytes = std::uint64_t{16} << 20) {
        return import(name, ImportLimits{memoryBytes, directory_.path("")});
    }
    Result<Imported> import(const std::string& name, const ImportLimits& limits) {
        Imported out;
        ASSIGN_OR_RETURN(const auto importer, openImporter(directory_.path(name), limits));
        const ProgressSink progress = [&](double part) { out.progress.push_back(part); };
        const VertexSink vertices = [&](std::span<const glm::dvec3> batch) {
            out.vertices.insert(out.vertices.end(), batch.begin(), batch.end());
        };
        const TriangleSink triangles = [&](std::span<const Triangle> batch) {
            out.triangles.insert(out.triangles.end(), batch.begin(), batch.end());
            return Result<void>();
        };
        ASSIGN_OR_RETURN(out.summary, importer->scan(vertices, progress));
        ASSIGN_OR_RETURN(out.counts, importer->triangles(triangles, progress));
        return out;
    }

    Result<Imported> importText(const std::string& name, const std::string& contents) {
        directory_.write(name, contents);
        return import(name);
    }

    // The error without the file's path and ": "; "" when there is none, or it is not one line that begins
    // so.
    std::string errorOf(const std::string& name, const std::string& contents) {
        const auto result = importText(name, contents);
        if (result.ok()) return "";
        const std::string& message = result.error().message;
        const std::string begin = directory_.path(name) + ": ";
        const bool good = message.starts_with(begin) && message.find('\n') == message.npos;
        return good ? message.substr(begin.size()) : "bad form: " + message;
    }

    TempDirectory directory_;
};

}  // namespace iwalk
