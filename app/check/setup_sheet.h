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
    SetupSource source = SetupSource::file; // of all values that are not stated
    std::string why;                        // it was inferred, as a sentence
    std::set<std::string> stated;           // keys that the user has stated
};

/// The editable values of a set-up. To edit them, change a copy.
struct SetupSheet {
    std::string path;  // of the set-up; empty: it was inferred
    std::string frame; // that the stock's coordinates count in
    core::Solid stock; // box, cylinder, or a mesh, which can only be replaced
    SetupSource stock_source = SetupSource::file;
    std::string stock_why; // it was inferred, as a sentence
    std::vector<SheetTool> tools;
    std::optional<double> allowance; // the general one; empty: the usual ones
    SetupSource allowance_source = SetupSource::file;
    std::optional<core::ToolNumber> tool_at_start; // only where it was inferred
};

/// The editable values of a check after read_check.
SetupSheet sheet_of(const SetupFile& file, const core::Setup& setup, const SetupEdits& edits);

/// The edits that turn `shown` into `wanted`, added to `made`, the edits behind `shown`.
SetupEdits edits_between(const SetupSheet& shown, const SetupSheet& wanted, SetupEdits made);

/// The sizes that can be edited for a shape, in the order of the dialog.
std::vector<core::ToolSize> fields_of(core::ToolShape shape);

/// The shapes that can be chosen in the dialog. An outline is stated in a set-up file only.
std::vector<core::ToolShape> stateable_shapes();

/// The same tool with editable lengths: a single-cylinder shank becomes a shank diameter and a
/// stick-out.
core::ToolDescription editable(core::ToolDescription tool);

/// The tool with another shape: drops sizes that the shape does not have, and sets missing ones to
/// usual values.
core::ToolDescription reshaped(core::ToolDescription tool, core::ToolShape shape);

/// The name of the tool's holder in the shipped library; empty if it is not in there.
std::string holder_name(const core::ToolDescription& tool);

} // namespace app
