#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/sim/verdict.h"

namespace core {
struct Finding;
}

namespace app {

/// How much is known about a thing that a verdict rests on: it is described by the set-up or the
/// program, it was inferred, or nothing is known and it was not checked.
enum class Known : uint8_t { missing, inferred, described };

inline constexpr std::array all_known = {Known::missing, Known::inferred, Known::described};

const char* name_of(Known known);

/// What a check rests on. A program is headlined as clear only if all of it is described.
struct Coverage {
    Known stock = Known::missing;
    Known holders = Known::described; // of the tools that feed
    Known fixtures = Known::missing;  // described: some, or stated to be none
    Known offsets = Known::inferred;  // the work offsets under which the program feeds
    Known limits = Known::missing;    // of all linear axes
    Known start = Known::described;   // the start position, or no verdict rests on it
    Known tools = Known::described;   // diameter, flutes and stick-out of those that move
    std::vector<core::ToolNumber> tools_without_holder; // that feed; in ascending order
    // Tools of which one of these sizes is a guess; at the end of a run, those that move.
    std::vector<core::ToolNumber> tools_assumed;
    bool moves = false;               // some block moves
    bool limits_need_offsets = false; // the limits are described, but not where the work is
    bool stock_is_elsewhere = false;  // than some or all of the cuts; then it counts as inferred

    bool is_complete() const;
    bool operator==(const Coverage&) const = default;
};

/// Counts the tools that feed, for their holders, and those that move at all, for their sizes.
void count_tools(const std::set<core::ToolNumber>& feeding,
                 const std::set<core::ToolNumber>& moving,
                 const std::function<bool(core::ToolNumber)>& has_holder, Coverage& coverage);

/// Takes from a coverage what the findings of the run show to be missing: a start position that
/// nothing states, work beside the stock or above it, or any motion.
void reduce_by(const std::vector<core::Finding>& findings, Coverage& coverage);

/// One item of a coverage: its key in JSON, its name in a sentence, and what is known.
struct CoverageItem {
    const char* key;
    const char* name;
    Known known;
};

/// The items in the order in which reports list them.
std::array<CoverageItem, 7> items_of(const Coverage& coverage);

/// What was not described, for a sentence: "fixtures, axis limits, holders of T1, T2: not
/// described; stock: assumed". Empty if all of it is.
std::string uncovered_text(const Coverage& coverage);

/// What a headline depends on besides the coverage.
struct Judged {
    core::Verdict verdict = core::Verdict::clear;
    bool is_stopped = false;     // before the end of the program
    bool has_errors = false;     // other than `incomplete-setup`
    bool lacks_required = false; // `incomplete-setup` is an error: coverage that is required
};

/// The verdict on a program in words, in capitals, that says no more than was checked: "CLEAR" only
/// if the coverage is complete.
std::string headline_of(const Judged& judged, const Coverage& coverage);

/// What a check can be required to have, as words of the option and the key `require`.
inline constexpr std::array<std::string_view, 1> required_words = {"coverage"};

} // namespace app
