#pragma once

#include "app/session/prepared_check.h"

namespace app {

/// Where a part of a set-up comes from.
enum class SetupSource : uint8_t { file, inferred, usual, stated };

/// "from the set-up", "inferred", ...
const char* name_of(SetupSource source);

/// A tool as it is shown to be edited.
struct SheetTool {
    core::ToolDescription tool;             // editable
    SetupSource source = SetupSource::file; // of all that is not stated
    std::string why;                        // of what is inferred, in a sentence
    std::set<std::string> stated;           // keys that a person has stated
};

/// What of a set-up can be edited, as a person reads it. A value: to edit it is to change a copy.
struct SetupSheet {
    std::string path;  // of the set-up; empty: it was inferred
    std::string frame; // that the stock's coordinates count in
    core::Solid stock; // box, cylinder, or a mesh, which can only be replaced
    SetupSource stock_source = SetupSource::file;
    std::string stock_why; // of what is inferred, in a sentence
    std::vector<SheetTool> tools;
    std::optional<double> allowance; // the general one; empty: the usual ones
    SetupSource allowance_source = SetupSource::file;
    std::optional<core::ToolNumber> tool_at_start; // only where it was inferred
};

/// The sheet of a check that was read.
SetupSheet sheet_of(const SetupFile& file, const core::Setup& setup, const SetupEdits& edits);

/// What has to be edited so that `shown` becomes `wanted`, on top of the edits that made `shown`.
SetupEdits edits_between(const SetupSheet& shown, const SetupSheet& wanted, SetupEdits made);

} // namespace app
