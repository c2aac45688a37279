#include "server/visibility/plp_spending.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace iwalk {
namespace {

// What the steps may spend of the budget together. More and earlier looks find few pixels more
// (docs/results.md).
constexpr double kSteps[] = {0.15, 0.4, 0.7, 1};

}  // namespace

PlpSpending::PlpSpending(std::vector<Range> ranges, std::uint64_t budget)
    : open_(std::move(ranges)), budget_(budget) {
    std::uint64_t all = 0;
    for (const Range& range : open_) all += range.triangles;
    whole_ = std::min(all, budget);
    if (all <= budget) steps_ = static_cast<unsigned>(std::size(kSteps)) - 1;
}

std::vector<PlpSpending::Taken> PlpSpending::step() {
    const auto limit = static_cast<std::uint64_t>(kSteps[steps_++] * static_cast<double>(budget_));
    std::vector<Taken> taken;
    std::erase_if(open_, [&](const Range& range) {
        if (range.triangles > limit - std::min(limit, spent_)) return false;
        taken.push_back({range.number, static_cast<float>(spent_) / static_cast<float>(whole_ + 1)});
        spent_ += range.triangles;
        return true;
    });
    std::erase_if(open_, [&](const Range& range) { return range.triangles > left(); });
    done_ = open_.empty();
    return taken;
}

std::size_t PlpSpending::look(const DepthPyramid& drawn) {
    const std::size_t hidden =
        std::erase_if(open_, [&](const Range& range) { return drawn.hides(range.box); });
    std::vector<std::pair<double, Range>> scored;
    scored.reserve(open_.size());
    for (const Range& range : open_)
        scored.emplace_back(drawn.openPixels(range.box) / std::max(1u, range.triangles), range);
    std::stable_sort(scored.begin(), scored.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::transform(scored.begin(), scored.end(), open_.begin(), [](const auto& s) { return s.second; });
    done_ = open_.empty();
    return hidden;
}

}  // namespace iwalk
