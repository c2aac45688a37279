#include "preprocess/import/ply_importer.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/import/ply_writer.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto open = [&](const iwalk::ImportLimits& limits) {
        return iwalk::openPly("fuzz.ply", std::make_unique<iwalk::MemoryFile>(data, size), limits);
    };
    iwalk::readInBlocks(open, size);
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    std::vector<std::string> seeds;
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        PlyFlavor flavor{.color = "uchar", .normals = true};
        flavor.format = format;
        seeds.push_back(writePly(testCube(), flavor));
        flavor.extras = flavor.vertexLists = flavor.alpha = true;
        seeds.push_back(writePly(testCube(), flavor));
        flavor = {.format = format, .coordinate = "double", .count = "int", .index = "ushort"};
        seeds.push_back(writePly(testCube(), flavor));
        flavor = {.format = format, .coordinate = "short", .indexName = "vertex_index", .color = "float"};
        flavor.colorPrefix = "diffuse_", flavor.facesFirst = true, flavor.lineEnd = "\r\n";
        seeds.push_back(writePly(testCube(), flavor));
    }
    return seeds;
}
