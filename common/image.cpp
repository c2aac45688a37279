#include "common/image.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstring>
#include <utility>

#include "common/file.hpp"
#include "common/image_header.hpp"

namespace iwalk {
namespace {

// More than the largest image takes when it cannot be compressed.
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{5} << 30;
// Fast, for frames on their way to a client. Measured on flat-shaded spheres, 1024x768: level 1 without
// filters takes 44 ms and 429 KB; with the filters that libpng tries by default 100 to 170 ms and 511 KB, at
// level 6 440 KB.
constexpr int kPngCompressionLevel = 1;
constexpr int kPngNoFilter = 8;                   // PNG_FILTER_NONE in png.h
constexpr const char* kExrCompression = "zip:2";  // the level costs 0.3 % of size against the default of 4

// What a file must hold to be one of ours.
struct Format {
    const char* name;  // as OpenImageIO calls the format
    int channels;
    OIIO::TypeDesc type;
};
const Format kPng{"png", 3, OIIO::TypeDesc::UINT8};
const Format kExr{"exr", 1, OIIO::TypeDesc::FLOAT};

// OpenImageIO and OpenEXR would each start a thread per core in every rank; iWalk encodes images on
// a thread of its own.
void limitLibraryThreads() {
    static const bool done = OIIO::attribute("threads", 1) && OIIO::attribute("exr_threads", -1);
    CHECK(done);
}

// Messages of libraries may have several lines; ours have one.
std::string oneLine(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    for (char& c : text) {
        if (c == '\n' || c == '\r') c = ' ';
    }
    return text.empty() ? "unknown reason" : text;
}

// An object of OpenImageIO keeps its own errors; those from before there is one are kept for the thread.
template <class Object>
std::string reason(const Object* object) {
    return oneLine(object && object->has_error() ? object->geterror() : OIIO::geterror());
}

template <class T>
Result<std::vector<std::byte>> encode(const Image<T>& image, const Format& format,
                                      const OIIO::ImageSpec& spec) {
    CHECK(image.width > 0 && image.height > 0);
    CHECK_OP(image.channels, ==, format.channels);
    CHECK_OP(image.pixels.size(), ==, spec.image_pixels() * static_cast<std::size_t>(format.channels));
    limitLibraryThreads();

    std::vector<unsigned char> written;
    OIIO::Filesystem::IOVecOutput proxy(written);
    auto output = OIIO::ImageOutput::create(format.name);
    if (!output || !output->set_ioproxy(&proxy) || !output->open(format.name, spec) ||
        !output->write_image(format.type, image.pixels.data()) || !output->close()) {
        return fail("cannot compress a {} x {} image as {}: {}", image.width, image.height, format.name,
                    reason(output.get()));
    }
    std::vector<std::byte> bytes(written.size());
    std::memcpy(bytes.data(), written.data(), written.size());
    return bytes;
}

template <class T>
Result<Image<T>> decode(std::span<const std::byte> bytes, const Format& format, const std::string& name) {
    limitLibraryThreads();
    OIIO::Filesystem::IOMemReader proxy(bytes.data(), bytes.size());
    auto input = OIIO::ImageInput::create(format.name);
    OIIO::ImageSpec spec;
    if (!input || !input->set_ioproxy(&proxy) || !input->open(format.name, spec)) {
        return fail("{}: not a readable {} image: {}", name, format.name, reason(input.get()));
    }
    // The header was checked before; a PNG may still turn out to be transparent, for instance.
    if (spec.nchannels != format.channels || spec.format != format.type) {
        return fail("{}: the image has {} channels of type {}; needed: {} of type {}", name, spec.nchannels,
                    spec.format.c_str(), format.channels, format.type.c_str());
    }
    Image<T> image(spec.width, spec.height, spec.nchannels);
    if (!input->read_image(0, 0, 0, spec.nchannels, format.type, image.pixels.data())) {
        return fail("{}: the {} image is damaged: {}", name, format.name, reason(input.get()));
    }
    return image;
}

std::span<const std::byte> bytesOfFile(const std::string& contents) {
    return std::as_bytes(std::span(contents.data(), contents.size()));
}

}  // namespace

Result<std::vector<std::byte>> encodePng(const ColorImage& image) {
    OIIO::ImageSpec spec(image.width, image.height, kPng.channels, kPng.type);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("png:compressionLevel", kPngCompressionLevel);
    spec.attribute("png:filter", kPngNoFilter);
    return encode(image, kPng, spec);
}

Result<std::vector<std::byte>> encodeExr(const DepthImage& image) {
    OIIO::ImageSpec spec(image.width, image.height, kExr.channels, kExr.type);
    spec.channelnames = {"Z"};
    spec.z_channel = 0;
    spec.attribute("compression", kExrCompression);
    return encode(image, kExr, spec);
}

Result<ColorImage> decodePng(std::span<const std::byte> bytes, const std::string& name) {
    RETURN_IF_ERROR(checkPngHeader(bytes, name));
    return decode<std::uint8_t>(bytes, kPng, name);
}

Result<DepthImage> decodeExr(std::span<const std::byte> bytes, const std::string& name) {
    RETURN_IF_ERROR(checkExrHeader(bytes, name));
    return decode<float>(bytes, kExr, name);
}

Result<ColorImage> readPng(const std::string& path) {
    ASSIGN_OR_RETURN(const std::string contents, readWholeFile(path, kMaxFileBytes));
    return decodePng(bytesOfFile(contents), path);
}

Result<DepthImage> readExr(const std::string& path) {
    ASSIGN_OR_RETURN(const std::string contents, readWholeFile(path, kMaxFileBytes));
    return decodeExr(bytesOfFile(contents), path);
}

}  // namespace iwalk
