#include "preprocess/generate/generate.hpp"

#include <fmt/format.h>

#include <functional>

#include "preprocess/generate/isosurface.hpp"
#include "preprocess/generate/plant.hpp"
#include "preprocess/generate/ply_output.hpp"
#include "preprocess/generate/sphere.hpp"

namespace iwalk {
namespace {

using Write = std::function<Result<void>(PlyOutput&, Progress&)>;

struct Scene {
    bool colors = false;
    Write write;
};

Result<Scene> sceneOf(const GenerateOptions& options) {
    const std::uint64_t triangles = options.triangles, seed = options.seed;
    if (options.scene == "sphere") {
        return Scene{false, [=](PlyOutput& output, Progress& progress) {
                         return generateSphere(triangles, seed, output, progress);
                     }};
    }
    if (options.scene == "plant") {
        return Scene{true, [=](PlyOutput& output, Progress& progress) {
                         return generatePlant(triangles, seed, output, progress);
                     }};
    }
    if (options.scene == "isosurface") {
        return Scene{true, [=](PlyOutput& output, Progress& progress) {
                         return generateIsosurface(triangles, seed, output, output.directory(), progress);
                     }};
    }
    return fail("there is no scene '{}': sphere, plant and isosurface there are", options.scene);
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
                     PlyOutput::create(options.output, scene.colors, note));
    RETURN_IF_ERROR(scene.write(*output, progress));
    progress.phase("syncing");
    RETURN_IF_ERROR(output->finish());
    return Generated{output->vertices(), output->triangles(), output->bytes()};
}

}  // namespace iwalk
