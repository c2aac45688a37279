#pragma once

#include <string>
#include <string_view>

#include "common/result.hpp"

namespace iwalk {

// The secret that client and server share where others can reach the server: the only line of a file that not
// everybody may read, 16 to 256 printable characters without spaces. Never on a command line, which everybody
// sees.
Result<std::string> readToken(const std::string& path);

// Takes as long wherever the two differ.
bool sameToken(std::string_view mine, std::string_view theirs);

}  // namespace iwalk
