#include "preprocess/levels/cell_runs.hpp"

#include "preprocess/build/grid.hpp"

namespace iwalk {
namespace {

class Joiner {
  public:
    explicit Joiner(unsigned leastLevels) : leastLevels_(leastLevels) {}

    void join(std::span<const RunSource> sources, unsigned levels) {
        std::size_t triangles = 0;
        for (const RunSource& source : sources) triangles += source.triangles;
        if (triangles == 0) return absorb(sources);
        if (levels == kMaxPathLevels || !isTooLarge(triangles, levels, leastLevels_))
            return add(sources, levels);
        std::size_t whole = 0;
        while (whole < sources.size() && sources[whole].levels <= levels) ++whole;
        const std::size_t before = runs_.size();
        if (whole > 0) add(sources.first(whole), levels);
        const bool encloses = runs_.size() > before;
        if (encloses) enclosing_.push_back(runs_.size() - 1);
        for (sources = sources.subspan(whole); !sources.empty();) {
            std::size_t count = 0;
            while (count < sources.size() &&
                   path(sources[count].key, levels + 1) == path(sources[0].key, levels + 1)) {
                ++count;
            }
            join(sources.first(count), levels + 1);
            sources = sources.subspan(count);
        }
        if (encloses) enclosing_.pop_back();
    }

    std::vector<Run> take() {
        if (!runs_.empty()) runs_.front().box.add(early_);
        return std::move(runs_);
    }

  private:
    static std::uint32_t path(std::uint64_t key, unsigned levels) {
        return static_cast<std::uint32_t>(std::uint64_t{1} << 3 * levels |
                                          key >> (kMortonKeyBits - 3 * levels));
    }

    // Nothing is left of these.
    void absorb(std::span<const RunSource> sources) {
        LatticeBox& box = !enclosing_.empty() ? runs_[enclosing_.back()].box
                          : runs_.empty()     ? early_
                                              : runs_.back().box;
        for (const RunSource& source : sources) box.add(source.box);
    }

    // One range, or, where cells cannot be split, as few as do.
    void add(std::span<const RunSource> sources, unsigned levels) {
        std::size_t triangles = 0;
        for (const RunSource& source : sources) triangles += source.triangles;
        if (triangles == 0) return absorb(sources);
        runs_.push_back({done_, path(sources[0].key, levels), {}});
        std::size_t inRun = 0;
        for (const RunSource& source : sources) {
            if (inRun > 0 && inRun + source.triangles > kMaxRangeTriangles) {
                runs_.push_back({done_, path(source.key, levels), {}});
                inRun = 0;
            }
            inRun += source.triangles;
            done_ += source.triangles;
            runs_.back().end = done_;
            runs_.back().box.add(source.box);
        }
    }

    unsigned leastLevels_;
    std::size_t done_ = 0;
    LatticeBox early_;                    // of sources before the first range
    std::vector<std::size_t> enclosing_;  // ranges of cells that are being split, outermost first
    std::vector<Run> runs_;
};

}  // namespace

std::vector<Run> joinRanges(std::span<const RunSource> sources, unsigned leastLevels) {
    Joiner joiner(leastLevels);
    joiner.join(sources, 0);
    return joiner.take();
}

}  // namespace iwalk
