#include "preprocess/build/page_order.hpp"

namespace iwalk {

void keepPages(Hierarchy& hierarchy, std::span<const std::uint32_t> order) {
    std::vector<PageRecord> pages;
    std::vector<std::uint32_t> places(hierarchy.pages.size(), 0);
    for (const std::uint32_t number : order) {
        places[number] = static_cast<std::uint32_t>(pages.size());
        pages.push_back(hierarchy.pages[number]);
    }
    for (LevelRecord& entry : hierarchy.entries) {
        if (entry.pageCount > 0) entry.firstPage = places[entry.firstPage];
    }
    hierarchy.pages = std::move(pages);
}

std::vector<std::uint32_t> usedPages(const Hierarchy& hierarchy) {
    std::vector<bool> used(hierarchy.pages.size(), false);
    for (const LevelRecord& entry : hierarchy.entries) {
        for (std::uint32_t i = 0; i < entry.pageCount; ++i) used[entry.firstPage + i] = true;
    }
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t page = 0; page < used.size(); ++page) {
        if (used[page]) numbers.push_back(page);
    }
    return numbers;
}

void keepFiles(std::vector<DatasetFile>& files, std::span<PageRecord> pages) {
    std::vector<bool> used(files.size(), false);
    for (const PageRecord& page : pages) {
        used[page.file] = true;
        if (page.morphBytes > 0) used[page.morphFile] = true;
    }
    std::vector<DatasetFile> kept;
    std::vector<std::uint16_t> places(files.size(), 0);
    for (std::size_t file = 0; file < files.size(); ++file) {
        places[file] = static_cast<std::uint16_t>(kept.size());
        if (used[file]) kept.push_back(files[file]);
    }
    for (PageRecord& page : pages) {
        page.file = places[page.file];
        page.morphFile = page.morphBytes > 0 ? places[page.morphFile] : std::uint16_t{0};
    }
    files = std::move(kept);
}

}  // namespace iwalk
