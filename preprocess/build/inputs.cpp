#include "preprocess/build/inputs.hpp"

#include <glob.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "preprocess/build/survey.hpp"
#include "preprocess/import/placement.hpp"

namespace iwalk {
namespace {

namespace fs = std::filesystem;

Result<void> addDirectory(const std::string& directory, std::vector<std::string>& files) {
    std::vector<std::string> found;
    std::error_code error;
    fs::recursive_directory_iterator entry(directory, error);
    for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
        std::error_code ignored;
        if (isModelName(entry->path().string()) && entry->is_regular_file(ignored))
            found.push_back(entry->path().string());
    }
    if (error) return fail("{}: cannot be listed: {}", directory, error.message());
    if (found.empty()) return fail("{}: has no models in it", directory);
    std::ranges::sort(found);
    files.insert(files.end(), found.begin(), found.end());
    return {};
}

// Of a name that is no file's itself. Left as it is when nothing matches: opening it says what is wrong.
void addMatches(const std::string& pattern, std::vector<std::string>& files) {
    glob_t matches{};
    if (::glob(pattern.c_str(), GLOB_NOCHECK, nullptr, &matches) == 0)
        files.insert(files.end(), matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
    else
        files.push_back(pattern);
    ::globfree(&matches);
}

}  // namespace

Result<std::vector<std::string>> findInputs(const std::vector<std::string>& names) {
    std::vector<std::string> files;
    for (const std::string& name : names) {
        std::error_code ignored;
        const fs::file_status status = fs::status(name, ignored);
        if (fs::is_directory(status)) {
            RETURN_IF_ERROR(addDirectory(name, files));
        } else if (fs::exists(status) || name.find_first_of("*?[") == std::string::npos) {
            files.push_back(name);
        } else {
            addMatches(name, files);
        }
    }
    return files;
}

Inputs::Inputs(const BuildOptions& options, const Budget& budget, const std::string& spillDirectory,
               ImporterFactory factory)
    : turn_(options.import.yUp),
      files_(options.inputs,
             {.memoryBytes = budget.importerBytes,
              .spillDirectory = spillDirectory,
              .choices = options.import,
              .threads = budget.threads},
             std::move(factory)) {}

Result<std::vector<ImportSummary>> Inputs::scan(const VertexSink& vertices, const ProgressSink& progress) {
    const Placement turn = yUpToZUp();
    std::vector<glm::dvec3> turned;
    Distances distances;
    const VertexSink looking = [&](std::span<const glm::dvec3> points) {
        distances.add(points);
        if (!turn_) return vertices(points);
        turned.clear();
        for (const glm::dvec3& point : points) turned.push_back(turn.point(point));
        vertices(turned);
    };
    std::vector<ImportSummary> summaries;
    for (std::size_t i = 0; i < files_.size(); ++i) {
        distances = {};
        ASSIGN_OR_RETURN(ImportSummary summary,
                         files_.scan(i, vertices ? looking : vertices, partOf(progress, i, files_.size())));
        summary.precision = std::ldexp(summary.precision, -distances.spareDigits());
        if (turn_) summary.bounds = turn.box(summary.bounds);
        summaries.push_back(summary);
    }
    return summaries;
}

Result<ImportCounts> Inputs::triangles(std::size_t index, const TriangleSink& sink,
                                       const ProgressSink& progress) {
    if (!turn_) return files_.triangles(index, sink, progress);
    const Placement turn = yUpToZUp();
    std::vector<Triangle> turned;
    const auto turning = [&](std::span<const Triangle> triangles) {
        turned.clear();
        turn.append(triangles, turned);
        return sink(turned);
    };
    return files_.triangles(index, turning, progress);
}

}  // namespace iwalk
