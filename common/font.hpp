#pragma once

#include <string_view>

namespace iwalk {

// Letters of 5 x 7 pixels for pictures that machines make: digits, capital letters (small ones look like
// them) and some signs; whatever else is a filled box. A blank pixel follows each.
inline constexpr int kLetterWidth = 5, kLetterHeight = 7, kLetterStep = kLetterWidth + 1;

// Whether the pixel in `column`, `row` (from the top left) belongs to the letter.
bool letterPixel(char letter, int column, int row);

inline int textWidth(std::string_view text) {  // px at scale 1
    return kLetterStep * static_cast<int>(text.size()) - 1;
}

}  // namespace iwalk
