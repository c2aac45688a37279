#include "common/jpeg.hpp"

#include <turbojpeg.h>

#include <memory>

namespace iwalk {
namespace {

constexpr int kQuality = 75;  // of 100; more is larger

struct Destroy {
    void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, Destroy>;

}  // namespace

Result<std::vector<std::byte>> encodeJpeg(const ColorImage& image) {
    const Handle handle(tjInitCompress());
    if (!handle) return fail("cannot compress a picture: {}", tjGetErrorStr());
    std::vector<std::byte> bytes(tjBufSize(image.width, image.height, TJSAMP_420));
    auto* out = reinterpret_cast<unsigned char*>(bytes.data());
    unsigned long size = bytes.size();
    if (tjCompress2(handle.get(), image.pixels.data(), image.width, 0, image.height, TJPF_RGB, &out, &size,
                    TJSAMP_420, kQuality, TJFLAG_NOREALLOC) != 0)
        return fail("cannot compress a picture: {}", tjGetErrorStr2(handle.get()));
    bytes.resize(size);
    return bytes;
}

Result<ColorImage> decodeJpeg(std::span<const std::byte> bytes, std::size_t mostPixels) {
    const Handle handle(tjInitDecompress());
    if (!handle) return fail("cannot read a picture: {}", tjGetErrorStr());
    const auto* in = reinterpret_cast<const unsigned char*>(bytes.data());
    int width = 0, height = 0, sampling = 0, space = 0;
    if (tjDecompressHeader3(handle.get(), in, bytes.size(), &width, &height, &sampling, &space) != 0)
        return fail("not a JPEG: {}", tjGetErrorStr2(handle.get()));
    if (width < 1 || height < 1 ||
        static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > mostPixels)
        return fail("a JPEG of {} x {} px; {} px are the most", width, height, mostPixels);
    ColorImage image(width, height, 3);
    // Progressive files can be made to take very long: a few hundred scans are enough for anybody.
    if (tjDecompress2(handle.get(), in, bytes.size(), image.pixels.data(), width, 0, height, TJPF_RGB,
                      TJFLAG_LIMITSCANS | TJFLAG_STOPONWARNING) != 0)
        return fail("a broken JPEG: {}", tjGetErrorStr2(handle.get()));
    return image;
}

}  // namespace iwalk
