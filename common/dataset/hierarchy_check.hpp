#pragma once

#include <fmt/format.h>

#include <string>

#include "common/dataset/hierarchy.hpp"

// Inside common/dataset only.
namespace iwalk {

inline constexpr std::size_t kHierarchyHeaderBytes = 72;
inline constexpr const char* kHierarchyDamaged =
    "the hierarchy is damaged: copy the dataset again or rebuild it";

// Says where in which file something is wrong with a record.
class RecordErrors {
  public:
    RecordErrors(std::string path, const Hierarchy& hierarchy)
        : path_(std::move(path)), hierarchy_(hierarchy) {}

    template <class... Args>
    Error file(fmt::format_string<Args...> format, Args&&... args) const {
        return fail("{}: {}; {}", path_, fmt::format(format, std::forward<Args>(args)...), kHierarchyDamaged);
    }
    template <class... Args>
    Error node(std::size_t n, fmt::format_string<Args...> format, Args&&... args) const {
        const std::size_t place = kHierarchyHeaderBytes + n * sizeof(NodeRecord);
        return file("node {} at byte {}: {}", n, place, fmt::format(format, std::forward<Args>(args)...));
    }
    template <class... Args>
    Error entry(std::size_t e, fmt::format_string<Args...> format, Args&&... args) const {
        const std::size_t place =
            kHierarchyHeaderBytes + hierarchy_.nodes.size() * sizeof(NodeRecord) + e * sizeof(LevelRecord);
        return file("level record {} at byte {}: {}", e, place,
                    fmt::format(format, std::forward<Args>(args)...));
    }
    template <class... Args>
    Error page(std::size_t p, fmt::format_string<Args...> format, Args&&... args) const {
        const std::size_t place = kHierarchyHeaderBytes + hierarchy_.nodes.size() * sizeof(NodeRecord) +
                                  hierarchy_.entries.size() * sizeof(LevelRecord) + p * sizeof(PageRecord);
        return file("page record {} at byte {}: {}", p, place,
                    fmt::format(format, std::forward<Args>(args)...));
    }

  private:
    std::string path_;
    const Hierarchy& hierarchy_;
};

// Level records against their nodes and pages: the levels of each node, and that every range of every page
// belongs to exactly one entry. The nodes' runs of entries and the page records have been checked.
Result<void> checkEntries(const RecordErrors& errors, const Hierarchy& hierarchy);

// Whether a hierarchy agrees with itself and with its manifest, as loadHierarchy() promises. `path` is for
// messages.
Result<void> checkHierarchy(const std::string& path, const Hierarchy& hierarchy, const Manifest& manifest);

}  // namespace iwalk
