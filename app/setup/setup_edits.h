#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/dbm/solid.h"
#include "core/sim/tool_description.h"

namespace app {

struct SetupFile;

/// A tool with changes by the user.
struct StatedTool {
    core::ToolDescription tool;
    std::set<std::string> stated; // keys of [[tool]] that the user stated; the rest is unchanged
};

/// Values that the user states in place of stated or inferred ones of a set-up.
struct SetupEdits {
    std::optional<core::Solid> stock; // box or cylinder, in the frame of the set-up's stock
    std::map<core::ToolNumber, StatedTool> tools;
    std::optional<double> allowance;
    std::optional<core::ToolNumber> tool_at_start; // if the program cuts before its first tool call

    bool empty() const { return !stock && tools.empty() && !allowance && !tool_at_start; }
};

/// An invalid field of an edit.
struct EditRefusal {
    std::optional<core::ToolNumber> tool; // empty: the stock or the allowance
    std::string key;                      // in the set-up: box, cylinder, allowance, flute_length;
                                          // empty: the tool as a whole
    std::string why;
};

/// All reasons why edits cannot be made, in the order of the fields.
std::vector<EditRefusal> refusals_of(const SetupEdits& edits);

/// Applies edits to a set-up before missing values are inferred: stated values are not inferred,
/// and inference takes them into account.
///
/// Errors: the first of refusals_of. The set-up is then unchanged.
core::Result<void> apply(const SetupEdits& edits, SetupFile& file);

/// Edits the text of a set-up file: rewrites the edited tables of the stock and of tools, and keeps
/// everything else, including comments.
///
/// Result: when read, it gives the set-up with the edits. If a table has a form that cannot be
///         replaced alone (`stock = { ... }`), the whole file is rewritten.
/// Errors: syntax; unsupported if the edit would move the frame of other bodies with the stock.
core::Result<std::string> rewritten_setup(const std::string& text, const SetupEdits& edits);

/// Whether a set-up names files by paths relative to its folder.
bool names_relative_files(const std::string& text);

} // namespace app
