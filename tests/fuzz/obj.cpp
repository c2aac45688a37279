#include "preprocess/import/obj_importer.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    iwalk::readAll(iwalk::openObj("/nowhere/fuzz.obj", std::make_unique<iwalk::MemoryFile>(data, size),
                                  iwalk::fuzzLimits()));
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    return {
        "mtllib a.mtl\nv 0 0 0\nv 1.5 0 0 1 0 .5\nv 1 1e2 0\nv 0 -1 0\nvn 0 0 1\nvt 0 0\nusemtl a\n"
        "f 1//1 2//-1 \\\n3/1/1 -1\ng x\nf 1 2 3\nf -1 -2 -3 -4\n"};
}
