// The model; behind a byte that is 0, if there is one, its material library.
#include "preprocess/import/obj_importer.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const iwalk::TempDirectory directory;
    const std::string_view all(reinterpret_cast<const char*>(data), size);
    const std::size_t end = std::min(all.find('\0'), size);
    if (end < size) directory.write("a.mtl", std::string(all.substr(end + 1)));
    const auto open = [&](const iwalk::ImportLimits& limits) {
        return iwalk::openObj(directory.path("fuzz.obj"), std::make_unique<iwalk::MemoryFile>(data, end),
                              limits);
    };
    iwalk::readInBlocks(open, end);
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    const std::string model =
        "mtllib a.mtl\nv 0 0 0\nv 1.5 0 0 1 0 .5\nv 1 1e2 0\nv 0 -1 0\nvn 0 0 1\nvt 0 0\nusemtl a\n"
        "f 1//1 2//-1 \\\n3/1/1 -1\ng x\nf 1 2 3\nf -1 -2 -3 -4\n";
    const std::string library = "# a\nnewmtl a\nKa 0 0 0\nKd 1 0.5 0\nnewmtl b\\\n c\nKd spectral x\n";
    return {model, model + '\0' + library,
            "\xef\xbb\xbf# far away\r\nv 5000000.123 -4000000 1e-3 1\r\nv 5000001 -4000000 0 0.5\r\n"
            "v 5000000 -3999999 nan\r\nf 1/1 2/2 3/3 1 2\r\nf 1 2 3 # again\r\n"};
}
