#include "common/dataset/page_files.hpp"

namespace iwalk {

Result<PageFiles> openPageFiles(const std::string& dataset, const Manifest& manifest) {
    PageFiles files;
    for (const DatasetFile& named : manifest.pageFiles) {
        ASSIGN_OR_RETURN(std::unique_ptr<RandomAccessFile> file, openForReading(dataset + "/" + named.name));
        files.push_back(std::move(file));
    }
    return files;
}

}  // namespace iwalk
