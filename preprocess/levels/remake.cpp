#include "preprocess/levels/remake.hpp"

#include <algorithm>
#include <set>

#include "preprocess/levels/old_targets.hpp"

namespace iwalk {
namespace {

class Keeper {
  public:
    Keeper(const LevelModel& model, const Stage& stage, const OldTree& old)
        : model_(model), stage_(stage), old_(old), before_(oldLevel(old, stage.level)) {}

    // By node; nullptr where an entry must be made, or there is none.
    std::vector<const LevelRecord*> run() {
        std::vector<const LevelRecord*> kept(model_.nodes.size(), nullptr);
        if (!before_) return kept;
        std::vector<bool> stays(old_.model().nodes.size(), false);
        for (std::uint32_t node = 0; node < kept.size(); ++node) {
            if (!hasEntry(node) || model_.origin[node] == Tree::kNone || isChanged(node)) continue;
            kept[node] = oldEntry(model_.origin[node]);
            if (kept[node] != nullptr) stays[model_.origin[node]] = true;
        }
        // Of pages of which a part goes the rest goes, too.
        std::set<std::uint32_t> going;
        for (std::uint32_t node = 0; node < stays.size(); ++node) {
            const LevelRecord* const entry = oldEntry(node);
            if (entry != nullptr && !stays[node]) going.insert(entry->firstPage);
        }
        for (const LevelRecord*& entry : kept) {
            if (entry != nullptr && going.contains(entry->firstPage)) entry = nullptr;
        }
        return kept;
    }

    bool hasEntry(std::uint32_t node) const {
        return model_.hasWhole(node, stage_.level) || model_.hasOwn(node, stage_.level);
    }

  private:
    const LevelRecord* oldEntry(std::uint32_t node) const {
        const auto& entries = old_.model().entries[node];
        const auto found =
            std::ranges::find(entries, static_cast<std::uint8_t>(*before_), &LevelRecord::level);
        return found == entries.end() ? nullptr : &*found;
    }

    bool isChanged(std::uint32_t node) const {
        return std::ranges::any_of(model_.sourcesOf(node, stage_.level), [&](const EntrySource& source) {
            const std::uint32_t first = source.entry.firstPage;
            for (std::uint32_t page = first; page < first + source.entry.pageCount; ++page) {
                const StagePage& staged = stage_.pages[stage_.places.at(page)];
                if (staged.fresh || staged.moved) return true;
            }
            return false;
        });
    }

    const LevelModel& model_;
    const Stage& stage_;
    const OldTree& old_;
    const std::optional<unsigned> before_;
};

}  // namespace

std::vector<bool> keepEntries(LevelModel& model, const Stage& stage, const OldTree& old) {
    Keeper keeper(model, stage, old);
    const std::vector<const LevelRecord*> kept = keeper.run();
    std::vector<bool> make(model.nodes.size(), false);
    for (std::uint32_t node = 0; node < make.size(); ++node) {
        make[node] = keeper.hasEntry(node) && kept[node] == nullptr;
        if (kept[node] == nullptr) continue;
        model.entries[node].push_back(*kept[node]);
        model.entries[node].back().level = static_cast<std::uint8_t>(stage.level);
    }
    return make;
}

}  // namespace iwalk
