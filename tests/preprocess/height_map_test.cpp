// Height maps of all kinds from image files to datasets. The program iwalk-import must lie beside this one.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "preprocess/build/verify.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/soup.hpp"

namespace iwalk {
namespace {

constexpr int kColumns = 45, kRows = 37;  // tiles of 16 do not fit in evenly
constexpr double kHole = 7, kNan = std::numeric_limits<double>::quiet_NaN();

struct Kind {
    std::string name;
    OIIO::TypeDesc type;
    int channels = 1;
    int tile = 0;  // edge in samples; 0: rows
    double lowest = 0, highest = 0;
};

// Samples that the type holds exactly; a part of them are holes.
std::vector<double> makeSamples(const Kind& kind) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> heights(kind.lowest, kind.highest);
    std::vector<double> samples;
    for (int i = 0; i < kColumns * kRows; ++i) {
        const bool hole = random() % 5 == 0;
        const double height = std::nearbyint(heights(random));
        if (!hole) {
            samples.push_back(kind.type.is_floating_point() ? height / 4 : height);
        } else {
            samples.push_back(kind.type.is_floating_point() && random() % 2 == 0 ? kNan : kHole);
        }
    }
    samples[0] = kind.lowest, samples[1] = kind.highest;
    return samples;
}

template <class Sample>
void writeAs(OIIO::ImageOutput& image, const Kind& kind, const std::vector<double>& samples) {
    std::vector<Sample> all;
    for (const double sample : samples) {
        all.push_back(static_cast<Sample>(sample));
        // Neither other colours nor opacity change the first channel.
        for (int channel = 1; channel < kind.channels; ++channel) all.push_back(static_cast<Sample>(100));
    }
    ASSERT_TRUE(image.write_image(OIIO::BaseTypeFromC<Sample>::value, all.data())) << image.geterror();
}

void write(const std::string& path, const Kind& kind, const std::vector<double>& samples) {
    OIIO::ImageSpec spec(kColumns, kRows, kind.channels, kind.type);
    spec.tile_width = spec.tile_height = kind.tile;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    const auto image = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(image && image->open(path, spec)) << OIIO::geterror();
    if (kind.type == OIIO::TypeDesc::UINT8) {
        writeAs<unsigned char>(*image, kind, samples);
    } else if (kind.type == OIIO::TypeDesc::UINT16) {
        writeAs<unsigned short>(*image, kind, samples);
    } else if (kind.type == OIIO::TypeDesc::INT16) {
        writeAs<short>(*image, kind, samples);
    } else {
        writeAs<float>(*image, kind, samples);
    }
    ASSERT_TRUE(image->close()) << image->geterror();
}

// Counter-clockwise from above, around each cell from its nearest corner on the left.
std::vector<Triangle> makeTriangles(const std::vector<double>& samples, const ImportChoices& choices) {
    std::vector<Triangle> triangles;
    for (int row = 1; row < kRows; ++row) {
        for (int column = 1; column < kColumns; ++column) {
            std::vector<glm::dvec3> around;
            for (const auto& [x, y] :
                 {std::pair(column - 1, row), {column, row}, {column, row - 1}, {column - 1, row - 1}}) {
                const double sample = samples[static_cast<std::size_t>(y * kColumns + x)];
                if (std::isnan(sample) || sample == kHole) continue;
                around.emplace_back(x * choices.spacing, (kRows - 1 - y) * choices.spacing,
                                    sample * choices.heightScale);
            }
            if (around.size() >= 3) triangles.push_back(makeTriangle(around[0], around[1], around[2]));
            if (around.size() == 4) triangles.push_back(makeTriangle(around[0], around[2], around[3]));
        }
    }
    return triangles;
}

void expectFaithful(const Kind& kind) {
    SCOPED_TRACE(fmt::format("{} of {}, {} channels", kind.name, kind.type.c_str(), kind.channels));
    const TempDirectory directory;
    const std::vector<double> samples = makeSamples(kind);
    write(directory.path(kind.name), kind, samples);
    BuildOptions options;
    options.inputs = {directory.path(kind.name)};
    options.output = directory.path("d");
    options.leafTriangles = 300;
    options.import.spacing = 2.5;
    options.import.heightScale = 0.3;
    options.import.noData = kHole;
    NoProgress progress;
    const auto manifest = buildDataset(options, progress);
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    const std::vector<Triangle> triangles = makeTriangles(samples, options.import);
    EXPECT_GT(triangles.size(), 1000u);
    EXPECT_LT(triangles.size(), 2000u);
    const auto wanted = quantised(triangles, manifest->stepExponent, false, false);
    EXPECT_EQ(wanted.size(), triangles.size());
    EXPECT_TRUE(readTriangles(options.output) == wanted);
    const auto verified = verifyDataset(options.output, progress);
    ASSERT_TRUE(verified.ok()) << verified.error().message;
    EXPECT_EQ(verified->problems, std::vector<std::string>{});
}

TEST(HeightMapTest, Integers) {
    expectFaithful({"a.png", OIIO::TypeDesc::UINT8, 1, 0, 0, 255});
    expectFaithful({"a.png", OIIO::TypeDesc::UINT8, 3, 0, 0, 255});
    expectFaithful({"a.png", OIIO::TypeDesc::UINT16, 1, 0, 0, 65535});
    expectFaithful({"a.tif", OIIO::TypeDesc::UINT16, 1, 16, 0, 65535});
    expectFaithful({"a.tif", OIIO::TypeDesc::INT16, 1, 0, -32768, 32767});
}

TEST(HeightMapTest, Floats) {
    expectFaithful({"a.exr", OIIO::TypeDesc::FLOAT, 1, 0, -5000, 1e6});
    expectFaithful({"a.exr", OIIO::TypeDesc::FLOAT, 1, 16, -5000, 1e6});
    expectFaithful({"a.exr", OIIO::TypeDesc::HALF, 1, 0, -200, 200});
    expectFaithful({"a.tif", OIIO::TypeDesc::FLOAT, 1, 0, -5000, 1e6});
    expectFaithful({"a.tif", OIIO::TypeDesc::FLOAT, 3, 16, -5000, 1e6});
}

// How opaque a sample is does not change its height.
TEST(HeightMapTest, Opacity) {
    expectFaithful({"a.png", OIIO::TypeDesc::UINT8, 2, 0, 0, 255});
    expectFaithful({"a.png", OIIO::TypeDesc::UINT16, 4, 0, 0, 65535});
}

}  // namespace
}  // namespace iwalk
