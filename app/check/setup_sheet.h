#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/setup/tools/found_tool.h"
#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/dbm/solid.h"
#include "core/sim/tool_description.h"

namespace core {
struct CadNames;
struct Setup;
} // namespace core

namespace app {

struct SetupFile;

/// Where a value of a set-up comes from: the set-up states it, it is only assumed (inferred from
/// the program, or marked so in the file), or it is the usual default.
enum class SetupSource : uint8_t { stated, assumed, usual };

/// "stated", "assumed", "default".
const char* name_of(SetupSource source);

/// A tool as checked.
struct SheetTool {
    core::ToolDescription tool;
    SetupSource source = SetupSource::stated; // of all values not in `stated`
    std::string why;                          // reason for assuming it, a sentence
    std::set<std::string> stated = {};        // keys that a partly described tool states
    bool is_described = true; // else the set-up lacks it, and its motions are not checked
    bool is_guess = false;    // inferred from its use alone, as nothing but a number names it

    SetupSource source_of(const std::string& key) const {
        return stated.contains(key) ? SetupSource::stated : source;
    }
};

/// A work offset: of the set-up, or one in whose coordinates the program moves.
struct SheetOffset {
    std::string name;
    core::Vec3 origin = core::Vec3(0.0); // X, Y, Z, machine coordinates
    SetupSource source = SetupSource::stated;
    bool is_used = false; // by the program
    std::string shown;    // the name on the control: "G505" for G58 of a Siemens control
};

/// The values of a set-up as they are checked, with their sources.
struct SetupSheet {
    std::string path;  // of the set-up; empty: it was inferred
    std::string frame; // frame of the stock's coordinates
    core::Solid stock; // in the frame of the stock
    SetupSource stock_source = SetupSource::stated;
    std::string stock_why; // reason for assuming it, a sentence
    std::vector<SheetTool> tools;
    std::vector<FoundTool> library; // tools of the tool library, by number
    std::vector<SheetOffset> offsets;
    std::optional<double> allowance; // the general one; empty: the defaults
    /// Poses of the named frames relative to the stock: "machine", "stock", work offsets, fixtures.
    std::map<std::string, core::Transform> frames;
    std::shared_ptr<const core::CadNames> cad_names; // of the solids in CAD files; or null
    bool knows_fixtures = false; // it describes some, or states that there are none
    bool has_machine = false;    // it describes axes

    /// The tool or offset; null if there is none.
    const SheetTool* tool(core::ToolNumber number) const;
    const SheetOffset* offset(const std::string& name) const;
};

/// The values of a check after read_check.
SetupSheet sheet_of(const SetupFile& file, const core::Setup& setup);

/// The sizes that a shape has, in the order of the panel.
std::vector<core::ToolSize> fields_of(core::ToolShape shape);

/// The shapes that can be chosen. An outline can only be given in a set-up file.
std::vector<core::ToolShape> stateable_shapes();

/// Makes the lengths of a tool editable: turns a single-cylinder shank into a shank diameter and a
/// stick-out.
core::ToolDescription editable(core::ToolDescription tool);

/// The tool with another shape: drops sizes that the shape does not have, and sets missing ones to
/// usual values.
core::ToolDescription reshaped(core::ToolDescription tool, core::ToolShape shape);

/// The name of the preset that the tool's holder is; empty if it is none.
std::string holder_name(const core::ToolDescription& tool);

} // namespace app
