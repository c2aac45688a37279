#include "preprocess/generate/generate.hpp"

#include <fmt/format.h>

#include <chrono>

#include "common/settings.hpp"
#include "preprocess/command/commands.hpp"
#include "preprocess/command/progress_bar.hpp"

namespace iwalk {

Result<void> runGenerate(const GenerateOptions& options) {
    const auto began = std::chrono::steady_clock::now();
    Result<Generated> generated = [&] {
        ProgressBar progress;
        return generateScene(options, progress);
    }();
    if (!generated) return generated.error();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - began;
    const double triangles = static_cast<double>(generated->triangles);
    fmt::print("{} triangles, {} vertices, {} in {:.1f} s: {:.2f} Mtri/s\n", generated->triangles,
               generated->vertices, formatBytes(generated->bytes), time.count(),
               triangles / time.count() / 1e6);
    return {};
}

}  // namespace iwalk
