#include "preprocess/import/stl_importer.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    iwalk::readAll(iwalk::openStl("fuzz.stl", std::make_unique<iwalk::MemoryFile>(data, size)));
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    std::string binary(84 + 2 * 50, '\0');
    binary[80] = 2;
    for (std::size_t at = 84; at < binary.size(); at += 7) binary[at] = '\x3f';
    // Its header begins as a text does, and its count was never filled in.
    std::string solid = binary;
    solid.replace(0, 8, "solid a ");
    solid[80] = 0;
    const std::string facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e3 0 -.5\nvertex 0 1 nan\nendloop\nendfacet\n";
    return {binary, solid, "solid a\n" + facet + facet + "endsolid a\n",
            "SOLID\r\n" + facet + "endsolid\nsolid b c\n" + facet + "endsolid b c"};
}
