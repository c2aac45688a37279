#include "preprocess/import/vrml_importer.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    iwalk::readAll(
        iwalk::openVrml("fuzz.wrl", std::make_unique<iwalk::MemoryFile>(data, size), iwalk::fuzzLimits()));
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    const std::string head = "#VRML V2.0 utf8\n";
    return {head + R"(DEF T Transform {
  rotation 0 0 1 1.5 center 1 2 3 scaleOrientation 1 0 0 .5
  children [
    DEF S Shape {
      geometry DEF F IndexedFaceSet {
        coord Coordinate { point [0 0 0, 1 0 0, 1 1 0 0 1 0] } coordIndex [0 1 2 3 -1 0 1 2]
      }
      appearance Appearance { material DEF M Material { diffuseColor 1 .5 0 } }
    }
    USE S
  ]
  scale 2 2 2
}
USE T
)",
            head + R"(# a
Switch { whichChoice 0 choice Shape { geometry IndexedFaceSet { ccw FALSE colorPerVertex FALSE
  colorIndex [1] color Color { color [1 0 0, 0 1 0] } coord Coordinate { point [0 0 0 1 0 0 0 1 0] }
  coordIndex [0 1 2] } } }
PROTO P [ field SFString s "a\"b" ] { Group {} }
EXTERNPROTO Q [ ] [ "q.wrl" "r.wrl" ]
ROUTE a.b TO c.d
LOD { level [ Group {} NULL ] range [10] }
Shape { geometry Box { } }
)",
            head + R"(Group { children [
  Shape { geometry IndexedFaceSet { coord DEF C Coordinate { point [0 0 0 1 0 0 0 1 0] } coordIndex [2,1,0,-1]
    color DEF K Color { color [0 0 1 0 1 0 1 0 0] } } }
  Anchor { children Shape { geometry IndexedFaceSet { coord USE C color USE K colorIndex [0 0 1 -1]
    coordIndex [0 1 2 -1] } } }
  DEF E Group { } NULL USE E ] }
)"};
}
