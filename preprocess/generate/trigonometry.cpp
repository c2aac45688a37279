#include "preprocess/generate/trigonometry.hpp"

#include <cmath>
#include <numbers>

namespace iwalk {
namespace {

// Taylor's series, for angles of at most an eighth of a turn, in radians.
double sine(double a) {
    const double s = a * a;
    return a * (1 + s / -6 *
                        (1 + s / -20 *
                                 (1 + s / -42 *
                                          (1 + s / -72 * (1 + s / -110 * (1 + s / -156 * (1 + s / -210)))))));
}
double cosine(double a) {
    const double s = a * a;
    return 1 + s / -2 *
                   (1 + s / -12 *
                            (1 + s / -30 * (1 + s / -56 * (1 + s / -90 * (1 + s / -132 * (1 + s / -182))))));
}

}  // namespace

glm::dvec2 onCircle(double turns) {
    const double quarters = std::floor(turns * 4 + 0.5);
    const double rest = (turns - quarters / 4) * (2 * std::numbers::pi);
    const double c = cosine(rest), s = sine(rest);
    switch (static_cast<long long>(quarters) & 3) {
        case 0:
            return {c, s};
        case 1:
            return {-s, c};
        case 2:
            return {-c, -s};
        default:
            return {s, -c};
    }
}

}  // namespace iwalk
