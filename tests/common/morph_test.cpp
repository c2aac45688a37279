#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "tests/common/morph_sample.hpp"

namespace iwalk {
namespace {

void expectBoxes(const MorphSample& sample, const PageMorph& morph) {
    ASSERT_EQ(morph.boxes.size(), 2u);
    for (std::size_t r = 0; r < 2; ++r) {
        LatticeBox box;
        const Range& range = sample.table.ranges[r];
        for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; ++i) {
            box.add(sample.targets[sample.indices[i]]);
        }
        const MorphBox& found = morph.boxes[r];
        EXPECT_EQ(box.min, morph.origin + LatticePoint(found.min[0], found.min[1], found.min[2]));
        EXPECT_EQ(box.max, morph.origin + LatticePoint(found.max[0], found.max[1], found.max[2]));
    }
}

// Extra positions are where no vertex is.
std::size_t extrasOf(const MorphSample& sample) {
    const auto key = [](const LatticePoint& p) { return std::tuple(p.x, p.y, p.z); };
    std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> places, extras;
    for (const LatticePoint& p : sample.positions) places.insert(key(p));
    for (const LatticePoint& p : sample.targets) {
        if (!places.contains(key(p))) extras.insert(key(p));
    }
    return extras.size();
}

void expectRoundTrip(const MorphSample& sample, std::uint32_t flags) {
    EXPECT_EQ(sample.record.flags, flags);
    EXPECT_EQ(sample.record.morphBytes, sample.bytes.size());
    const auto morph = sample.decoded();
    ASSERT_TRUE(morph.ok()) << morph.error().message;
    EXPECT_EQ(morph->numbers.size(), sample.positions.size());
    EXPECT_EQ(morph->extras.size(), extrasOf(sample));
    EXPECT_TRUE(targetsOf(*morph, sample.positions) == sample.targets);
    expectBoxes(sample, *morph);
}

TEST(MorphTest, RoundTrips) {
    for (const Targets kind : {Targets::kStay, Targets::kVertices}) {
        for (const int bits : {1, 21, 22, 32}) expectRoundTrip(MorphSample(300, bits, kind), 0);
    }
    for (const Targets kind : {Targets::kVerticesAndExtras, Targets::kExtras}) {
        expectRoundTrip(MorphSample(300, 21, kind), 0);
        expectRoundTrip(MorphSample(300, 22, kind), kMorphWide);
        expectRoundTrip(MorphSample(300, 32, kind), kMorphWide);
        expectRoundTrip(MorphSample(2, 21, kind), 0);
        expectRoundTrip(MorphSample(kMaxPageVertices - 2, 21, kind), 0);
    }
    expectRoundTrip(MorphSample(kMaxPageVertices - 2, 32, Targets::kVertices), 0);
}

// A vertex that stays has its own number, others the first that is there.
TEST(MorphTest, NumbersAreTheLowest) {
    MorphSample sample(20, 21, Targets::kStay);
    sample.targets[3] = sample.positions[9];
    sample.targets[4] = sample.targets[6] = kLowest;
    sample.encode();
    const PageMorph morph = sample.decoded().value();
    EXPECT_EQ(morph.numbers[9], 9u);
    EXPECT_EQ(morph.numbers[3], 5u);
    EXPECT_EQ(morph.numbers[4], 22u);
    EXPECT_EQ(morph.numbers[6], 22u);
    EXPECT_EQ(morph.extras.size(), 1u);
}

// Far from the page, in any direction.
TEST(MorphTest, TargetsMayBeAnywhere) {
    for (const std::int64_t far : {std::int64_t{1} << 33, -(std::int64_t{1} << 45)}) {
        MorphSample sample(20, 21, Targets::kExtras);
        for (LatticePoint& target : sample.targets) target += LatticePoint(far, 0, -far);
        sample.encode();
        expectRoundTrip(sample, 0);
    }
}

}  // namespace
}  // namespace iwalk
