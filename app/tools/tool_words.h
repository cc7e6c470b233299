#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/sim/tool_description.h"

namespace app {

/// A number in a text with what stands right before and behind it.
struct TextNumber {
    std::string prefix; // letters without a blank between, or the word before with = or :
    double value = 0.0;
    bool fraction = false;
    bool has_point = false; // or is a fraction
    std::string suffix;     // letters, a degree or inch sign, or the word that follows
    bool glued = false;     // the suffix has no blank before it
};

/// The text in capitals, with the signs for degree, diameter and inch as words.
std::string plain_capitals(std::string_view text);

/// All numbers of a text in capitals, "1/2" and "1-1/2" as one. Numbers within words such as
/// catalogue numbers are left out.
std::vector<TextNumber> numbers_of(const std::string& capitals);

/// What kind of tool the words of a text in capitals name.
std::optional<core::ToolShape> shape_of_words(const std::string& capitals);

/// Whether a text in capitals names what cuts nothing, as a probe.
bool names_no_cutter(const std::string& capitals);

/// Whether a text in capitals is a part of a sentence, where sizes may be those of anything.
bool is_prose(const std::string& capitals);

/// Whether a size stands right before a word for a tool: "10MM BALL", "1/2 END MILL".
bool names_sized_tool(const std::string& capitals);

size_t words_in(const std::string& text);

/// The diameter of a drill by its number, 1 to 60, in inches.
std::optional<double> numbered_drill(int number);

} // namespace app
