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

/// A tool as a person says that it is.
struct StatedTool {
    core::ToolDescription tool;
    std::set<std::string> stated; // keys of [[tool]] that the person has said; the rest was known
};

/// What a person states in place of what a set-up says, or of what was inferred without one.
struct SetupEdits {
    std::optional<core::Solid> stock; // box or cylinder, in the frame of the set-up's stock
    std::map<core::ToolNumber, StatedTool> tools;
    std::optional<double> allowance;
    std::optional<core::ToolNumber> tool_at_start; // where the program cuts before it calls one

    bool empty() const { return !stock && tools.empty() && !allowance; }
};

/// What is wrong with a field of an edit.
struct EditRefusal {
    std::optional<core::ToolNumber> tool; // empty: it is about the stock or the allowance
    std::string key;                      // of the set-up: box, cylinder, allowance, flute_length;
                                          // empty: it is about the tool as a whole
    std::string why;
};

/// Everything that keeps edits from being made, in the order of the fields.
std::vector<EditRefusal> refusals_of(const SetupEdits& edits);

/// Puts edits into a set-up that was read or begun, before what is missing is inferred: what is
/// stated is not inferred, and all else is inferred with regard to it.
///
/// Errors: the first of refusals_of. Nothing has changed then.
core::Result<void> apply(const SetupEdits& edits, SetupFile& file);

/// The text of a set-up file with edits made in it: the tables of the stock and of tools that were
/// edited are written anew, everything else stays as somebody wrote it, comments and all.
///
/// Result: read again, it is the set-up with the edits. Where the file has its tables in a form
///         that cannot be cut out (`stock = { ... }`), all of it is written anew.
/// Errors: syntax; unsupported when the frame of other bodies would move with the stock.
core::Result<std::string> rewritten_setup(const std::string& text, const SetupEdits& edits);

/// Whether a set-up names files by paths that count from its own folder.
bool names_relative_files(const std::string& text);

} // namespace app
