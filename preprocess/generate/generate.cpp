#include "preprocess/generate/generate.hpp"

#include <fmt/format.h>

#include <functional>

#include "preprocess/generate/hard.hpp"
#include "preprocess/generate/isosurface.hpp"
#include "preprocess/generate/plant.hpp"
#include "preprocess/generate/ply_output.hpp"
#include "preprocess/generate/sphere.hpp"
#include "preprocess/generate/terrain.hpp"

namespace iwalk {
namespace {

using Write = std::function<Result<void>(PlyOutput&, Progress&)>;

struct Scene {
    VertexLayout layout;
    Write write;
};

Result<Scene> sceneOf(const GenerateOptions& options) {
    const std::uint64_t triangles = options.triangles, seed = options.seed;
    if (options.scene == "sphere") {
        return Scene{{}, [=](PlyOutput& output, Progress& progress) {
                         return generateSphere(triangles, seed, output, progress);
                     }};
    }
    if (options.scene == "plant") {
        return Scene{{.colors = true}, [=](PlyOutput& output, Progress& progress) {
                         return generatePlant(triangles, seed, output, progress);
                     }};
    }
    if (options.scene == "isosurface") {
        return Scene{{.colors = true}, [=](PlyOutput& output, Progress& progress) {
                         return generateIsosurface(triangles, seed, output, output.directory(), progress);
                     }};
    }
    if (options.scene == "terrain") {
        return Scene{{.colors = true}, [=](PlyOutput& output, Progress& progress) {
                         return generateTerrain(triangles, seed, output, progress);
                     }};
    }
    if (isHardScene(options.scene)) {
        return Scene{hardLayout(options.scene),
                     [=, name = options.scene](PlyOutput& output, Progress& progress) {
                         return generateHard(name, triangles, seed, output, progress);
                     }};
    }
    return fail("there is no scene '{}': see --help", options.scene);
}

}  // namespace

Result<Generated> generateScene(const GenerateOptions& options, Progress& progress) {
    if (options.triangles < kLeastGenerated || options.triangles > kMostGenerated) {
        return fail("{} triangles cannot be made: {} to {} can", options.triangles, kLeastGenerated,
                    kMostGenerated);
    }
    ASSIGN_OR_RETURN(const Scene scene, sceneOf(options));
    const std::string note = fmt::format("iwalk-preprocess generate {} --triangles {} --seed {}",
                                         options.scene, options.triangles, options.seed);
    ASSIGN_OR_RETURN(const std::unique_ptr<PlyOutput> output,
                     PlyOutput::create(options.output, scene.layout, note));
    RETURN_IF_ERROR(scene.write(*output, progress));
    progress.phase("syncing");
    RETURN_IF_ERROR(output->finish());
    return Generated{output->vertices(), output->triangles(), output->bytes()};
}

}  // namespace iwalk
