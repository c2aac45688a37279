#include "preprocess/build/assemble.hpp"

#include <malloc.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "preprocess/build/grid.hpp"
#include "preprocess/build/order.hpp"
#include "preprocess/levels/detail.hpp"

namespace iwalk {
namespace {

constexpr int kJoining = -2;           // a group of slices; others are numbered by levels, or -1
constexpr unsigned kKeyDigitBits = 9;  // 512 bins, about as many as a grid has

std::vector<std::uint64_t> countsOf(const std::vector<Bin>& bins) {
    std::vector<std::uint64_t> counts;
    for (const Bin& bin : bins) counts.push_back(bin.count);
    return counts;
}

}  // namespace

Assembler::Assembler(const RecordFormat& format, const Lattice& lattice, AssembleOptions options,
                     ChunkFile& spill, PageWriter& writer, const OldTree& old)
    : format_(format),
      lattice_(lattice),
      options_(std::move(options)),
      spill_(spill),
      writer_(writer),
      old_(old),
      threads_(tbb::global_control::max_allowed_parallelism, options_.threads),
      arena_(static_cast<int>(options_.threads)),
      packer_(format, options_.leafTriangles) {
    CHECK_OP(options_.batchTriangles, >=, options_.leafTriangles);
}

unsigned Assembler::edgeLog2(std::uint32_t node) const {
    return lattice_.rootCellLog2 - tree_[node].depth;
}

Result<void> Assembler::run(std::vector<Bin> bins) {
    for (const Bin& bin : bins) allTriangles_ += bin.count;
    RETURN_IF_ERROR(addGrid(std::move(bins), {Tree::kNone, 0, 0, old_.root()}));
    RETURN_IF_ERROR(flush());
    packer_.finish();
    return writePages();
}

Result<void> Assembler::writePages() {
    const auto entryOf = [&](const NodeRanges& ranges) -> LevelRecord& {
        return tree_.fullEntry(ranges.node);
    };
    return writer_.write(packer_.take(), entryOf, arena_);
}

std::uint32_t Assembler::addNode(const GridPlace& place) {
    const bool isOld = place.old != OldTree::kNone && !old_.isNew(place.old);
    const std::uint32_t node =
        tree_.add(place.parent, place.octant, place.depth, isOld ? place.old : Tree::kNone);
    if (isOld && !old_.isTouched(place.old)) keepOwn(node);
    return node;
}

// The node's own triangles stay in their pages.
void Assembler::keepOwn(std::uint32_t node) {
    const std::uint32_t origin = tree_.origin(node);
    const LevelModel& model = old_.model();
    if (!model.owns(origin)) return;
    tree_.fullEntry(node) = model.entries[origin].front();
    tree_.finest(node) = model.finest[origin] + static_cast<int>(old_.grownBy());
    setOwnBox(tree_[node], Hierarchy::ownBox(model.nodes[origin]));
}

// A node of the old tree, and all below it.
void Assembler::keep(const GridPlace& place) {
    const std::uint32_t node = addNode(place);
    if (old_.isInterior(place.old)) tree_.setInterior(node);
    for (std::uint8_t octant = 0; octant < 8; ++octant) {
        const std::uint32_t child = old_.child(place.old, octant);
        if (child != OldTree::kNone) keep({node, octant, place.depth + 1, child});
    }
}

Result<void> Assembler::addGrid(std::vector<Bin> bins, const GridPlace& place) {
    const unsigned noLeaves = levelsWithoutLeaves(place.depth, lattice_.rootCellLog2);
    const std::vector<PlannedNode> plan =
        planGrid(countsOf(bins), options_.leafTriangles, old_, place.old, noLeaves);
    std::vector<std::uint32_t> numbers(plan.size(), Tree::kNone);
    for (std::size_t i = 0; i < plan.size(); ++i) {
        const PlannedNode& planned = plan[i];
        const bool isRoot = planned.parent == kNoParent;
        const GridPlace self{isRoot ? place.parent : numbers[planned.parent],
                             isRoot ? place.octant : planned.octant, place.depth + planned.level,
                             planned.old};
        if (planned.kind == PlannedNode::kSubtree) {
            RETURN_IF_ERROR(addSubtree(std::move(bins[planned.firstBin]), self));
            continue;
        }
        if (planned.kind == PlannedNode::kKept) {
            keep(self);
            continue;
        }
        numbers[i] = addNode(self);
        if (planned.kind == PlannedNode::kInterior) tree_.setInterior(numbers[i]);
        std::vector<Bin> own;
        std::uint64_t total = 0;
        for (Bin& bin : std::span(bins).subspan(planned.firstBin, planned.binCount)) {
            total += bin.count;
            own.push_back(std::move(bin));
        }
        if (total > 0) RETURN_IF_ERROR(addOwn(std::move(own), numbers[i], total));
    }
    return {};
}

Result<void> Assembler::addSubtree(Bin bin, const GridPlace& place) {
    const std::size_t count = static_cast<std::size_t>(bin.count);
    if (count <= options_.batchTriangles) {
        RETURN_IF_ERROR(makeRoom(count));
        units_.push_back({true, place.parent, place.octant, place.depth, 0, records_.size() / format_.words(),
                          count, place.old});
        return load(std::move(bin));
    }
    const auto gridBin = [&](const std::uint32_t* record) {
        return binOf(format_.place(record), place.depth, format_.rootCellLog2());
    };
    ASSIGN_OR_RETURN(std::vector<Bin> bins, distribute(std::move(bin), kGridBins, gridBin));
    return addGrid(std::move(bins), place);
}

Result<void> Assembler::addOwn(std::vector<Bin> bins, std::uint32_t node, std::uint64_t total) {
    if (total > options_.batchTriangles) {  // no leaf, so it is one bin
        CHECK_OP(bins.size(), ==, 1u);
        return addTooMany(std::move(bins[0]), node, total, kKeyBits);
    }
    RETURN_IF_ERROR(makeRoom(total));
    units_.push_back({false, node, 0, 0, total, records_.size() / format_.words(),
                      static_cast<std::size_t>(total), OldTree::kNone});
    for (Bin& bin : bins) RETURN_IF_ERROR(load(std::move(bin)));
    return {};
}

// A node's own triangles when they are too many to sort in memory: by the highest bits of the key first.
// `keyBits` low bits of the keys in the bin may differ.
Result<void> Assembler::addTooMany(Bin bin, std::uint32_t node, std::uint64_t total, unsigned keyBits) {
    if (bin.count <= options_.batchTriangles || keyBits == 0) return addInPieces(std::move(bin), node, total);
    const unsigned shift = keyBits - kKeyDigitBits;
    static_assert(kKeyBits % kKeyDigitBits == 0);
    constexpr std::size_t kDigits = std::size_t{1} << kKeyDigitBits;
    const unsigned edge = edgeLog2(node);
    const auto digit = [&](const std::uint32_t* record) {
        return static_cast<std::size_t>(sortKey(format_.place(record), edge) >> shift) & (kDigits - 1);
    };
    ASSIGN_OR_RETURN(std::vector<Bin> bins, distribute(std::move(bin), kDigits, digit));
    for (Bin& part : bins) {
        if (part.count > 0) RETURN_IF_ERROR(addTooMany(std::move(part), node, total, shift));
    }
    return {};
}

// In one piece, or, when all keys are equal, in as many as it takes.
Result<void> Assembler::addInPieces(Bin bin, std::uint32_t node, std::uint64_t total) {
    const std::uint64_t most = options_.batchTriangles;
    RETURN_IF_ERROR(makeRoom(std::min(bin.count, most)));
    const auto held = [&] { return records_.size() / format_.words(); };
    const auto begin = [&] { units_.push_back({false, node, 0, 0, total, held(), 0, OldTree::kNone}); };
    begin();
    const std::uint64_t chunk = spill_.chunkBytes() / format_.bytes();
    BinReader reader(spill_, std::move(bin), format_.words());
    while (reader.left() > 0) {
        if (held() + std::min(chunk, reader.left()) > most) {
            RETURN_IF_ERROR(flush());
            begin();
        }
        RETURN_IF_ERROR(reader.next(records_));
        units_.back().count = held() - units_.back().first;
    }
    return {};
}

template <class BinOfRecord>
Result<std::vector<Bin>> Assembler::distribute(Bin bin, std::size_t binCount, BinOfRecord binOfRecord) {
    // The batch makes way for the buffers of the bins.
    RETURN_IF_ERROR(flush());
    records_ = {};
    malloc_trim(0);
    BinWriter writer(spill_, binCount, format_.words());
    BinReader reader(spill_, std::move(bin), format_.words());
    std::vector<std::uint32_t> chunk;
    while (reader.left() > 0) {
        chunk.clear();
        RETURN_IF_ERROR(reader.next(chunk));
        for (std::size_t at = 0; at < chunk.size(); at += format_.words()) {
            ASSIGN_OR_RETURN(std::uint32_t* const place, writer.append(binOfRecord(chunk.data() + at)));
            std::copy_n(chunk.begin() + static_cast<std::ptrdiff_t>(at), format_.words(), place);
        }
    }
    return writer.finish();
}

Result<void> Assembler::makeRoom(std::uint64_t triangles) {
    if (records_.size() / format_.words() + triangles > options_.batchTriangles) RETURN_IF_ERROR(flush());
    const std::uint64_t most = std::min<std::uint64_t>(options_.batchTriangles, allTriangles_);
    records_.reserve(static_cast<std::size_t>(most) * format_.words());
    return {};
}

Result<void> Assembler::load(Bin bin) {
    BinReader reader(spill_, std::move(bin), format_.words());
    while (reader.left() > 0) RETURN_IF_ERROR(reader.next(records_));
    return {};
}

// Everything in the batch goes into pages, but for what waits for neighbours.
Result<void> Assembler::flush() {
    if (units_.empty()) return {};
    std::vector<std::uint32_t> order(records_.size() / format_.words());
    std::iota(order.begin(), order.end(), 0u);
    const std::vector<Subtree> grown = growUnits(order);
    std::vector<Slice> slices = makeSlices(grown, order);
    sortSlices(slices, order);
    findLevels(slices);
    for (std::size_t i = 0; i < slices.size(); ++i) {
        NodeRecord& node = tree_[slices[i].node];
        LatticeBox box = Hierarchy::ownBox(node);
        box.add(slices[i].box);
        setOwnBox(node, box);
        packer_.add(std::move(slices[i]), totals_[i]);
        // Page by page rather than all at the end, so that the progress bar moves.
        if (i % 64 == 63) RETURN_IF_ERROR(writePages());
        if (options_.done) {
            options_.done(static_cast<double>(doneTriangles_ + order.size() * (i + 1) / slices.size()) /
                          static_cast<double>(allTriangles_));
        }
    }
    RETURN_IF_ERROR(writePages());
    doneTriangles_ += order.size();
    packer_.keep();
    records_.clear();
    units_.clear();
    return {};
}

std::vector<Subtree> Assembler::growUnits(std::vector<std::uint32_t>& order) {
    std::vector<Subtree> grown(units_.size());
    arena_.execute([&] {
        tbb::parallel_for(std::size_t{0}, units_.size(), [&](std::size_t i) {
            const Unit& unit = units_[i];
            if (!unit.subtree) return;
            const std::span<std::uint32_t> own = std::span(order).subspan(unit.first, unit.count);
            grown[i] = growSubtree(format_, records_.data(), own, unit.depth, unit.octant,
                                   options_.leafTriangles, old_, unit.old);
        });
    });
    return grown;
}

// The nodes of a subtree enter the tree. Their numbers there.
std::vector<std::uint32_t> Assembler::addNodes(const Unit& unit, const Subtree& grown) {
    std::vector<std::uint32_t> numbers;
    for (const Subtree::Node& node : grown.nodes) {
        const std::uint32_t parent = node.parent == kNoParent ? unit.node : numbers[node.parent];
        const GridPlace place{parent, node.octant, node.depth, node.old};
        if (node.kept) keep(place);
        numbers.push_back(node.kept ? Tree::kNone : addNode(place));
        if (!node.kept && old_.isInterior(node.old)) tree_.setInterior(numbers.back());
    }
    return numbers;
}

// The nodes of the subtrees enter the tree; every node's triangles become a slice, depth first.
std::vector<Slice> Assembler::makeSlices(const std::vector<Subtree>& grown,
                                         const std::vector<std::uint32_t>& order) {
    std::vector<Slice> slices;
    totals_.clear();
    const auto add = [&](std::uint32_t node, std::size_t first, std::size_t count, std::uint64_t total) {
        Slice slice;
        slice.node = node;
        slice.edgeLog2 = edgeLog2(node);
        slice.records = records_.data();
        slice.order = order.data() + first;
        slice.count = count;
        slices.push_back(std::move(slice));
        totals_.push_back(total);
    };
    for (std::size_t i = 0; i < units_.size(); ++i) {
        const Unit& unit = units_[i];
        if (!unit.subtree) add(unit.node, unit.first, unit.count, unit.total);
        const std::vector<std::uint32_t> numbers = addNodes(unit, grown[i]);
        for (const Subtree::Own& own : grown[i].owned) {
            add(numbers[own.node], unit.first + own.first, own.count, own.count);
        }
    }
    return slices;
}

// Sorts each slice's triangles and finds their box.
void Assembler::sortSlices(std::vector<Slice>& slices, std::vector<std::uint32_t>& order) {
    const auto sort = [&](Slice& slice) {
        const std::size_t first = static_cast<std::size_t>(slice.order - order.data());
        sortByKey(format_, slice.records, slice.edgeLog2, std::span(order).subspan(first, slice.count));
        for (std::size_t i = 0; i < slice.count; ++i) {
            const std::uint32_t* record = slice.record(i, format_.words());
            for (std::size_t c = 0; c < 3; ++c) slice.box.add(lattice_.fromCell(format_.position(record, c)));
        }
    };
    arena_.execute(
        [&] { tbb::parallel_for(std::size_t{0}, slices.size(), [&](std::size_t i) { sort(slices[i]); }); });
}

// How fine the levels are that each slice's triangles need; those of a node in several slices, which are
// large for it, join its own level.
void Assembler::findLevels(std::vector<Slice>& slices) {
    const int coarsest = static_cast<int>(coarsestLevel(lattice_.rootCellLog2));
    const auto find = [&](std::size_t i) {
        Slice& slice = slices[i];
        const int depth = tree_[slice.node].depth;
        int& finest = tree_.finest(slice.node);
        const std::uint32_t origin = tree_.origin(slice.node);
        if (origin != Tree::kNone && !old_.hasGrown(origin)) {
            finest = old_.model().finest[origin] + static_cast<int>(old_.grownBy());
        } else if (totals_[i] <= options_.leafTriangles) {
            finest = finestLevel(format_, slice, depth);
        }
        // What the coarsest level has is not only full (Hierarchy::hasLevels()).
        if (coarsest > 0 && depth == coarsest && !tree_.isInterior(slice.node))
            finest = std::max(finest, depth);
        // Triangles that stay full until they join those below the node move otherwise than those of leaves.
        slice.group = tree_.isInterior(slice.node) && finest < depth ? kJoining : finest;
        slice.leastLevels = static_cast<unsigned>(std::max(finest + 1 - depth, 0)) + kRangeLevels;
    };
    arena_.execute([&] { tbb::parallel_for(std::size_t{0}, slices.size(), find); });
}

}  // namespace iwalk
