#include "app/view/model/workspace.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/check/setup_sheet.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_length.h"
#include "app/setup/setup_text.h"
#include "app/setup/stated_setup.h"
#include "app/setup/tools/found_tool.h"
#include "app/view/model/file_watch.h"
#include "app/view/model/placing.h"
#include "app/view/model/samples.h"
#include "app/view/model/view_model.h"
#include "core/base/file_reads.h"
#include "core/dbm/solid.h"
#include "gcode/language/modal_state.h"

namespace app::viewer {
namespace {

using Kind = SetupItem::Kind;

SetupItem item(Kind kind, std::string name = {}, core::ToolNumber tool = {}) {
    return {kind, std::move(name), tool};
}

std::string size_text(const ViewModel& model, const core::Vec3& size) {
    return fmt::format("{} x {} x {} {}", length_text(model, size.x), length_text(model, size.y),
                       length_text(model, size.z), length_unit(model));
}

std::string shape_text(const ViewModel& model, const StatedBody& body) {
    if (body.box) return size_text(model, body.box->size());
    if (body.cylinder)
        return fmt::format("D{} x {} {}", length_text(model, 2.0 * body.cylinder->radius),
                           length_text(model, body.cylinder->height), length_unit(model));
    if (!body.preset.empty()) return body.preset;
    const std::string& file = body.mesh.empty() ? body.model : body.mesh;
    return std::filesystem::path(file).filename().generic_string();
}

std::string solid_text(const ViewModel& model, const core::Solid& stock) {
    if (const auto* round = std::get_if<core::SolidCylinder>(&stock.shape))
        return fmt::format("D{} x {} {}", length_text(model, 2.0 * round->radius),
                           length_text(model, round->height), length_unit(model));
    return size_text(model, core::bounds(stock).size());
}

SetupRow heading_row(std::string title) { return {.item = {}, .title = std::move(title)}; }

void add_machine_rows(const Workspace& workspace, const SetupSheet& sheet,
                      std::vector<SetupRow>& rows) {
    const std::string &file = workspace.stated->machine_file, &ini = workspace.stated->ini;
    const bool is_stated = sheet.has_machine || !ini.empty();
    SetupRow row{item(Kind::machine), "Machine", "not described",
                 is_stated ? SetupSource::stated : SetupSource::usual};
    row.is_missing = !is_stated;
    if (sheet.has_machine) row.detail = "in the set-up";
    if (const std::string& shown = file.empty() ? ini : file; !shown.empty())
        row.detail = std::filesystem::path(shown).filename().generic_string();
    if (!workspace.stated->machine_preset.empty()) row.detail = workspace.stated->machine_preset;
    rows.push_back(std::move(row));
}

void add_offset_rows(const ViewModel& model, const SetupSheet& sheet, std::vector<SetupRow>& rows) {
    rows.push_back(heading_row("Work offsets"));
    for (const SheetOffset& offset : sheet.offsets) {
        const core::Vec3 origin = origin_of(*model.workspace.stated, offset);
        rows.push_back({item(Kind::offset, offset.name), offset.shown,
                        fmt::format("{}, {}, {}", length_text(model, origin.x),
                                    length_text(model, origin.y), length_text(model, origin.z)),
                        offset.source});
    }
}

void add_fixture_rows(const ViewModel& model, const SetupSheet& sheet,
                      std::vector<SetupRow>& rows) {
    const StatedSetup& stated = *model.workspace.stated;
    SetupRow head = heading_row("Fixtures");
    if (stated.fixtures.empty()) {
        head.detail = stated.has_no_fixtures ? "none" : "not described";
        head.is_missing = !sheet.knows_fixtures;
    }
    rows.push_back(std::move(head));
    for (const StatedBody& body : stated.fixtures)
        rows.push_back({item(Kind::fixture, body.name), body.name, shape_text(model, body)});
}

void add_tool_rows(const ViewModel& model, const SetupSheet& sheet, std::vector<SetupRow>& rows) {
    rows.push_back(heading_row("Tools"));
    for (const SheetTool& tool : sheet.tools) {
        const core::ToolNumber number = tool.tool.number;
        if (!tool.is_described) {
            rows.push_back({item(Kind::tool, {}, number),
                            fmt::format("T{}", core::value_of(number)), "not described",
                            tool.source, true});
            continue;
        }
        SetupRow row{item(Kind::tool, {}, number),
                     fmt::format("T{}  {} {}", core::value_of(number),
                                 core::name_of(tool.tool.shape),
                                 length_text(model, tool.tool.diameter)),
                     holder_name(tool.tool), tool.source};
        if (tool.tool.holder.empty()) row.detail = "no holder";
        if (row.detail.empty()) row.detail = "holder";
        rows.push_back(std::move(row));
    }
}

void take_in_text(Workspace& workspace) {
    const std::string& text = workspace.document.text();
    // A text with an error says nothing: the rows stay as they were.
    if (!workspace.stated || parsed_toml(text))
        workspace.stated = std::make_shared<const StatedSetup>(stated_in(text));
    workspace.refusal.clear();
}

/// Selects nothing if the selected thing is gone.
void keep_selection(Workspace& workspace) {
    const SetupItem& selected = workspace.selected;
    if (selected.kind == Kind::fixture && !workspace.stated->fixture(selected.name))
        workspace.selected = {};
}

void step_back_or_forth(ViewModel& model, bool back, double now) {
    SetupDocument& document = model.workspace.document;
    const std::string title = back ? document.undo_title() : document.redo_title();
    if (title.empty()) return say(model, back ? "Nothing to undo" : "Nothing to redo", now);
    if (back)
        document.undo();
    else
        document.redo();
    ++model.workspace.replacements;
    take_in_text(model.workspace);
    keep_selection(model.workspace);
    say(model, (back ? "Undone: " : "Redone: ") + title, now);
}

core::Result<std::string> stated_offset(const std::string& text, const StatedSetup& stated,
                                        const SheetOffset& offset) {
    return stated.has_offset(offset.name) ? with_known(text, "offsets")
                                          : with_offset(text, offset.shown, offset.origin);
}

} // namespace

core::Vec3 origin_of(const StatedSetup& stated, const SheetOffset& offset) {
    const auto found = stated.origins.find(offset.name);
    return found == stated.origins.end() ? offset.origin : found->second;
}

void open_document(ViewModel& model, SetupDocument document) {
    model.workspace = {};
    model.workspace.document = std::move(document);
    take_in_text(model.workspace);
}

namespace {

/// Names beside the first tool that a set-up describes the others that the program uses and that
/// nothing describes. A set-up that describes a job is not completed by tools that it does not
/// name: their motions would not be checked any more.
core::Result<std::string> with_guessed_tools(const ViewModel& model, const std::string& before,
                                             std::string text) {
    const SetupSheet* sheet = sheet_of(model);
    const auto has_tools = [](const std::string& setup) {
        const StatedSetup stated = stated_in(setup);
        return !stated.tools.empty() || !stated.tool_library.empty();
    };
    if (!sheet || has_tools(before) || !has_tools(text)) return text;
    for (const SheetTool& shown : sheet->tools) {
        const core::ToolNumber number = shown.tool.number;
        if (!shown.is_guess) continue;
        FEELER_TRY(text, with_bare_tool(text, number));
    }
    return text;
}

} // namespace

bool edit_setup(ViewModel& model, const std::string& title, const SetupDocument::Edit& edit,
                const std::string& mark) {
    Workspace& workspace = model.workspace;
    // The first statement in a set-up for a program in inches is their unit.
    const bool is_inch = model.program && model.program->is_inch;
    const auto unit = is_inch ? gcode::LengthUnit::inch : gcode::LengthUnit::mm;
    const auto edited = workspace.document.edit(
        title,
        [&](const std::string& text) -> core::Result<std::string> {
            const std::string begun = begun_in(text, unit);
            FEELER_TRY(std::string changed, edit(begun));
            return changed == begun ? text : with_guessed_tools(model, begun, std::move(changed));
        },
        mark);
    if (!edited) {
        const bool is_damaged = !parsed_toml(workspace.document.text());
        workspace.refusal = is_damaged ? "Correct the set-up file first: " : "";
        workspace.refusal += edited.error().message;
        return false;
    }
    take_in_text(workspace);
    return true;
}

void take_file(ViewModel& model, std::string text) {
    model.workspace.document.file_changed(std::move(text));
    ++model.workspace.replacements;
    take_in_text(model.workspace);
    keep_selection(model.workspace);
}

void undo(ViewModel& model, double now) { step_back_or_forth(model, true, now); }

void redo(ViewModel& model, double now) { step_back_or_forth(model, false, now); }

std::vector<SetupRow> rows_of_setup(const ViewModel& model) {
    const Workspace& workspace = model.workspace;
    const SetupSheet* sheet = sheet_of(model);
    if (!sheet || !workspace.stated) return {};
    std::vector<SetupRow> rows;
    add_machine_rows(workspace, *sheet, rows);
    add_offset_rows(model, *sheet, rows);
    const auto& stock = workspace.stated->stock;
    rows.push_back(
        {item(Kind::stock), "Stock",
         stock && stock->has_shape() ? shape_text(model, *stock) : solid_text(model, sheet->stock),
         sheet->stock_source});
    add_fixture_rows(model, *sheet, rows);
    if (workspace.stated->part)
        rows.push_back({item(Kind::part), "Part", shape_text(model, *workspace.stated->part)});
    add_tool_rows(model, *sheet, rows);
    rows.push_back(
        {item(Kind::allowance), "Minimum clearance",
         sheet->allowance ? length_text(model, *sheet->allowance) + " " + length_unit(model) : "",
         sheet->allowance ? SetupSource::stated : SetupSource::usual});
    if (workspace.error && workspace.error->where.line > 0) {
        const SetupItem wrong = item_at_line(workspace, workspace.error->where.line);
        for (SetupRow& row : rows) row.has_error = wrong.kind != Kind::none && row.item == wrong;
    }
    return rows;
}

SetupItem item_at_line(const Workspace& workspace, uint32_t line) {
    const std::string& text = workspace.document.text();
    SetupItem found;
    uint32_t best = 0;
    const auto offer = [&](uint32_t first, const SetupItem& item) {
        if (first <= line && first > best) {
            best = first;
            found = item;
        }
    };
    const StatedSetup& stated = *workspace.stated;
    if (stated.stock) offer(stated.stock->line, item(Kind::stock));
    if (stated.part) offer(stated.part->line, item(Kind::part));
    for (const StatedBody& body : stated.fixtures) offer(body.line, item(Kind::fixture, body.name));
    for (const core::ToolNumber number : stated.tools)
        if (const auto path = path_of_tool(text, number))
            offer(toml_span(text, *path).line, item(Kind::tool, {}, number));
    for (const std::string& name : stated.offsets)
        offer(toml_span(text, path_of_offset(text, name)).line, item(Kind::offset, name));
    for (const char* other : {"program", "machine", "control", "rules", "allowance"})
        offer(toml_span(text, other).line,
              std::string_view(other) == "machine" ? item(Kind::machine) : SetupItem{});
    return found;
}

bool can_state(const ViewModel& model, const SetupItem& item) {
    const SetupSheet* sheet = sheet_of(model);
    if (!sheet) return false;
    if (item.kind == Kind::stock)
        return sheet->stock_source == SetupSource::assumed
               && !std::holds_alternative<core::SolidMesh>(sheet->stock.shape);
    if (item.kind == Kind::offset) {
        const SheetOffset* offset = sheet->offset(item.name);
        return offset && offset->source == SetupSource::assumed;
    }
    if (item.kind != Kind::tool) return false;
    const SheetTool* tool = sheet->tool(item.tool);
    return tool && tool->is_described && tool->source == SetupSource::assumed;
}

void describe_tool(ViewModel& model, core::ToolNumber number) {
    edit_setup(model, fmt::format("Describe T{}", core::value_of(number)),
               [&](const std::string& text) { return with_bare_tool(text, number); });
}

void state_item(ViewModel& model, const SetupItem& item) {
    const SetupSheet* sheet = sheet_of(model);
    if (!sheet || !can_state(model, item)) return;
    const StatedSetup stated = *model.workspace.stated;
    if (item.kind == Kind::stock) {
        const bool has_shape = stated.stock && stated.stock->has_shape();
        edit_setup(model, "State the stock", [&](const std::string& text) {
            return has_shape ? with_known(text, "stock")
                             : with_stock(text, sheet->stock, sheet->frame);
        });
    } else if (item.kind == Kind::offset) {
        const SheetOffset offset = *sheet->offset(item.name);
        edit_setup(model, "State " + offset.name,
                   [&](const std::string& text) { return stated_offset(text, stated, offset); });
    } else {
        const SheetTool& tool = *sheet->tool(item.tool);
        edit_setup(model, fmt::format("State T{}", core::value_of(item.tool)),
                   [&](const std::string& text) { return with_tool(text, tool.tool); });
    }
}

core::Vec3 usual_block(const ViewModel& model) {
    return model.settings.inch ? core::Vec3(50.8, 25.4, 25.4) : core::Vec3(50.0, 25.0, 25.0);
}

namespace {

/// Selects what was added; its row gets the keyboard, which an older row may have.
void select_for_keys(Workspace& workspace, SetupItem added) {
    workspace.selected = std::move(added);
    workspace.wants_focus = true;
}

} // namespace

void add_fixture(ViewModel& model, const std::string& wanted_name,
                 const std::function<std::string(gcode::LengthUnit)>& lines) {
    const std::string name = free_name(model.workspace.document.text(), wanted_name);
    if (edit_setup(model, "Add " + name, [&](const std::string& text) {
            return with_fixture(text, name, lines(unit_of_setup(text)));
        }))
        select_for_keys(model.workspace, item(Kind::fixture, name));
}

void add_box(ViewModel& model) {
    const SetupSheet* sheet = sheet_of(model);
    if (!sheet) return;
    const core::Vec3 size = usual_block(model);
    const core::Aabb stock = core::bounds(sheet->stock);
    const core::Vec3 at(stock.min.x - size.x, stock.min.y, stock.min.z);
    add_fixture(model, "block-1", [&](gcode::LengthUnit unit) {
        return fmt::format("box = [[0, 0, 0], {}]\nat = {}\nframe = {}\n", setup_point(size, unit),
                           setup_point(at, unit), toml_text(sheet->frame));
    });
}

void add_mesh(ViewModel& model, const std::string& file) {
    const std::string name = std::filesystem::path(file).stem().generic_string();
    const SetupSheet* sheet = sheet_of(model);
    const std::string path = path_in_setup(model, file);
    add_fixture(model, name.empty() ? "mesh" : name, [&](gcode::LengthUnit) {
        return fmt::format("mesh = {}\nat = [0, 0, 0]\nframe = {}\n", toml_text(path),
                           toml_text(sheet ? sheet->frame : "G54"));
    });
}

void use_stock_mesh(ViewModel& model, const std::string& file) {
    const SetupSheet* sheet = sheet_of(model);
    const std::string path = path_in_setup(model, file);
    const bool is_new = !model.workspace.stated->stock;
    if (!edit_setup(
            model, "Change the stock", [&](const std::string& text) -> core::Result<std::string> {
                FEELER_TRY(std::string with, with_mesh(text, "stock", path));
                if (is_new && sheet) {
                    FEELER_TRY(with,
                               toml_with_value(with, {"stock", "frame"}, toml_text(sheet->frame)));
                }
                return with_known(with, "stock");
            }))
        return;
    model.workspace.selected = item(Kind::stock);
}

void add_part(ViewModel& model, const std::string& file) {
    const SetupSheet* sheet = sheet_of(model);
    const std::string path = path_in_setup(model, file);
    const bool is_new = !model.workspace.stated->part;
    if (edit_setup(model, "Set the part",
                   [&](const std::string& text) -> core::Result<std::string> {
                       FEELER_TRY(const std::string with, with_mesh(text, "part", path));
                       return is_new ? toml_with_value(with, {"part", "frame"},
                                                       toml_text(sheet ? sheet->frame : "G54"))
                                     : core::Result<std::string>(with);
                   }))
        model.workspace.selected = item(Kind::part);
}

void use_tool_library(ViewModel& model, const std::string& file) {
    const std::string path = path_in_setup(model, file);
    edit_setup(model, "Open a tool library", [&](const std::string& text) {
        return file.empty() ? toml_without(text, "tool_library")
                            : toml_with_value(text, "tool_library", toml_text(path));
    });
}

void use_machine(ViewModel& model, const std::string& file) {
    const std::string path = path_in_setup(model, file);
    if (edit_setup(model, "Change the machine", [&](const std::string& text) {
            return with_machine_file(text, file.empty() ? std::string() : path);
        }))
        model.workspace.selected = item(Kind::machine);
}

void use_ini(ViewModel& model, const std::string& file) {
    const std::string path = path_in_setup(model, file);
    if (edit_setup(model, "Change the ini file", [&](const std::string& text) {
            return file.empty() ? toml_without(text, {"program", "ini"})
                                : toml_with_value(text, {"program", "ini"}, toml_text(path));
        }))
        model.workspace.selected = item(Kind::machine);
}

void take_library_tool(ViewModel& model, core::ToolNumber number, FoundTool tool) {
    tool.tool.number = number;
    edit_setup(model, fmt::format("Exchange T{}", core::value_of(number)),
               [&](const std::string& text) { return with_found_tool(text, tool); });
}

bool add_file(ViewModel& model, const std::string& file) {
    if (!model.workspace.stated) return false;
    if (is_mesh_file(file))
        add_mesh(model, file);
    else if (is_tool_library(file))
        use_tool_library(model, file);
    else if (is_machine_file(file))
        use_machine(model, file);
    else if (is_ini_file(file))
        use_ini(model, file);
    else if (is_cam_job(file) || is_offset_file(file))
        model.job_file = file;
    else
        return false;
    return true;
}

namespace {

/// The number after those of all tools of the program and the set-up.
core::ToolNumber next_tool_number(const ViewModel& model) {
    int last = 0;
    for (const core::ToolNumber number : model.workspace.stated->tools)
        last = std::max(last, core::value_of(number));
    if (const SetupSheet* sheet = sheet_of(model))
        for (const SheetTool& tool : sheet->tools)
            last = std::max(last, core::value_of(tool.tool.number));
    return core::ToolNumber{last + 1};
}

void copy_tool(ViewModel& model, core::ToolNumber number) {
    const core::ToolNumber copy = next_tool_number(model);
    const SetupSheet* const sheet = sheet_of(model);
    const SheetTool* const shown = sheet ? sheet->tool(number) : nullptr;
    const auto edit = [&](const std::string& text) -> core::Result<std::string> {
        if (model.workspace.stated->has_tool(number)) return with_copied_tool(text, number, copy);
        if (!shown || !shown->is_described) return text;
        core::ToolDescription tool = shown->tool;
        tool.number = copy;
        return with_tool(text, tool);
    };
    if (edit_setup(model, fmt::format("Copy T{}", core::value_of(number)), edit))
        model.workspace.selected = item(Kind::tool, {}, copy);
}

} // namespace

void add_tool(ViewModel& model) {
    FoundTool mill;
    mill.tool.number = next_tool_number(model);
    mill.tool.diameter = model.settings.inch ? 12.7 : 10.0;
    mill.has_shape = true;
    const core::ToolDescription tool = complete(mill).tool;
    if (edit_setup(model, fmt::format("Add T{}", core::value_of(tool.number)),
                   [&](const std::string& text) { return with_tool(text, tool); }))
        model.workspace.selected = item(Kind::tool, {}, tool.number);
}

void renumber_selected(ViewModel& model, core::ToolNumber number) {
    const SetupItem selected = model.workspace.selected;
    if (selected.kind != Kind::tool || selected.tool == number) return;
    if (edit_setup(
            model, fmt::format("Renumber T{}", core::value_of(selected.tool)),
            [&](const std::string& text) { return with_tool_number(text, selected.tool, number); }))
        model.workspace.selected.tool = number;
}

void copy_selected(ViewModel& model) {
    const SetupItem selected = model.workspace.selected;
    if (selected.kind == Kind::tool) return copy_tool(model, selected.tool);
    if (selected.kind != Kind::fixture) return;
    const std::string copy = free_name(model.workspace.document.text(), selected.name);
    const StatedBody* const body = model.workspace.stated->fixture(selected.name);
    if (!body) return;
    // Beside the original, so that it can be seen and picked.
    const core::Aabb box = bounds_of_body(model, selected.name);
    const double step = usual_block(model).y;
    const double shift = box.empty() ? step : step * std::ceil(box.size().x / step);
    const core::Vec3 at = body->at + core::Vec3(shift, 0.0, 0.0), turn = body->rotate_deg;
    if (!edit_setup(model, "Copy " + selected.name,
                    [&](const std::string& text) -> core::Result<std::string> {
                        FEELER_TRY(const std::string copied,
                                   with_copied_fixture(text, selected.name, copy));
                        return with_pose(copied, *path_of_fixture(copied, copy), at, turn);
                    }))
        return;
    model.workspace.selected = item(Kind::fixture, copy);
    model.workspace.wants_focus = true;
}

namespace {

/// Deletes a fixture with all that stands on it: the jaws of a vise go with the vise.
void delete_fixture(ViewModel& model, const std::string& name) {
    std::vector<std::string> gone = moved_with(model, name);
    std::reverse(gone.begin(), gone.end()); // those in the frame of another one first
    std::string title = "Delete " + name;
    if (gone.size() > 1)
        title +=
            fmt::format(" and {} that stand{} on it", gone.size() - 1, gone.size() == 2 ? "s" : "");
    edit_setup(model, title, [&](const std::string& before) {
        core::Result<std::string> text = before;
        for (const std::string& each : gone)
            if (text) text = without_fixture(*text, each);
        return text;
    });
}

} // namespace

void delete_selected(ViewModel& model) {
    const SetupItem selected = model.workspace.selected;
    const auto remove = [&](const std::string& what, const SetupDocument::Edit& edit) {
        edit_setup(model, "Delete " + what, edit);
    };
    switch (selected.kind) {
    case Kind::fixture:
        delete_fixture(model, selected.name);
        break;
    case Kind::stock:
        remove("the stock", [](const std::string& text) { return toml_without(text, "stock"); });
        break;
    case Kind::part:
        remove("the part", [](const std::string& text) { return toml_without(text, "part"); });
        break;
    case Kind::offset:
        remove(selected.name,
               [&](const std::string& text) { return without_offset(text, selected.name); });
        break;
    case Kind::tool:
        remove(fmt::format("T{}", core::value_of(selected.tool)),
               [&](const std::string& text) { return without_tool(text, selected.tool); });
        break;
    case Kind::allowance:
        remove("the minimum clearance",
               [](const std::string& text) { return with_allowance(text, std::nullopt); });
        break;
    case Kind::machine:
    case Kind::none:
        break;
    }
    keep_selection(model.workspace);
}

void rename_selected(ViewModel& model, const std::string& typed) {
    const SetupItem selected = model.workspace.selected;
    const std::string name(trimmed(typed));
    if (selected.kind != Kind::fixture || name == selected.name) return;
    if (edit_setup(model, fmt::format("Rename {}", selected.name), [&](const std::string& text) {
            return with_renamed_fixture(text, selected.name, name);
        }))
        model.workspace.selected.name = name;
}

std::string path_in_setup(const ViewModel& model, const std::string& file) {
    namespace fs = std::filesystem;
    std::error_code failure;
    const std::string& own = model.workspace.document.path();
    const fs::path near = own.empty() && model.program ? model.program->program : own;
    const fs::path folder = fs::absolute(near, failure).parent_path();
    const fs::path full = fs::absolute(file, failure);
    if (failure) return file;
    const fs::path relative = full.lexically_normal().lexically_relative(folder.lexically_normal());
    const bool is_below = !relative.empty() && *relative.begin() != "..";
    return (is_below ? relative : full).generic_string();
}

namespace {

/// Prepares to save under a path: nothing is saved in the folder of the samples, and a set-up from
/// there names the files that it needs by whole paths elsewhere. False: another name is needed.
bool leave_samples(ViewModel& model, const std::string& target) {
    namespace fs = std::filesystem;
    Workspace& workspace = model.workspace;
    if (is_below(target, model.samples)) {
        workspace.is_naming = true;
        workspace.file_name = (own_folder() / fs::path(target).filename()).generic_string();
        workspace.refusal = "The samples stay as they are: save the set-up in another folder";
        return false;
    }
    std::error_code failure;
    const fs::path own = fs::absolute(workspace.document.path(), failure).parent_path();
    if (workspace.document.path().empty() || !is_below(own, model.samples)) return true;
    workspace.is_naming = true;
    return edit_setup(model, "Use absolute paths", [&](const std::string& text) {
        return with_whole_paths(text, own.generic_string());
    });
}

} // namespace

bool save_document(ViewModel& model, const std::string& path, const FileWriter& write, double now) {
    Workspace& workspace = model.workspace;
    const std::string target = path.empty() ? workspace.document.path() : path;
    if (target.empty()) {
        workspace.is_naming = true;
        return false;
    }
    const bool may_replace = std::exchange(workspace.may_replace, false);
    if (!leave_samples(model, target)) return false;
    const SetupDocument& document = workspace.document;
    if (target == document.path() && !document.is_modified()
        && core::file_bytes(target) == document.saved_text()) {
        say(model, target + " is saved already", now);
        return true;
    }
    const auto saved = save_setup(workspace.document, target,
                                  may_replace ? Replacing::allowed : Replacing::refused,
                                  model.program ? model.program->program : "", write);
    if (!saved) {
        workspace.is_naming = true;
        workspace.file_name = target;
        workspace.refusal = target + " " + saved.error().message;
        return false;
    }
    workspace.is_naming = false;
    workspace.on_disk.reset();
    workspace.refusal.clear();
    say(model,
        "Saved " + target + (workspace.error ? "; it has an error and cannot be checked" : ""),
        now);
    return true;
}

} // namespace app::viewer
