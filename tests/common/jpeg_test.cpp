#include "common/jpeg.hpp"

#include <gtest/gtest.h>

#include <random>

namespace iwalk {
namespace {

ColorImage gradient(int width, int height) {
    ColorImage image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            image.at(x, y)[0] = static_cast<std::uint8_t>(255 * x / width);
            image.at(x, y)[1] = static_cast<std::uint8_t>(255 * y / height);
            image.at(x, y)[2] = 90;
        }
    return image;
}

TEST(Jpeg, ComesBackNearly) {
    for (const auto& [width, height] : {std::pair(97, 61), std::pair(1, 1), std::pair(640, 48)}) {
        const ColorImage image = gradient(width, height);
        const auto bytes = encodeJpeg(image);
        ASSERT_TRUE(bytes.ok()) << bytes.error().message;
        const auto back = decodeJpeg(*bytes, 100'000);
        ASSERT_TRUE(back.ok()) << back.error().message;
        ASSERT_EQ(back->width, width);
        ASSERT_EQ(back->height, height);
        double off = 0;
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            off += std::abs(image.pixels[i] - back->pixels[i]);
        EXPECT_LT(off / static_cast<double>(image.pixels.size()), 6);
    }
}

TEST(Jpeg, LargerThanAllowedIsRefused) {
    const auto bytes = encodeJpeg(gradient(100, 100));
    EXPECT_TRUE(decodeJpeg(*bytes, 10'000).ok());
    const auto refused = decodeJpeg(*bytes, 9'999);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().message.find("100 x 100"), std::string::npos);
}

TEST(Jpeg, BrokenOnesAreHarmless) {
    const std::vector<std::byte> whole = encodeJpeg(gradient(80, 60)).value();
    for (std::size_t size = 0; size < whole.size(); size += 7)
        EXPECT_FALSE(decodeJpeg(std::span(whole).first(size), 10'000).ok()) << size;
    std::mt19937 random(5);
    for (int i = 0; i < 3000; ++i) {
        std::vector<std::byte> changed = whole;
        for (int n = 0; n < 3; ++n)
            changed[random() % changed.size()] = static_cast<std::byte>(random() & 0xff);
        const auto picture = decodeJpeg(changed, 10'000);
        if (picture.ok()) {
            EXPECT_LE(picture->width * picture->height, 10'000);
        }
    }
}

}  // namespace
}  // namespace iwalk
