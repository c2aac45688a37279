#include "tests/bench/plp/methods.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "server/visibility/plp_spending.hpp"

namespace iwalk::bench {
namespace {

// Something that is drawn as a whole.
struct Item {
    VisibleRanges ranges;
    std::uint64_t triangles = 0;
    double score = 0;
};

std::vector<VisibleRanges> spend(std::vector<Item> items, std::uint64_t budget) {
    std::stable_sort(items.begin(), items.end(),
                     [](const Item& a, const Item& b) { return a.score > b.score; });
    std::vector<VisibleRanges> chosen;
    for (const Item& item : items) {
        if (item.triangles > budget) continue;
        budget -= item.triangles;
        chosen.push_back(item.ranges);
    }
    return chosen;
}

// A page of it at a time, where an entry has more than one.
void addEntry(const Hierarchy& hierarchy, const LevelRecord& entry, double score, std::vector<Item>& items) {
    if (entry.pageCount == 1) {
        items.push_back({{entry.firstPage, entry.firstRange, entry.rangeCount}, entry.triangles, score});
        return;
    }
    for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page) {
        const PageRecord& record = hierarchy.pages[page];
        items.push_back({{page, 0, record.rangeCount}, record.indexCount / 3, score});
    }
}

using EntryScore = double (*)(const EntryPriority&, const LevelRecord&);

Method wholeEntries(const char* name, const Bench& bench, EntryScore score) {
    return {name, [&bench, score](const Shot& shot, std::uint64_t budget) {
                const Hierarchy& hierarchy = bench.dataset.hierarchy;
                std::vector<Item> items;
                for (const EntryPriority& found : entryPriorities(
                         hierarchy, bench.cells, bench.cut, shot.sight, bench.raysPerPixel, *bench.workers)) {
                    const LevelRecord& entry = hierarchy.entries[found.entry];
                    addEntry(hierarchy, entry, score(found, entry), items);
                }
                return spend(std::move(items), budget);
            }};
}

std::vector<PlpRange> rangesByRays(const Bench& bench, const Shot& shot, std::uint64_t budget) {
    const PlpVisibility plp(bench.dataset.hierarchy, budget, bench.raysPerPixel, *bench.workers);
    const auto table = [&](std::uint32_t page) { return &bench.pages.tables[page]; };
    return plp.ranges(plp.candidates(bench.cut, shot.sight), table, shot.sight);
}

}  // namespace

// As PlpFrame does, with the tile as one block.
Method modePlp(const Bench& bench, OwnerRenders& renders) {
    return {"rays, ranges, looks (`--mode plp`)", [&](const Shot& shot, std::uint64_t budget) {
                const std::vector<PlpRange> ranges = rangesByRays(bench, shot, budget);
                const BoxProjection boxes(shot.sight.projection, shot.sight.tile, shot.sight.near);
                std::vector<PlpSpending::Range> open;
                for (std::uint32_t i = 0; i < ranges.size(); ++i) {
                    const EyeBox& box = ranges[i].box;
                    const ScreenBox onScreen = boxes.of(glm::dvec3(box.low), glm::dvec3(box.high));
                    if (!onScreen.empty()) open.push_back({i, ranges[i].triangles, onScreen});
                }
                PlpSpending spending(std::move(open), budget);
                std::vector<VisibleRanges> chosen;
                while (true) {
                    for (const PlpSpending::Taken& taken : spending.step())
                        chosen.push_back({ranges[taken.number].page, ranges[taken.number].range, 1});
                    if (spending.done()) return chosen;
                    DepthPyramid drawn;
                    renders.depthsOf(shot.sight, chosen, drawn);
                    spending.look(drawn, *bench.workers);
                }
            }};
}

namespace {

Method withoutLooks(const Bench& bench) {
    return {"rays, ranges", [&bench](const Shot& shot, std::uint64_t budget) {
                std::vector<Item> items;
                for (const PlpRange& range : rangesByRays(bench, shot, budget))
                    items.push_back({{range.page, range.range, 1}, range.triangles, 0});
                return spend(std::move(items), budget);
            }};
}

Method originalMethod(const Bench& bench, const OriginalPlp& original) {
    return {"original PLP", [&](const Shot& shot, std::uint64_t budget) {
                std::vector<Item> items;
                for (const std::uint32_t entry : original.project(shot.sight, budget))
                    addEntry(bench.dataset.hierarchy, bench.dataset.hierarchy.entries[entry], 0, items);
                return spend(std::move(items), budget);
            }};
}

// The most pixels per triangle, knowing who owns how many.
Method oracleOfRanges(const Bench& bench) {
    return {
        "oracle, ranges", [&bench](const Shot& shot, std::uint64_t budget) {
            std::vector<Item> items;
            for (const Owned& owned : shot.owned) {
                const std::uint32_t triangles =
                    bench.pages.tables[owned.page].ranges[owned.range].indexCount / 3;
                items.push_back({{owned.page, owned.range, 1}, triangles, 1.0 * owned.pixels / triangles});
            }
            return spend(std::move(items), budget);
        }};
}

Method oracleOfEntries(const Bench& bench) {
    return {"oracle, whole nodes", [&bench](const Shot& shot, std::uint64_t budget) {
                const Hierarchy& hierarchy = bench.dataset.hierarchy;
                std::vector<Item> all, items;
                for (const std::uint32_t entry : bench.cut.entry)
                    if (entry != Cut::kNothing) addEntry(hierarchy, hierarchy.entries[entry], 0, all);
                std::map<std::pair<std::uint32_t, std::uint32_t>, Item> byStart;
                for (const Item& item : all) byStart[{item.ranges.page, item.ranges.firstRange}] = item;
                for (const Owned& owned : shot.owned)
                    std::prev(byStart.upper_bound({owned.page, owned.range}))->second.score += owned.pixels;
                for (auto& [start, item] : byStart)
                    if (item.score > 0)
                        item.score /= static_cast<double>(item.triangles), items.push_back(item);
                return spend(std::move(items), budget);
            }};
}

}  // namespace

std::vector<Method> allMethods(const Bench& bench, const OriginalPlp& original, OwnerRenders& renders) {
    return {
        modePlp(bench, renders),
        withoutLooks(bench),
        wholeEntries("rays, whole nodes, sum per triangle", bench,
                     [](const EntryPriority& p, const LevelRecord& entry) {
                         return p.contribution / std::max(1.0, 1.0 * entry.triangles);
                     }),
        wholeEntries("rays, whole nodes, sum", bench,
                     [](const EntryPriority& p, const LevelRecord&) { return double{p.contribution}; }),
        wholeEntries("rays, whole nodes, mean (Corrêa)", bench,
                     [](const EntryPriority& p, const LevelRecord&) {
                         return p.rays > 0 ? 1.0 * p.contribution / p.rays : 0.0;
                     }),
        originalMethod(bench, original),
        oracleOfRanges(bench),
        oracleOfEntries(bench),
    };
}

std::uint64_t correctPixels(const Shot& shot, const std::vector<VisibleRanges>& chosen) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> drawn;
    for (const VisibleRanges& ranges : chosen)
        for (std::uint32_t range = ranges.firstRange; range < ranges.firstRange + ranges.rangeCount; ++range)
            drawn.emplace(ranges.page, range);
    auto correct = static_cast<std::uint64_t>(shot.sight.tile.width) *
                   static_cast<std::uint64_t>(shot.sight.tile.height);
    for (const Owned& owned : shot.owned)
        if (!drawn.contains({owned.page, owned.range})) correct -= owned.pixels;
    return correct;
}

}  // namespace iwalk::bench
