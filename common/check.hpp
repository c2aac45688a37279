#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

namespace iwalk::detail {

[[noreturn]] inline void checkFailed(const char* file, int line, const std::string& what) {
    std::fprintf(stderr, "%s:%d: CHECK failed: %s\n", file, line, what.c_str());
    std::abort();
}

}  // namespace iwalk::detail

// Our own bugs end the process at once, saying where. Never for bad input: that is a Result.
#define CHECK(condition) \
    ((condition) ? static_cast<void>(0) : ::iwalk::detail::checkFailed(__FILE__, __LINE__, #condition))

// The same for comparisons, printing both operands: CHECK_OP(a, <=, b).
#define CHECK_OP(a, op, b)                      \
    (((a)op(b)) ? static_cast<void>(0)          \
                : ::iwalk::detail::checkFailed( \
                      __FILE__, __LINE__, fmt::format("{} {} {}: {} against {}", #a, #op, #b, (a), (b))))
