// Checksums are made right before each look, so that what lies behind them is reached.
#include "common/dataset/hierarchy.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "common/dataset/hierarchy_check.hpp"
#include "tests/common/dataset_fixture.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace iwalk;

constexpr std::size_t kHash = kHierarchyHeaderBytes - 8, kPayloadHash = kHierarchyHeaderBytes - 16;

void putHashes(std::string& bytes) {
    if (bytes.size() < kHierarchyHeaderBytes) return;
    const XXH64_hash_t payload =
        XXH64(bytes.data() + kHierarchyHeaderBytes, bytes.size() - kHierarchyHeaderBytes, 0);
    std::memcpy(bytes.data() + kPayloadHash, &payload, sizeof payload);
    const XXH64_hash_t header = XXH64(bytes.data(), kHash, 0);
    std::memcpy(bytes.data() + kHash, &header, sizeof header);
}

// What programs do with a hierarchy that was found good.
void use(const Hierarchy& hierarchy) {
    CHECK_OP(cellsOfNodes(hierarchy).size(), ==, hierarchy.nodes.size());
    std::uint64_t triangles = 0;
    for (const NodeRecord& node : hierarchy.nodes) {
        triangles += hierarchy.ownTriangles(node);
        for (const unsigned level : {0u, 1u, unsigned{kFullLevel}}) {
            const LevelRecord* const entry = hierarchy.drawnAt(node, level);
            if (entry != nullptr) CHECK(Hierarchy::box(node).contains(Hierarchy::entryBox(node, *entry)));
        }
    }
    CHECK_OP(triangles, ==, makeManifest().triangles);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const TempDirectory directory;
    static const Manifest manifest = makeManifest();
    std::string bytes(reinterpret_cast<const char*>(data), size);
    putHashes(bytes);
    directory.write(manifest.hierarchy.name, bytes);
    const auto hierarchy = loadHierarchy(directory.path(""), manifest);
    if (hierarchy) {
        use(*hierarchy);
    } else {
        CHECK(hierarchy.error().message.find('\n') == std::string::npos);
    }
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    const TempDirectory directory;
    CHECK(saveHierarchy(directory.path("h"), makeHierarchy()).ok());
    return {readWholeFile(directory.path("h"), 1 << 20).value()};
}
