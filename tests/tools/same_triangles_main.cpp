// Whether two models are the same triangles, in whatever order and format: pairs those of one with those of
// the other, as iwalk-preprocess reads them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "preprocess/import/importer.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/tools/triangle_set.hpp"

namespace {

using namespace iwalk;

constexpr std::uint64_t kReaderBytes = std::uint64_t{2} << 30;
constexpr int kDifferent = 1, kError = 2;

tools::Triangle cornersOf(const Triangle& t) {
    return {t[0].position, t[1].position, t[2].position};
}

Result<ImportCounts> read(const std::string& path, const std::function<void(const tools::Triangle&)>& use) {
    const TempDirectory spill;
    ASSIGN_OR_RETURN(const auto importer, openImporter(path, {kReaderBytes, spill.path("")}));
    RETURN_IF_ERROR(importer->scan([](std::span<const glm::dvec3>) {}, {}));
    return importer->triangles(
        [&](const std::vector<Triangle>& batch) {
            for (const Triangle& t : batch) use(cornersOf(t));
            return Result<void>();
        },
        {});
}

void printAlone(const std::string& path, std::uint64_t count, const std::optional<tools::Triangle>& example) {
    fmt::print("only in {}: {}", path, count);
    if (example) {
        fmt::print(", such as");
        for (const glm::dvec3& p : *example) fmt::print(" ({}, {}, {})", p.x, p.y, p.z);
    }
    fmt::print("\n");
}

// Whether all found another.
Result<bool> compare(const std::string& first, const std::string& second, double within) {
    std::vector<tools::Triangle> triangles;
    RETURN_IF_ERROR(read(first, [&](const tools::Triangle& t) { triangles.push_back(t); }));
    const std::size_t inFirst = triangles.size();
    tools::TriangleSet set(std::move(triangles), within);

    std::uint64_t paired = 0;
    double farthest = 0;
    std::optional<tools::Triangle> alone;
    ASSIGN_OR_RETURN(const ImportCounts counts, read(second, [&](const tools::Triangle& t) {
                         const std::optional<double> apart = set.take(t);
                         if (apart) ++paired, farthest = std::max(farthest, *apart);
                         if (!apart && !alone) alone = t;
                     }));
    const std::vector<tools::Triangle> left = set.left();
    fmt::print("{}: {} triangles\n{}: {} triangles\n", first, inFirst, second, counts.triangles);
    fmt::print("pairs: {}, at most {} apart\n", paired, farthest);
    printAlone(first, left.size(), left.empty() ? std::nullopt : std::optional(left[0]));
    printAlone(second, counts.triangles - paired, alone);
    return left.empty() && !alone;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app(
        "Whether two models are the same triangles, in any order and format; holds the first in memory (some "
        "160 bytes a triangle). Exit code 0: each has its own counterpart; 1: some have none; others: "
        "errors.",
        "iwalk-same-triangles");
    std::string first, second;
    double within = 0;
    app.add_option("first", first, "Model")->required();
    app.add_option("second", second, "Model")->required();
    app.add_option("--within", within, "How far corners may lie apart in each axis, model units")
        ->check(CLI::Range(0.0, 1e300))
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    const Result<bool> same = compare(first, second, within);
    if (!same) return fmt::print(stderr, "iwalk-same-triangles: {}\n", same.error().message), kError;
    return *same ? EXIT_SUCCESS : kDifferent;
} catch (const std::exception& error) {  // no memory for the triangles, for instance
    return fmt::print(stderr, "iwalk-same-triangles: {}\n", error.what()), kError;
}
