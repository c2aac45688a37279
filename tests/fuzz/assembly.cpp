#include "preprocess/import/assembly.hpp"

#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto assembly = iwalk::parseAssembly(text, "fuzz.json");
    if (assembly) {
        CHECK_OP(assembly->files.size(), ==, assembly->placements.size());
        std::size_t count = 0;
        for (const auto& placements : assembly->placements) count += placements.size();
        CHECK_OP(count, ==, assembly->count);
    } else {
        CHECK(assembly.error().message.find('\n') == std::string::npos);
    }
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    return {
        R"({"parts": [{"file": "a.ply", "matrix": [1,0,0,3, 0,1,0,0, 0,0,1,0, 0,0,0,1], "color": "#ff8000"},
                          {"file": "b/../a.ply"}, {"file": "c.json"}]})",
        R"({"name": [null, true, {"parts": 1}], "parts": [{"file": "\u00e9\/d.wrl", "color": "#AbCdEf",
            "matrix": [-1e-3,0.0,0,-0, 0,1E3,0,0, 0,0,1,1e300, 0,0,0,1]}]})"};
}
