#pragma once

#include <string>
#include <vector>

namespace test_support {

/// An NC program whose head loads tool 1, starts the spindle and moves to Z60 above X0 Y0; `lines`
/// follow from line `first_line` on.
inline constexpr int first_line = 6;

inline std::string program(const std::vector<std::string>& lines,
                           const std::string& spindle = "S6000 M3") {
    std::string text = "O1000\nG21 G90 G17 G54\nT1 M6\n" + spindle + "\nG0 G43 H1 Z60.\n";
    for (const std::string& line : lines) text += line + "\n";
    return text + "M30\n";
}

} // namespace test_support
