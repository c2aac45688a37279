#include "tests/tools/depth_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/check.hpp"

namespace iwalk::tools {
namespace {

double differenceOf(double depth, double reference) {
    if (depth == 0 && reference == 0) return 0;
    if (depth == 0 || reference == 0) return std::numeric_limits<double>::infinity();
    return std::abs(depth - reference) / reference;
}

bool isWorse(const DepthDisagreement& a, const DepthDisagreement& b) {
    return a.difference > b.difference;
}

// Keeps the `most` worst, as a heap whose front is the least of them.
void keepWorst(std::vector<DepthDisagreement>& heap, const DepthDisagreement& candidate, std::size_t most) {
    if (heap.size() == most && (most == 0 || !isWorse(candidate, heap.front()))) return;
    heap.push_back(candidate);
    std::push_heap(heap.begin(), heap.end(), isWorse);
    if (heap.size() <= most) return;
    std::pop_heap(heap.begin(), heap.end(), isWorse);
    heap.pop_back();
}

}  // namespace

DepthAgreement depthAgreement(const DepthImage& picture, const Image<double>& reference, double relative,
                              std::size_t worst) {
    CHECK_OP(picture.width, ==, reference.width);
    CHECK_OP(picture.height, ==, reference.height);
    DepthAgreement result;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            const double z = *picture.at(x, y), zRef = *reference.at(x, y);
            const DepthDisagreement pixel{x, y, z, zRef, differenceOf(z, zRef)};
            ++result.pixels;
            if (pixel.difference <= relative) {
                ++result.agreed;
                continue;
            }
            result.missing += z == 0 ? 1 : 0;
            result.extra += zRef == 0 ? 1 : 0;
            keepWorst(result.worst, pixel, worst);
        }
    }
    std::sort_heap(result.worst.begin(), result.worst.end(), isWorse);
    return result;
}

}  // namespace iwalk::tools
