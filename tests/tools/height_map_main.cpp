// Makes height maps of any size for tests and measurements, hills upon hills, row by row.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace {

constexpr std::uint32_t kOctaves = 10;
constexpr double kLargestHill = 2048;  // samples

// The same number from 0 to 1 for a point of a grid on every machine.
double random(std::uint32_t x, std::uint32_t y, std::uint32_t octave) {
    std::uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ octave * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return static_cast<double>(h ^ h >> 15) / std::numeric_limits<std::uint32_t>::max();
}

double smooth(double t) {
    return t * t * (3 - 2 * t);
}

// Adds one row of numbers that lie `cell` samples apart, with smooth ways between them.
void addOctave(int row, std::uint32_t octave, double cell, double weight, std::vector<double>& heights) {
    const double y = row / cell;
    const auto top = static_cast<std::uint32_t>(y);
    const double down = smooth(y - top);
    const auto at = [&](std::uint32_t x) {
        return random(x, top, octave) * (1 - down) + random(x, top + 1, octave) * down;
    };
    std::uint32_t left = 0;
    double from = at(0), to = at(1);
    for (std::size_t column = 0; column < heights.size(); ++column) {
        const double x = static_cast<double>(column) / cell;
        for (; left + 1 <= x; ++left) {
            from = to;
            to = at(left + 2);
        }
        heights[column] += weight * (from + (to - from) * smooth(x - left));
    }
}

// From 0 to 1.
void makeRow(int row, std::vector<double>& heights) {
    std::fill(heights.begin(), heights.end(), 0);
    double weight = 0.5, cell = kLargestHill;
    for (std::uint32_t octave = 0; octave < kOctaves; ++octave, weight /= 2, cell /= 2)
        addOctave(row, octave, cell, weight, heights);
}

bool write(OIIO::ImageOutput& image, const std::string& path, const OIIO::ImageSpec& spec, bool holes) {
    if (!image.open(path, spec)) return false;
    const bool floats = spec.format == OIIO::TypeDesc::FLOAT;
    const float hole = floats ? std::numeric_limits<float>::quiet_NaN() : 1;
    const double middle = spec.width / 2.0, radius = std::min(spec.width, spec.height) / 8.0;
    std::vector<double> heights(static_cast<std::size_t>(spec.width));
    std::vector<float> samples(heights.size());
    for (int row = 0; row < spec.height; ++row) {
        makeRow(row, heights);
        for (std::size_t x = 0; x < samples.size(); ++x) {
            const bool out =
                holes && std::hypot(static_cast<double>(x) - middle, row - spec.height / 2.0) < radius;
            samples[x] = out ? hole : static_cast<float>(floats ? heights[x] * 1000 : heights[x]);
        }
        if (!image.write_scanline(row, 0, OIIO::TypeDesc::FLOAT, samples.data())) return false;
    }
    return image.close();
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Makes a height map: integers of 16 bits, or floats from 0 to 1000.", "iwalk-height-map");
    std::string path;
    int columns = 0, rows = 0;
    bool floats = false, holes = false;
    const CLI::Range sizes(2, 1 << 20);
    app.add_option("columns", columns, "Samples in a row")->required()->check(sizes);
    app.add_option("rows", rows, "Rows")->required()->check(sizes);
    app.add_option("output", path, "File to write: .tif, .png or .exr")->required();
    app.add_flag("--float", floats, "Floats: .tif or .exr");
    app.add_flag("--holes", holes,
                 "With a round hole in the middle: samples of 65535, or that are no numbers");
    CLI11_PARSE(app, argc, argv);

    const auto image = OIIO::ImageOutput::create(path);
    OIIO::ImageSpec spec(columns, rows, 1, floats ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT16);
    spec.attribute("compression", "zip");
    if (image && write(*image, path, spec, holes)) return 0;
    fmt::print(stderr, "iwalk-height-map: {}: {}\n", path, image ? image->geterror() : OIIO::geterror());
    return 1;
}
