#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/setup/setup_document.h"
#include "core/base/ids.h"
#include "core/base/vec.h"

namespace app {
enum class SetupSource : uint8_t;
struct FoundTool;
struct SheetOffset;
struct StatedSetup;
} // namespace app

namespace gcode {
enum class LengthUnit : uint8_t;
}

namespace app::viewer {

struct ViewModel;

/// The text of a set-up with edits that were not saved, as found after a crash or a loss of power.
struct UnsavedSetup {
    std::string program, setup; // absolute paths; `setup` is empty for one without a file
    std::string text;
    std::string base = {};           // SHA-256 of the text that was edited
    std::filesystem::path file = {}; // that keeps it
};

/// A thing in the tree of a set-up.
struct SetupItem {
    enum class Kind : uint8_t { none, machine, offset, stock, fixture, part, tool, allowance };

    Kind kind = Kind::none;
    std::string name;        // of an offset or a fixture
    core::ToolNumber tool{}; // of a tool

    bool operator==(const SetupItem&) const = default;
};

/// A row of the tree.
struct SetupRow {
    SetupItem item; // none: a heading
    std::string title, detail;
    SetupSource source{};
    bool is_missing = false; // nothing is known about it, and it is not checked
    bool has_error = false;  // the error in the set-up is about it
};

/// What the user is asked before unsaved edits are dropped.
enum class Leaving : uint8_t { no, to_close, to_close_tab, to_open };

/// The set-up while it is edited.
///
/// Every edit changes the text of the document. The program is then checked with the new text in
/// the background. If the text cannot be read, the last good state stays on screen.
struct Workspace {
    SetupDocument document;
    std::shared_ptr<const StatedSetup> stated; // by the text of the document; never null once open
    SetupItem selected;
    std::optional<core::Error> error;   // in the text that was read last
    std::string refusal;                // why the last edit was not made; empty: it was
    std::optional<std::string> on_disk; // text in the file, changed elsewhere while there are edits
    std::vector<UnsavedSetup> found;    // edits of earlier sessions, the latest last
    // Those of which the user has said whether they are wanted.
    std::vector<UnsavedSetup> answered;
    Leaving leaving = Leaving::no;
    bool drops_edits = false;             // the user wants to leave without saving
    std::vector<std::string> leaving_for; // files to open then, with `to_open`

    // of the panel
    bool has_keys = false;      // the panel has the keyboard
    bool is_typing = false;     // a field has text that is not in the document yet
    bool commits_typed = false; // it is to be taken over in the next frame
    uint64_t replacements = 0;  // of the text by another one: undo, or a changed file
    bool wants_focus = false;   // it should get it in the next frame
    bool is_naming = false;     // the file name is asked for
    bool may_replace = false;   // the user confirmed that the named file may be replaced
    std::string file_name;      // as typed
};

/// What the next click in the view defines.
enum class PickGoal : uint8_t {
    none,
    own_face,       // of the body that is placed
    other_face,     // to which it is put
    between_first,  // the first of two faces, in the middle of which the body is put
    between_second, // and the second
    zero            // a corner, edge, face, bore or boss as the zero of a work offset
};

struct PickState;

/// Placing bodies and work offsets by pointing at them; see placing.h.
struct Placing {
    PickGoal goal = PickGoal::none;
    std::string body;   // that is placed
    std::string offset; // name of the work offset whose zero is set
    // How faces are put together: looking the same way; with their middles together.
    bool flush = false, centred = false;
    size_t turn = 0;                     // which of the candidates under the cursor is meant
    std::optional<core::Transform> drag; // moves the body on screen while it is dragged
    std::shared_ptr<PickState> picks;    // never null once picking has begun
};

/// Opens a document.
void open_document(ViewModel& model, SetupDocument document);

/// Edits the document; a refused edit is reported in `refusal`. See SetupDocument::edit. True if it
/// was made.
bool edit_setup(ViewModel& model, const std::string& title, const SetupDocument::Edit& edit,
                const std::string& mark = {});
/// Takes in the new text of the file of an unmodified document.
void take_file(ViewModel& model, std::string text);
void undo(ViewModel& model, double now);
void redo(ViewModel& model, double now);

/// The tree: machine, work offsets, stock, fixtures, part, tools, minimum clearance.
std::vector<SetupRow> rows_of_setup(const ViewModel& model);

/// The origin of a work offset: as the text states it, or else as it is assumed.
core::Vec3 origin_of(const StatedSetup& stated, const SheetOffset& offset);

/// The thing that a line of the set-up describes; none if it describes none.
SetupItem item_at_line(const Workspace& workspace, uint32_t line);

/// Writes what is assumed about a thing into the set-up as it is: a stock, a work offset, all sizes
/// of a tool.
void state_item(ViewModel& model, const SetupItem& item);

/// Whether state_item() has something to write.
bool can_state(const ViewModel& model, const SetupItem& item);

/// The size of a new block, round in the unit of the window, mm.
core::Vec3 usual_block(const ViewModel& model);
/// Adds a fixture of this name, or one like it, and selects it. `lines`: gives its shape and
/// position in a unit.
void add_fixture(ViewModel& model, const std::string& wanted_name,
                 const std::function<std::string(gcode::LengthUnit)>& lines);
/// Adds a block beside the stock as a fixture, or the mesh in a file at the origin, and selects it.
void add_box(ViewModel& model);
void add_mesh(ViewModel& model, const std::string& file);
/// Takes the mesh in a file as the stock.
void use_stock_mesh(ViewModel& model, const std::string& file);
/// Compares the result with the mesh in a file.
void add_part(ViewModel& model, const std::string& file);
/// Takes tools from a library, or the machine from a file; without a file: no longer.
void use_tool_library(ViewModel& model, const std::string& file);
void use_machine(ViewModel& model, const std::string& file);

/// States the ini file of LinuxCNC; none if `file` is empty.
void use_ini(ViewModel& model, const std::string& file);
/// Adds a tool that the set-up lacks to it, with nothing but its number.
void describe_tool(ViewModel& model, core::ToolNumber number);
/// Takes a tool of the library for a number: states what the library states.
void take_library_tool(ViewModel& model, core::ToolNumber number, FoundTool tool);
/// Adds a file to the set-up by its kind: a mesh as a fixture, a tool library, a machine. False: it
/// is none of these.
bool add_file(ViewModel& model, const std::string& file);
/// Adds an end mill under the next free number, and selects it.
void add_tool(ViewModel& model);
/// Gives the selected tool another number, if the set-up states it.
void renumber_selected(ViewModel& model, core::ToolNumber number);
/// Copies, removes or renames the selected thing, if that is possible.
void copy_selected(ViewModel& model);
void delete_selected(ViewModel& model);
void rename_selected(ViewModel& model, const std::string& name);

/// The path of a file as a set-up names it: relative if it is in the folder of the set-up or below.
std::string path_in_setup(const ViewModel& model, const std::string& file);

/// Saves the document under a path, or under its own if it is empty; without both, asks for a name.
/// True if it was saved.
bool save_document(ViewModel& model, const std::string& path, const FileWriter& write, double now);

} // namespace app::viewer
