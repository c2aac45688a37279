#include "common/dataset/manifest.hpp"

#include "tests/common/dataset_fixture.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace iwalk;

// Where the files are that the seed names.
struct Dataset {
    Dataset() {
        const Manifest manifest = makeManifest();
        std::vector<DatasetFile> files = manifest.pageFiles;
        files.push_back(manifest.hierarchy);
        for (const DatasetFile& file : files) directory.write(file.name, std::string(file.bytes, '\0'));
    }
    TempDirectory directory;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Dataset dataset;
    dataset.directory.write(kManifestName, std::string(reinterpret_cast<const char*>(data), size));
    const auto manifest = loadManifest(dataset.directory.path(""));
    if (manifest) {
        CHECK(!manifest->bounds.empty());
        CHECK_OP(manifest->leaves, <=, manifest->nodes);
    } else {
        CHECK(manifest.error().message.find('\n') == std::string::npos);
    }
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    const TempDirectory directory;
    CHECK(saveManifest(directory.path(""), makeManifest()).ok());
    return {readWholeFile(directory.path(kManifestName), 1 << 20).value()};
}
