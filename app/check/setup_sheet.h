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

/// Where a value of a set-up comes from.
enum class SetupSource : uint8_t { file, inferred, usual, stated };

/// "from the set-up", "inferred", ...
const char* name_of(SetupSource source);

/// A tool in the set-up dialog.
struct SheetTool {
    core::ToolDescription tool;             // editable
    SetupSource source = SetupSource::file; // of all values not in `stated`
    std::string why;                        // reason for inferring it, a sentence
    std::set<std::string> stated;           // keys that the user has stated
};

/// The editable values of a set-up. To edit them, change a copy.
struct SetupSheet {
    std::string path;  // of the set-up; empty: it was inferred
    std::string frame; // frame of the stock's coordinates
    core::Solid stock; // box, cylinder, or a mesh, which can only be replaced
    SetupSource stock_source = SetupSource::file;
    std::string stock_why; // reason for inferring it, a sentence
    std::vector<SheetTool> tools;
    std::optional<double> allowance; // the general one; empty: the defaults
    SetupSource allowance_source = SetupSource::file;
    std::optional<core::ToolNumber> tool_at_start; // only if inferred
};

/// The editable values of a check after read_check.
SetupSheet sheet_of(const SetupFile& file, const core::Setup& setup, const SetupEdits& edits);

/// Adds the edits that turn `shown` into `wanted` to `made`, the edits already in `shown`.
SetupEdits edits_between(const SetupSheet& shown, const SetupSheet& wanted, SetupEdits made);

/// The sizes that can be edited for a shape, in the order of the dialog.
std::vector<core::ToolSize> fields_of(core::ToolShape shape);

/// The shapes offered in the dialog. An outline can only be given in a set-up file.
std::vector<core::ToolShape> stateable_shapes();

/// Makes the lengths of a tool editable: turns a single-cylinder shank into a shank diameter and a
/// stick-out.
core::ToolDescription editable(core::ToolDescription tool);

/// The tool with another shape: drops sizes that the shape does not have, and sets missing ones to
/// usual values.
core::ToolDescription reshaped(core::ToolDescription tool, core::ToolShape shape);

/// The name of the tool's holder in the shipped library; empty if it is not in it.
std::string holder_name(const core::ToolDescription& tool);

} // namespace app
