#include "server/visibility/plp_spending.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/visibility/order.hpp"

namespace iwalk {
namespace {

// What the steps may spend of the budget together. More and earlier looks find few pixels more
// (docs/results.md).
constexpr double kSteps[] = {0.15, 0.4, 0.7, 1};

constexpr float kHidden = 0;            // instead of a score
constexpr std::size_t kTogether = 256;  // ranges that a thread looks at together

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

std::size_t PlpSpending::look(const DepthPyramid& drawn, Workers& workers) {
    std::vector<float> scores(open_.size(), kHidden);
    workers.runParts(open_.size(), kTogether, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i)
            if (!drawn.hides(open_[i].box))
                scores[i] =
                    1 + drawn.openPixels(open_[i].box) / static_cast<float>(std::max(1u, open_[i].triangles));
    });
    std::vector<Range> left;
    left.reserve(open_.size());
    for (const std::uint32_t place : greatestFirst(scores)) {
        if (scores[place] == kHidden) break;
        left.push_back(open_[place]);
    }
    open_.swap(left);
    done_ = open_.empty();
    return left.size() - open_.size();
}

}  // namespace iwalk
