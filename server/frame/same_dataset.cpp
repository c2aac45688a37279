#include "server/frame/same_dataset.hpp"

#include <xxhash.h>

#include "common/check.hpp"
#include "common/dataset/manifest.hpp"
#include "common/file.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kMarkDigits = 16;
constexpr std::uint64_t kLimit = 64u << 20;  // bytes; far more than loadManifest() takes

}  // namespace

Result<std::uint64_t> datasetMark(const std::string& dataset) {
    ASSIGN_OR_RETURN(const std::string bytes, readWholeFile(dataset + "/" + kManifestName, kLimit));
    return XXH64(bytes.data(), bytes.size(), 0);
}

std::string datasetNote(std::uint64_t mark, const std::string& dataset) {
    return fmt::format("{:016x}{}", mark, dataset);
}

Result<void> sameDataset(const std::vector<std::string>& notes, const std::vector<std::string>& hosts) {
    CHECK_OP(notes.size(), ==, hosts.size());
    const auto place = [&](std::size_t rank) {
        return fmt::format("{} on {} (rank {})", notes[rank].substr(kMarkDigits), hosts[rank], rank);
    };
    for (std::size_t rank = 1; rank < notes.size(); ++rank)
        if (notes[rank].substr(0, kMarkDigits) != notes[0].substr(0, kMarkDigits))
            return fail("{} is another dataset, or another state of it, than {}: copy one over the other",
                        place(rank), place(0));
    return {};
}

}  // namespace iwalk
