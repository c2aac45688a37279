#include "preprocess/import/vrml_importer.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    iwalk::readAll(
        iwalk::openVrml("fuzz.wrl", std::make_unique<iwalk::MemoryFile>(data, size), iwalk::fuzzLimits()));
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    const std::string head = "#VRML V2.0 utf8\n";
    return {
        head +
            "DEF T Transform { rotation 0 0 1 1.5 children [ DEF S Shape { geometry DEF F IndexedFaceSet { "
            "coord "
            "Coordinate { point [0 0 0, 1 0 0, 1 1 0 0 1 0] } coordIndex [0 1 2 3 -1 0 1 2] } appearance "
            "Appearance { material DEF M Material { diffuseColor 1 .5 0 } } } USE S ] scale 2 2 2 }\nUSE T\n",
        head +
            "# a\nSwitch { whichChoice 0 choice Shape { geometry IndexedFaceSet { ccw FALSE colorPerVertex "
            "FALSE "
            "colorIndex [1] color Color { color [1 0 0, 0 1 0] } coord Coordinate { point [0 0 0 1 0 0 0 1 "
            "0] "
            "} coordIndex [0 1 2] } } }\nPROTO P [ ] { Group {} }\nROUTE a.b TO c.d\nLOD { level [ Group {} "
            "] }"};
}
