#pragma once

#include <memory>

#include "preprocess/import/importer.hpp"

namespace iwalk {

enum class ForeignKind { triangles, heights };

// Models and height maps that libraries read. They do so in a program of their own, iwalk-import, under
// limits of memory and time, so that a bad file can end that program, but not this one; what it makes of the
// file goes through a temporary file that is checked like any other input. Fails where the program fails.
Result<std::unique_ptr<Importer>> openForeign(const std::string& path, ForeignKind kind,
                                              std::uint64_t fileBytes, const ImportLimits& limits);

}  // namespace iwalk
