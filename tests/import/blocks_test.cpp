// What is read does not depend on how texts are cut into blocks, nor on how many threads parse them.
#include <gmock/gmock.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <spdlog/spdlog.h>

#include <limits>
#include <random>

#include "preprocess/import/obj_importer.hpp"
#include "preprocess/import/ply_importer.hpp"
#include "tests/import/import_fixture.hpp"
#include "tests/import/ply_writer.hpp"

namespace iwalk {
namespace {

constexpr std::uint64_t kMemory = std::uint64_t{256} << 20;
constexpr std::size_t kOneBlock = std::size_t{1} << 20;

std::string outcome(const Result<Imported>& result) {
    return result ? fmt::format("{} triangles", result->triangles.size()) : result.error().message;
}

class BlocksTest : public ImportTest {
  protected:
    BlocksTest() { spdlog::set_level(spdlog::level::off); }
    ~BlocksTest() override { spdlog::set_level(spdlog::level::info); }

    Result<Imported> importIn(const std::string& name, std::size_t blockBytes, unsigned threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        tbb::task_arena arena(static_cast<int>(threads));
        const ImportLimits limits{.memoryBytes = kMemory,
                                  .spillDirectory = directory_.path(""),
                                  .threads = threads,
                                  .blockBytes = blockBytes};
        return arena.execute([&] { return import(name, limits); });
    }

    // Reads it in all ways; returns what one block and one thread make of it.
    Result<Imported> readInAllWays(const std::string& name, const std::string& contents) {
        directory_.write(name, contents);
        Result<Imported> whole = importIn(name, kOneBlock, 1);
        for (const std::size_t blockBytes :
             {std::size_t{1}, std::size_t{16}, std::size_t{500}, std::size_t{9000}}) {
            for (const unsigned threads : {1u, 2u, 4u}) {
                const Result<Imported> cut = importIn(name, blockBytes, threads);
                EXPECT_EQ(outcome(cut), outcome(whole)) << blockBytes << ", " << threads << " threads";
                EXPECT_TRUE(!cut || !whole || *cut == *whole) << blockBytes << ", " << threads << " threads";
            }
        }
        return whole;
    }
    std::string errorInAllWays(const std::string& name, const std::string& contents) {
        const Result<Imported> result = readInAllWays(name, contents);
        return result ? "" : result.error().message.substr(directory_.path(name).size() + 2);
    }
};

// Some of all that a line can be, and indices of both kinds.
std::string longObj(unsigned parts) {
    std::string text = "\xef\xbb\xbfmtllib a.mtl\r\n# a comment, not joined \\\n";
    for (unsigned i = 0; i < parts; ++i) {
        text += fmt::format("v {}.25 {} 1e{}\nv {} \\\n  {}\\\r\n {} \nv 0 1 {} 0.5 0 1\nvn 0 {} 1\n", i,
                            i % 7, i % 3, i, i + 1, i % 5, i, i);
        text += fmt::format("usemtl {}\nf -1 -2 -3\nf {}//-1 {}//1 \\\n {}/7/1 -1\n",
                            i % 3 == 0 ? "red" : "green", 3 * i + 1, 3 * i + 2, 3 * i + 3);
        if (i % 4 == 1) text += "# f 1 2 3 \\\n\n\t \nf -3 1 -2 2 -1 # \\ five\ng part\n";
        if (i % 16 == 3) text += "v nan 0 0\nf -1 1 2\nv 1 1 1\nv 2 2 2\nf 1\nf\n";
    }
    return text + "f 1 2 3";
}

TEST_F(BlocksTest, obj) {
    directory_.write("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl green\nKd 0 1 0\n");
    const auto read = readInAllWays("model.obj", longObj(150));
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_GT(read->triangles.size(), 500u);
    EXPECT_GT(read->counts.droppedNonFinite, 0u);
}

TEST_F(BlocksTest, objErrorsNameTheirLines) {
    const std::string good = longObj(150);
    const auto line = 1 + std::ranges::count(good, '\n') + 1;
    EXPECT_EQ(errorInAllWays("model.obj", good + "\nv 1 x\n" + good),
              fmt::format("line {}: a vertex needs three numbers, not 'x'", line));
    EXPECT_EQ(errorInAllWays("model.obj", good + "\nvn \\\n 1\n" + good),
              fmt::format("line {}: a normal needs three numbers, not ''", line));
    EXPECT_THAT(errorInAllWays("model.obj", good + "\nf 1 2 9999 y\nf x\n" + good),
                testing::StartsWith(fmt::format("line {}: face ", line)));
    EXPECT_THAT(errorInAllWays("model.obj", good + "\nf 1 2 y\n" + good),
                testing::EndsWith(": 'y' is no corner: v, v/vt, v//vn or v/vt/vn is wanted"));
    EXPECT_EQ(errorInAllWays("model.obj", good + "\n" + std::string(std::size_t{2} << 20, 'v')),
              fmt::format("line {}: does not end within 1048576 bytes: not a text file?", line));
}

// More corners than a piece of a block has, in one line and in many that are joined.
TEST_F(BlocksTest, objFacesOfManyCorners) {
    std::string face = "f", joined = "f";
    for (unsigned i = 0; i < 150'000; ++i) {
        face += i % 2 == 0 ? " 1" : " -2";
        joined += i % 2 == 0 ? " 1\\\n" : " -2";
    }
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto read =
        readInAllWays("model.obj", vertices + face + "\nf 1 2 3\n" + joined + "\nv 1 1 1\nf 3 2 -1\n");
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read->triangles.size(), 2 * 149'998u + 2);
    EXPECT_EQ(errorInAllWays("model.obj", vertices + face + " 9\n"),
              "line 4: face 1: vertex index 9, but there are 3 vertices, 3 of them up to here");
}

TEST_F(BlocksTest, asciiPly) {
    PlyFlavor flavor{.format = "ascii", .color = "uchar", .normals = true};
    ASSERT_TRUE(readInAllWays("model.ply", writePly(testCube(), flavor)).ok());
    flavor.extras = flavor.vertexLists = flavor.alpha = flavor.reversed = true;
    flavor.lineEnd = "\r\n";
    ASSERT_TRUE(readInAllWays("model.ply", writePly(testCube(), flavor)).ok());
    flavor.facesFirst = true;
    ASSERT_TRUE(readInAllWays("model.ply", writePly(testCube(), flavor)).ok());
}

// Values need not stand in lines as elements do.
std::string longPly(const std::string& between, const std::string& lastFace = "3 0 1 2") {
    constexpr unsigned kCount = 400;
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty double z\n"
        "element face {}\nproperty list uchar int vertex_indices\nproperty int a\nend_header\n",
        kCount, kCount);
    for (unsigned i = 0; i < kCount; ++i)
        text +=
            fmt::format("{}.5{}{}e-3{}{}{}", i, between, i, between, i % 9 == 4 ? "nan" : "-1.25", between);
    for (unsigned i = 0; i + 1 < kCount; ++i)
        text += fmt::format("{}{}{} {} {}{}{}{}", i % 5 == 0 ? 4 : 3, between, i, i / 2, (i * 7) % kCount,
                            i % 5 == 0 ? " 1" : "", between, "17\n");
    return text + lastFace + " 5";
}

TEST_F(BlocksTest, asciiPlyWithoutLines) {
    const auto read = readInAllWays("model.ply", longPly(" "));
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_GT(read->triangles.size(), 300u);
    for (const char* between : {"\n", "\r\n\t  \n", " \v"}) {
        const auto other = readInAllWays("model.ply", longPly(between));
        ASSERT_TRUE(other.ok()) << other.error().message;
        EXPECT_TRUE(*other == *read);
    }
}

TEST_F(BlocksTest, asciiPlyErrorsNameTheirBytes) {
    const std::size_t place = longPly(" ").size() - 9;
    const auto error = [&](const std::string& lastFace) {
        return errorInAllWays("model.ply", longPly(" ", lastFace));
    };
    EXPECT_EQ(error("3 0 x 2"), fmt::format("element 'face' 399: 'x' is not a number (byte {})", place + 4));
    EXPECT_EQ(
        error("3 0 1 400"),
        fmt::format("element 'face' 399: vertex index 400, but there are 400 vertices (byte {})", place + 6));
    EXPECT_EQ(
        error("99 1"),
        fmt::format("element 'face' 399: a list of 99 items in a file with 4 bytes left (byte {})", place));
    EXPECT_EQ(error("3 0 1"),
              fmt::format("element 'face' 399: the file ends, it is cut short (byte {})", place + 7));
    const std::string word(600, '7');
    EXPECT_EQ(error("3 " + word + " 2"), fmt::format("element 'face' 399: '{}...' is not a number (byte {})",
                                                     word.substr(0, 40), place + 2));
}

// Damaged texts, too, are read alike, or refused with the same line.
TEST_F(BlocksTest, damagedTexts) {
    directory_.write("a.mtl", "newmtl red\nKd 1 0 0\n");
    PlyFlavor rich{.format = "ascii", .color = "uchar", .normals = true};
    rich.extras = rich.vertexLists = true;
    static constexpr std::string_view kTelling = "0123456789-+.e/ \n\r\\#fvnxyz\xff\x7f\x80";
    std::mt19937_64 random(20261122);
    for (const auto& [name, text] : {std::pair<std::string, std::string>("flipped.obj", longObj(3)),
                                     {"flipped.ply", writePly(testCube(), rich)}}) {
        for (int round = 0; round < 400; ++round) {
            std::string damaged = text;
            for (int flips = 0; flips < 1 + round % 4; ++flips)
                damaged[random() % damaged.size()] = kTelling[random() % kTelling.size()];
            directory_.write(name, damaged);
            const auto whole = importIn(name, kOneBlock, 1),
                       cut = importIn(name, 1 + random() % 60, 1 + round % 3);
            ASSERT_EQ(outcome(cut), outcome(whole)) << damaged;
            ASSERT_TRUE(!cut || *cut == *whole) << damaged;
        }
    }
}

TEST_F(BlocksTest, theSinksErrorEndsTheReading) {
    directory_.write("model.obj", longObj(20'000));
    for (const unsigned threads : {1u, 4u}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        tbb::task_arena arena(static_cast<int>(threads));
        arena.execute([&] {
            const auto importer =
                openImporter(directory_.path("model.obj"), {.memoryBytes = kMemory,
                                                            .spillDirectory = directory_.path(""),
                                                            .threads = threads,
                                                            .blockBytes = 500});
            ASSERT_TRUE(importer.ok());
            ASSERT_TRUE((*importer)->scan({}, {}).ok());
            int batches = 0;
            const TriangleSink full = [&](auto&) -> Result<void> {
                return ++batches < 3 ? Result<void>() : fail("the disk is full");
            };
            const auto counts = (*importer)->triangles(full, {});
            ASSERT_FALSE(counts.ok());
            EXPECT_EQ(counts.error().message, "the disk is full");
            EXPECT_EQ(batches, 3);
        });
    }
}

// A disk that cannot be read from some byte on.
class BadDisk : public RandomAccessFile {
  public:
    BadDisk(std::string text, std::uint64_t good) : text_(std::move(text)), good_(good) {}
    Result<void> readAt(std::uint64_t offset, std::span<std::byte> out) const override {
        if (offset + out.size() > good_) return fail("bad disk at byte {}", good_);
        std::memcpy(out.data(), text_.data() + offset, out.size());
        return {};
    }
    std::uint64_t size() const override { return text_.size(); }

  private:
    std::string text_;
    std::uint64_t good_;
};

// What is wrong before the place that cannot be read comes first, however far ahead was read.
TEST_F(BlocksTest, errorsComeInTheOrderOfTheFile) {
    const auto errorOfScan = [&](const std::string& text, std::uint64_t good, unsigned threads) {
        const ImportLimits limits{.memoryBytes = kMemory,
                                  .spillDirectory = directory_.path(""),
                                  .threads = threads,
                                  .blockBytes = 64};
        const auto importer = openObj("model.obj", std::make_unique<BadDisk>(text, good), limits);
        EXPECT_TRUE(importer.ok());
        std::size_t vertices = 0;
        const auto summary = (*importer)->scan([&](auto batch) { vertices += batch.size(); }, {});
        EXPECT_FALSE(summary.ok());
        EXPECT_GE(vertices, 90u);
        return summary.ok() ? "" : summary.error().message;
    };
    std::string text;
    for (int i = 0; i < 100; ++i) text += "v 1 2 3\n";
    for (const unsigned threads : {1u, 4u}) {
        EXPECT_EQ(errorOfScan(text + "v x\n" + text, 1000, threads),
                  "model.obj: line 101: a vertex needs three numbers, not 'x'");
        EXPECT_EQ(errorOfScan(text + text, 1000, threads), "bad disk at byte 1000");
    }
}

}  // namespace
}  // namespace iwalk
