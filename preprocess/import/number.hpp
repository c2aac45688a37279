#pragma once

namespace iwalk {

// Reads a decimal number at `text`, correctly rounded: sign, digits, fraction, exponent, as well as nan, inf
// and what old C libraries print for them (1.#QNAN, 1.#INF: both read as NaN). Too large is infinite, too
// small 0. Returns the character behind it, or null when there is no number. A character that no number holds
// ('\n', '\0') must follow.
const char* parseNumber(const char* text, double& value);

}  // namespace iwalk
