#pragma once

#include <gtest/gtest.h>

#include "preprocess/build/build.hpp"
#include "server/draw/gl_context.hpp"
#include "server/frame/tile_pipeline.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/tools/scenes.hpp"

namespace iwalk::tools {

class Silent : public Progress {
    void phase(const std::string&) override {}
    void done(double) override {}
};

// A square at x = `x`, in 2 * parts * parts triangles, so that it fills ranges.
inline Triangles wallAt(double x, double half, int parts) {
    Triangles triangles;
    const double step = 2 * half / parts;
    for (int i = 0; i < parts; ++i)
        for (int j = 0; j < parts; ++j) {
            const double y = -half + step * i, z = -half + step * j;
            triangles.push_back({glm::dvec3(x, y, z), {x, y + step, z}, {x, y + step, z + step}});
            triangles.push_back({glm::dvec3(x, y, z), {x, y + step, z + step}, {x, y, z + step}});
        }
    return triangles;
}

// A GL context for all tests of this program.
class RenderTest : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        Result<std::unique_ptr<GlContext>> context = GlContext::createHeadless();
        ASSERT_TRUE(context.ok()) << context.error().message;
        context_ = std::move(context).value();
    }
    static void TearDownTestSuite() { context_.reset(); }

    // Builds a dataset; leaves are small so that there are many pages.
    Dataset build(const Triangles& triangles, const PlyOptions& options = {},
                  std::uint32_t leafTriangles = 500) {
        const std::string ply = directory_.path("model.ply"), path = directory_.path("dataset");
        EXPECT_TRUE(writePly(ply, triangles, options).ok());
        BuildOptions build;
        build.inputs = {ply};
        build.output = path;
        build.leafTriangles = leafTriangles;
        return open(build);
    }
    Dataset buildFile(const std::string& input) {
        BuildOptions build;
        build.inputs = {input};
        build.output = directory_.path("dataset");
        build.leafTriangles = 4000;
        return open(build);
    }
    static Dataset open(const BuildOptions& build) {
        Silent silent;
        const Result<Manifest> built = buildDataset(build, silent);
        EXPECT_TRUE(built.ok()) << built.error().message;
        Result<Dataset> dataset = openDataset(build.output);
        EXPECT_TRUE(dataset.ok()) << dataset.error().message;
        return std::move(dataset).value();
    }

    const TempDirectory directory_;
    static inline std::unique_ptr<GlContext> context_;
};

}  // namespace iwalk::tools
