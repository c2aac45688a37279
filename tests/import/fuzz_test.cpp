// Damaged files may be read or refused, but never more than that. Meant for builds with sanitizers.
#include <spdlog/spdlog.h>

#include <cmath>
#include <random>

#include "tests/import/import_fixture.hpp"
#include "tests/import/ply_writer.hpp"

namespace iwalk {
namespace {

class FuzzTest : public ImportTest {
  protected:
    FuzzTest() { spdlog::set_level(spdlog::level::off); }
    ~FuzzTest() override { spdlog::set_level(spdlog::level::info); }

    // What holds of anything that was read.
    static void checkRead(const Imported& read) {
        for (const Triangle& t : read.triangles) {
            for (const Corner& c : t) {
                ASSERT_TRUE(std::isfinite(c.position.x) && std::isfinite(c.position.y) &&
                            std::isfinite(c.position.z));
                ASSERT_TRUE(read.summary.normals || c.normal == glm::vec3(0));
                if (read.summary.normals) {
                    ASSERT_NEAR(std::hypot(c.normal.x, c.normal.y, c.normal.z), 1, 1e-5);
                }
            }
        }
        ASSERT_EQ(read.counts.triangles, read.triangles.size());
        ASSERT_GT(read.summary.precision, 0);
    }

    // Imports copies of `text` with one to eight bytes replaced, half of them by bytes that mean something
    // there.
    void flip(const std::string& name, const std::string& text, int rounds) {
        static constexpr std::string_view kTelling = "0123456789-+.e/ \n\r\\#fvnxyz\xff\x7f\x80";
        std::mt19937_64 random(20261122);
        const auto below = [&](std::size_t end) { return static_cast<std::size_t>(random() % end); };
        for (int round = 0; round < rounds; ++round) {
            std::string damaged = text;
            for (std::size_t flips = 1 + below(8); flips > 0; --flips) {
                const char byte =
                    random() % 2 ? kTelling[below(kTelling.size())] : static_cast<char>(random() & 255);
                damaged[below(damaged.size())] = byte;
            }
            const auto result = importText(name, damaged);
            if (result.ok()) checkRead(*result);
            ASSERT_TRUE(result.ok() || result.error().message.find('\n') == std::string::npos);
        }
    }
};

TEST_F(FuzzTest, ply) {
    PlyFlavor plain{.color = "uchar", .normals = true}, rich = plain;
    rich.extras = rich.vertexLists = true;
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        plain.format = rich.format = format;
        flip("flipped.ply", writePly(testCube(), plain), 1500);
        flip("flipped.ply", writePly(testCube(), rich), 1000);
    }
}

TEST_F(FuzzTest, obj) {
    directory_.write("a.mtl", "newmtl a\nKd 1 0 0\n");
    const std::string text =
        "mtllib a.mtl\nv 0 0 0\nv 1.5 0 0 1 0 .5\nv 1 1e2 0\nv 0 -1 0\nvn 0 0 1\nvt 0 0\nusemtl a\n"
        "f 1//1 2//-1 \\\n3/1/1 -1\ng x\nf 1 2 3\nf -1 -2 -3 -4\n";
    flip("flipped.obj", text, 2000);
}

TEST_F(FuzzTest, mtl) {
    directory_.write("model.obj", "mtllib flipped.mtl\nv 0 0 0\nusemtl a\nf 1 1 1\n");
    std::mt19937_64 random(7);
    const std::string text = "# a\nnewmtl a\nKa 0 0 0\nKd 1 0.5 0\nd 1\nnewmtl b\\\n c\nKd spectral x\n";
    for (int round = 0; round < 500; ++round) {
        std::string damaged = text;
        for (int i = 0; i < 4; ++i) damaged[random() % damaged.size()] = static_cast<char>(random() & 255);
        directory_.write("flipped.mtl", damaged);
        ASSERT_TRUE(import("model.obj").ok());
    }
}

}  // namespace
}  // namespace iwalk
