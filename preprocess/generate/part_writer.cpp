#include "preprocess/generate/part_writer.hpp"

namespace iwalk {

void PartWriter::sweep(const Profile& profile, std::span<const Ring> rings, Rgb color) {
    const auto count = static_cast<std::uint32_t>(profile.points.size());
    const auto last = static_cast<std::uint32_t>(rings.size() - 1) * count;
    if (pass_ == Pass::vertices) {
        vertices(profile, rings, color);
    } else {
        for (std::uint32_t ring = 0; ring < last; ring += count)
            sides(next_ + ring, next_ + ring + count, count);
        for (const auto& [a, b, c] : profile.cap) {
            output_.triangle(next_ + a, next_ + c, next_ + b);
            output_.triangle(next_ + last + a, next_ + last + b, next_ + last + c);
        }
    }
    next_ += last + count;
    triangles_ += 2 * (std::uint64_t{last} + profile.cap.size());
}

void PartWriter::sweepAround(const Profile& profile, std::span<const Ring> rings, Rgb color) {
    const auto count = static_cast<std::uint32_t>(profile.points.size());
    const auto all = static_cast<std::uint32_t>(rings.size()) * count;
    if (pass_ == Pass::vertices) {
        vertices(profile, rings, color);
    } else {
        for (std::uint32_t ring = 0; ring < all; ring += count) {
            sides(next_ + ring, next_ + (ring + count) % all, count);
        }
    }
    next_ += all;
    triangles_ += 2 * std::uint64_t{all};
}

void PartWriter::vertices(const Profile& profile, std::span<const Ring> rings, Rgb color) {
    for (const Ring& ring : rings) {
        for (const glm::dvec2& point : profile.points) {
            output_.vertex(glm::vec3(ring.center + point.x * ring.u + point.y * ring.v), color);
        }
    }
}

// Between two rings of `count` vertices.
void PartWriter::sides(std::uint32_t from, std::uint32_t to, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t j = i + 1 < count ? i + 1 : 0;
        output_.triangle(from + i, from + j, to + j);
        output_.triangle(from + i, to + j, to + i);
    }
}

}  // namespace iwalk
