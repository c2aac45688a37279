#include "common/token.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cstddef>

#include "common/file.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kFewest = 16, kMost = 256;  // characters

}  // namespace

Result<std::string> readToken(const std::string& path) {
    ASSIGN_OR_RETURN(std::string token, readWholeFile(path, 2 * kMost));
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && (status.st_mode & S_IROTH) != 0)
        return fail("{}: everybody may read this token: chmod o-r {}", path, path);
    if (token.ends_with('\n')) token.pop_back();
    const bool printable =
        std::all_of(token.begin(), token.end(), [](char c) { return c > ' ' && c < 0x7f; });
    if (!printable || token.size() < kFewest || token.size() > kMost)
        return fail(
            "{}: not a token: one line of {} to {} printable characters, as from: head -c 24 /dev/urandom | "
            "base64",
            path, kFewest, kMost);
    return token;
}

bool sameToken(std::string_view mine, std::string_view theirs) {
    volatile unsigned different = mine.size() == theirs.size() ? 0 : 1;
    for (std::size_t i = 0; i < theirs.size(); ++i) {
        const char ours = mine.empty() ? '\0' : mine[i % mine.size()];
        different = different | static_cast<unsigned>(static_cast<unsigned char>(ours ^ theirs[i]));
    }
    return different == 0;
}

}  // namespace iwalk
