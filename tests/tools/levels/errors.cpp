#include "tests/tools/levels/errors.hpp"

#include "tests/tools/levels/level_triangles.hpp"

namespace iwalk::levels {

Result<std::vector<LevelErrors>> measureErrors(const DatasetPages& pages, const SampleOptions& options) {
    std::vector<LevelErrors> report;
    const FixedGrid grid(pages.hierarchy());
    ASSIGN_OR_RETURN(auto input, levelTriangles(pages, grid, kFullLevel));
    if (input.empty()) return report;
    const Reference full(std::move(input), options);
    const double unit = grid.unit(pages.manifest());
    for (unsigned level = 0; level < pages.manifest().levels.size(); ++level) {
        LevelErrors errors{level, 0, pages.manifest().levels[level].error, {}, {}};
        ASSIGN_OR_RETURN(auto triangles, levelTriangles(pages, grid, level));
        errors.triangles = triangles.size();
        errors.whole = deviationOf(std::move(triangles), full, errors.error / unit);
        ASSIGN_OR_RETURN(auto half, halfMorphTriangles(pages, grid, level));
        errors.halfMorph = deviationOf(std::move(half), full, errors.error / unit);
        report.push_back(errors);
    }
    return report;
}

}  // namespace iwalk::levels
