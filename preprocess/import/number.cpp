// William Clinger, "How to read floating point numbers accurately", 1990: a product or quotient of two exact
// doubles is correctly rounded, which does for nearly all numbers in files; the library does the rest.
#include "preprocess/import/number.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

namespace iwalk {
namespace {

constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                              1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::uint64_t kExact = std::uint64_t{1} << 53;  // integers up to it are doubles
constexpr int kMaxDigits = 18;                            // that many always fit in 64 bits

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

// Adds digits to `mantissa`; returns the character behind them.
const char* takeDigits(const char* p, std::uint64_t& mantissa) {
    for (; isDigit(*p); ++p) mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p - '0');
    return p;
}

// The end of "#QNAN" and its kin, or null.
const char* skipOldSpecial(const char* p) {
    for (const std::string_view name : {"#QNAN", "#SNAN", "#IND", "#INF"}) {
        if (std::strncmp(p, name.data(), name.size()) != 0) continue;
        p += name.size();
        while (isDigit(*p)) ++p;
        return p;
    }
    return nullptr;
}

const char* endOfWord(const char* p) {
    while (*p != '\0' && *p != '\n' && *p != ' ' && *p != '\t' && *p != '\r' && *p != '/') ++p;
    return p;
}

// For long mantissas, large exponents and words. `text` is behind the sign.
const char* parseSlowly(const char* text, double& value) {
    const auto [end, status] = std::from_chars(text, endOfWord(text), value);
    if (status == std::errc::invalid_argument) return nullptr;
    if (status == std::errc::result_out_of_range) {
        // The library leaves the value alone: a negative exponent, or no digit before the point, means too
        // small.
        const std::string_view number(text, static_cast<std::size_t>(end - text));
        const std::size_t exponent = number.find_first_of("eE");
        const bool small = exponent != number.npos ? number.substr(exponent + 1, 1) == "-"
                                                   : number.starts_with('0') || number.starts_with('.');
        value = small ? 0 : std::numeric_limits<double>::infinity();
    }
    return end;
}

const char* parseUnsigned(const char* text, double& value) {
    std::uint64_t mantissa = 0;
    const char* p = takeDigits(text, mantissa);
    std::int64_t digits = p - text, exponent = 0;
    if (*p == '.') {
        const char* const fraction = p + 1;
        p = takeDigits(fraction, mantissa);
        exponent = fraction - p;
        digits += p - fraction;
    }
    if (digits == 0 || digits > kMaxDigits || mantissa > kExact) return parseSlowly(text, value);
    if (*p == 'e' || *p == 'E') {
        const char* q = p + 1;
        const bool negative = *q == '-';
        if (*q == '-' || *q == '+') ++q;
        std::uint64_t power = 0;
        const char* const end = takeDigits(q, power);
        if (end == q || end - q > 4) return parseSlowly(text, value);
        exponent += negative ? -static_cast<std::int64_t>(power) : static_cast<std::int64_t>(power);
        p = end;
    }
    if (exponent < -22 || exponent > 22) return parseSlowly(text, value);
    value = static_cast<double>(mantissa);
    value = exponent < 0 ? value / kPowers[-exponent] : value * kPowers[exponent];
    return p;
}

}  // namespace

const char* parseNumber(const char* text, double& value) {
    const bool negative = *text == '-';
    if (*text == '-' || *text == '+') ++text;
    if (*text == '-' || *text == '+') return nullptr;
    const char* end = parseUnsigned(text, value);
    if (!end) return nullptr;
    if (*end == '#') {
        if (const char* const behind = skipOldSpecial(end)) {
            value = std::numeric_limits<double>::quiet_NaN();
            end = behind;
        }
    }
    if (negative) value = -value;
    return end;
}

}  // namespace iwalk
