#include "preprocess/levels/targets.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace iwalk {
namespace {

constexpr std::size_t kBinVertices = std::size_t{1} << 18;
constexpr std::size_t kMostBins = 512;

// Consecutive pages share a bin while it has few vertices.
std::vector<std::uint32_t> dealBins(const Stage& stage) {
    std::size_t all = 0;
    const std::span<const StagePage> changing = std::span(stage.pages).first(stage.changing);
    for (const StagePage& page : changing) all += page.record.vertexCount;
    const std::size_t perBin = std::max(kBinVertices, all / (kMostBins / 2));
    std::vector<std::uint32_t> bins;
    std::size_t inBin = 0;
    std::uint32_t bin = 0;
    for (const StagePage& page : changing) {
        const std::size_t vertices = page.record.vertexCount;
        if (inBin > 0 && inBin + vertices > perBin) ++bin, inBin = 0;
        inBin += vertices;
        bins.push_back(bin);
    }
    return bins;
}

}  // namespace

TargetBins::TargetBins(ChunkFile& file, const Stage& stage)
    : file_(file),
      stage_(stage),
      binOf_(dealBins(stage)),
      writer_(file, binOf_.empty() ? 1 : binOf_.back() + 1, kWords) {
    static_assert(sizeof(VertexTarget) % 4 == 0 && std::is_trivially_copyable_v<VertexTarget>);
}

Result<void> TargetBins::add(std::span<const VertexTarget> targets) {
    for (const VertexTarget& target : targets) {
        ASSIGN_OR_RETURN(std::uint32_t* const place, writer_.append(binOf_[target.stagePage]));
        std::memcpy(place, &target, sizeof(target));
    }
    return {};
}

Result<void> TargetBins::finish() {
    ASSIGN_OR_RETURN(bins_, writer_.finish());
    return {};
}

Result<void> TargetBins::load(std::size_t bin) {
    loaded_ = bin;
    targets_.clear();
    targets_.reserve(static_cast<std::size_t>(bins_[bin].count));
    BinReader reader(file_, std::move(bins_[bin]), kWords);
    std::vector<std::uint32_t> words;
    while (reader.left() > 0) {
        words.clear();
        RETURN_IF_ERROR(reader.next(words));
        const std::size_t before = targets_.size();
        targets_.resize(before + words.size() / kWords);
        std::memcpy(static_cast<void*>(targets_.data() + before), words.data(), words.size() * 4);
    }
    sortByPage(bin);
    return {};
}

// Each vertex is there once: the order of a page's targets does not matter.
void TargetBins::sortByPage(std::size_t bin) {
    const auto pages = std::ranges::equal_range(binOf_, static_cast<std::uint32_t>(bin));
    firstPage_ = static_cast<std::size_t>(pages.begin() - binOf_.begin());
    ends_.assign(pages.size() + 1, 0);
    for (const VertexTarget& target : targets_) ++ends_[target.stagePage - firstPage_ + 1];
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
    order_.resize(targets_.size());
    for (std::uint32_t i = 0; i < targets_.size(); ++i)
        order_[ends_[targets_[i].stagePage - firstPage_]++] = i;
}

Result<void> TargetBins::take(std::uint32_t index, PageTargets& targets) {
    if (binOf_[index] != loaded_) RETURN_IF_ERROR(load(binOf_[index]));
    const std::size_t page = index - firstPage_;
    for (std::size_t i = page == 0 ? 0 : ends_[page - 1]; i < ends_[page]; ++i) {
        const VertexTarget& target = targets_[order_[i]];
        targets.positions[target.vertex] = target.position;
        targets.errors[target.vertex] = target.error;
        if (!targets.colors.empty()) targets.colors[target.vertex] = target.color;
        if (!targets.normals.empty()) targets.normals[target.vertex] = target.normal;
    }
    return {};
}

Result<PageTargets> stayingTargets(const Stage& stage, const StagePage& page, const SourcePage& source) {
    PageTargets targets{source.positions, std::vector<float>(source.positions.size(), page.error),
                        source.colors, source.normals};
    ASSIGN_OR_RETURN(const std::vector<std::uint8_t> errors, stage.errors->of(page.number));
    for (std::size_t v = 0; v < errors.size(); ++v) {
        targets.errors[v] = static_cast<float>(errors[v]) * (stage.errorUnit / 255.0f);
    }
    return targets;
}

}  // namespace iwalk
