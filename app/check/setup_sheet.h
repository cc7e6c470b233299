#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/setup/setup_edits.h"
#include "core/base/ids.h"
#include "core/dbm/solid.h"
#include "core/sim/tool_description.h"

namespace core {
struct Setup;
}

namespace app {

struct SetupFile;

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

/// The sizes that can be edited for a shape, in the order of the dialog.
std::vector<core::ToolSize> fields_of(core::ToolShape shape);

/// The shapes that can be chosen in the dialog. An outline is stated in a set-up file only.
std::vector<core::ToolShape> stateable_shapes();

/// A tool with its lengths in the form that can be edited: one cylinder for its shank, if it has no
/// more, and the stick-out in place of what follows from it. It assembles to the same tool.
core::ToolDescription editable(core::ToolDescription tool);

/// The same tool in another shape: sizes that mean nothing for it are gone, those that it needs
/// are what such tools usually have.
core::ToolDescription reshaped(core::ToolDescription tool, core::ToolShape shape);

/// The name of a tool's holder among those that come with the program; empty if it is none of them.
std::string holder_name(const core::ToolDescription& tool);

} // namespace app
