#include "common/image.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <thread>

namespace iwalk {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

ColorImage noisyColor(int width, int height, unsigned seed = 1) {
    ColorImage image(width, height, 3);
    std::mt19937 random(seed);
    for (auto& value : image.pixels) value = static_cast<std::uint8_t>(random());
    return image;
}

DepthImage noisyDepth(int width, int height) {
    DepthImage image(width, height, 1);
    std::mt19937 random(2);
    for (auto& value : image.pixels) value = static_cast<float>(random() % 1000) / 7.0f;
    return image;
}

// What another program might have written: `spec` in `format`, all zeroes.
Bytes encodeForeign(const char* format, const OIIO::ImageSpec& spec) {
    std::vector<unsigned char> written;
    OIIO::Filesystem::IOVecOutput proxy(written);
    auto output = OIIO::ImageOutput::create(format);
    EXPECT_TRUE(output && output->set_ioproxy(&proxy) && output->open(format, spec)) << OIIO::geterror();
    const std::vector<std::byte> zeroes(spec.image_bytes());
    EXPECT_TRUE(output->write_image(spec.format, zeroes.data())) << output->geterror();
    output->close();
    Bytes bytes(written.size());
    std::memcpy(bytes.data(), written.data(), written.size());
    return bytes;
}

std::uint32_t crc32(std::span<const std::byte> bytes) {
    std::uint32_t crc = 0xffffffff;
    for (std::byte byte : bytes) {
        crc ^= std::to_integer<std::uint32_t>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0xedb88320u : 0u);
    }
    return ~crc;
}

void putBigEndian(std::byte* out, std::uint32_t value) {
    for (int i = 0; i < 4; ++i) out[i] = static_cast<std::byte>(value >> (24 - 8 * i));
}

// A PNG whose header claims another size, with a correct checksum.
Bytes claimSize(Bytes png, std::uint32_t width, std::uint32_t height) {
    putBigEndian(png.data() + 16, width);
    putBigEndian(png.data() + 20, height);
    putBigEndian(png.data() + 29, crc32(std::span(png).subspan(12, 17)));
    return png;
}

TEST(Image, PngReturnsTheSamePixels) {
    for (auto [width, height] : {std::pair{1, 1}, {7, 3}, {1024, 1}, {640, 480}}) {
        const ColorImage image = noisyColor(width, height);
        const auto bytes = encodePng(image);
        ASSERT_TRUE(bytes.ok()) << bytes.error().message;
        const auto back = decodePng(*bytes, "test");
        ASSERT_TRUE(back.ok()) << back.error().message;
        EXPECT_EQ(back->width, width);
        EXPECT_EQ(back->height, height);
        EXPECT_EQ(back->channels, 3);
        EXPECT_EQ(back->pixels, image.pixels);
    }
}

TEST(Image, RowsBeginAtTheTopAndChannelsAreRedGreenBlue) {
    ColorImage image(1, 2, 3);
    image.pixels = {10, 20, 30, 40, 50, 60};
    EXPECT_EQ(decodePng(*encodePng(image), "test")->at(0, 1)[2], 60);
}

TEST(Image, ExrReturnsTheSameBits) {
    DepthImage image = noisyDepth(33, 21);
    *image.at(0, 0) = 0;
    *image.at(1, 0) = std::numeric_limits<float>::denorm_min();
    *image.at(2, 0) = std::numeric_limits<float>::max();
    const auto bytes = encodeExr(image);
    ASSERT_TRUE(bytes.ok()) << bytes.error().message;
    const auto back = decodeExr(*bytes, "test");
    ASSERT_TRUE(back.ok()) << back.error().message;
    ASSERT_EQ(back->pixels.size(), image.pixels.size());
    EXPECT_EQ(std::memcmp(back->pixels.data(), image.pixels.data(), image.pixels.size() * sizeof(float)), 0);
}

TEST(Image, EncodingIsDeterministic) {
    EXPECT_EQ(*encodePng(noisyColor(50, 40)), *encodePng(noisyColor(50, 40)));
    EXPECT_EQ(*encodeExr(noisyDepth(50, 40)), *encodeExr(noisyDepth(50, 40)));
}

TEST(Image, TruncatedBytesAreAnErrorThatNamesTheImage) {
    const Bytes png = *encodePng(noisyColor(40, 40));
    const Bytes exr = *encodeExr(noisyDepth(40, 40));
    auto expectError = [](const Error& error) {
        EXPECT_THAT(error.message, HasSubstr("tile-1-2"));
        EXPECT_EQ(error.message.find('\n'), std::string::npos) << error.message;
    };
    for (std::size_t size = 0; size < png.size(); ++size) {
        const auto result = decodePng(std::span(png).first(size), "tile-1-2.png");
        ASSERT_FALSE(result.ok()) << size << " of " << png.size();
        expectError(result.error());
    }
    for (std::size_t size = 0; size < exr.size();
         size += size < 400 ? 1 : 97) {  // the header is most likely to hurt
        const auto result = decodeExr(std::span(exr).first(size), "tile-1-2.exr");
        ASSERT_FALSE(result.ok()) << size << " of " << exr.size();
        expectError(result.error());
    }
}

// Whatever comes out must be a value or an error: no crash, no huge allocation (tests run under sanitizers,
// too).
TEST(Image, DamagedBytesDoNotCrash) {
    const Bytes png = *encodePng(noisyColor(20, 20));
    const Bytes exr = *encodeExr(noisyDepth(20, 20));
    std::mt19937 random(3);
    for (int round = 0; round < 2000; ++round) {
        Bytes damaged = round % 2 ? png : exr;
        const std::size_t reach = round % 4 < 2 ? std::min<std::size_t>(damaged.size(), 400) : damaged.size();
        for (int i = 0; i < 3; ++i) damaged[random() % reach] = static_cast<std::byte>(random());
        (void)decodePng(damaged, "damaged");
        (void)decodeExr(damaged, "damaged");
    }
}

TEST(Image, SizesAreCheckedBeforePixelsAreAllocated) {
    const Bytes png = *encodePng(noisyColor(4, 4));
    const auto tooLarge = decodePng(claimSize(png, 32769, 4), "large.png");
    ASSERT_FALSE(tooLarge.ok());
    EXPECT_THAT(tooLarge.error().message, HasSubstr("32769 x 4"));
    // 3 GB of pixels from a hundred bytes.
    const auto bomb = decodePng(claimSize(png, 32768, 32768), "bomb.png");
    ASSERT_FALSE(bomb.ok());
    EXPECT_THAT(bomb.error().message, HasSubstr("cannot hold"));
}

TEST(Image, EmptyImagesOfOneColorPassTheInflationCheck) {
    const ColorImage black(2048, 2048, 3);
    EXPECT_TRUE(decodePng(*encodePng(black), "black").ok());
    const DepthImage nothing(2048, 2048, 1);
    EXPECT_TRUE(decodeExr(*encodeExr(nothing), "nothing").ok());
}

TEST(Image, OtherKindsOfImagesAreRefused) {
    using OIIO::TypeDesc;
    const OIIO::ImageSpec wide(8, 8, 3, TypeDesc::UINT16), alpha(8, 8, 4, TypeDesc::UINT8);
    EXPECT_FALSE(decodePng(encodeForeign("png", wide), "16 bit").ok());
    EXPECT_FALSE(decodePng(encodeForeign("png", alpha), "alpha").ok());

    OIIO::ImageSpec notZ(8, 8, 1, TypeDesc::FLOAT), half(8, 8, 1, TypeDesc::HALF),
        piz(8, 8, 1, TypeDesc::FLOAT);
    half.channelnames = piz.channelnames = {"Z"};
    notZ.channelnames = {"Y"};
    piz.attribute("compression", "piz");
    OIIO::ImageSpec tiled(64, 64, 1, TypeDesc::FLOAT);
    tiled.channelnames = {"Z"};
    tiled.tile_width = tiled.tile_height = 32;
    EXPECT_FALSE(decodeExr(encodeForeign("exr", half), "half").ok());
    EXPECT_FALSE(decodeExr(encodeForeign("exr", notZ), "not Z").ok());
    EXPECT_FALSE(decodeExr(encodeForeign("exr", piz), "piz").ok());
    EXPECT_FALSE(decodeExr(encodeForeign("exr", tiled), "tiled").ok());

    const auto result = decodeExr(*encodePng(noisyColor(8, 8)), "png as exr");
    ASSERT_FALSE(result.ok());
    EXPECT_THAT(result.error().message, HasSubstr("png as exr"));
}

TEST(Image, FilesAreReadAndErrorsNameThem) {
    const std::string path = testing::TempDir() + "iwalk_image_test.png";
    const ColorImage image = noisyColor(5, 6);
    const Bytes bytes = *encodePng(image);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    EXPECT_EQ(readPng(path)->pixels, image.pixels);
    const auto notExr = readExr(path);
    ASSERT_FALSE(notExr.ok());
    EXPECT_THAT(notExr.error().message, HasSubstr(path));
    std::filesystem::remove(path);
    EXPECT_THAT(readPng(path).error().message, HasSubstr(path));
}

std::ptrdiff_t threadsOfThisProcess() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
}

TEST(Image, ManyThreadsAtOnceAndNoneOfTheLibrary) {
    ASSERT_TRUE(decodeExr(*encodeExr(noisyDepth(10, 10)), "first use").ok());
    const auto before = threadsOfThisProcess();
    auto work = [](unsigned seed) {
        for (unsigned i = 0; i < 10; ++i) {
            const ColorImage image = noisyColor(100, 100, seed + i);
            EXPECT_EQ(decodePng(*encodePng(image), "thread")->pixels, image.pixels);
            const DepthImage depth = noisyDepth(100, 100);
            EXPECT_EQ(decodeExr(*encodeExr(depth), "thread")->pixels, depth.pixels);
            EXPECT_FALSE(decodePng({}, "empty").ok());
        }
    };
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < 4; ++i) threads.emplace_back(work, 100 * i);
    threads.clear();
    // A thread that was joined may still be listed for a moment.
    for (int i = 0; i < 500 && threadsOfThisProcess() > before; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_LE(threadsOfThisProcess(), before);
}

}  // namespace
}  // namespace iwalk
