#include "tests/fuzz/import_runs.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "app/setup/autodesk_machine.h"
#include "app/setup/control/control_offsets.h"
#include "app/setup/freecad_job.h"
#include "app/setup/tools/tool_library.h"
#include "core/sim/tool_assembly.h"
#include "gcode/language/dialect.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/zip_writer.h"

namespace test_support {
namespace {

void promise(bool holds, const char* what) {
    if (holds) return;
    std::fputs(fmt::format("broken promise: {}\n", what).c_str(), stderr);
    std::abort();
}

const ScopedFolder& import_folder() {
    static const ScopedFolder folder;
    return folder;
}

/// The value; null after an error, which must be complete.
template <typename T>
const T* value_or_complete_error(const core::Result<T>& read) {
    if (read) return &*read;
    promise(!read.error().message.empty(), "an error has a message");
    promise(!read.error().file.empty(), "an error names its file");
    promise(read.error().message.find('\n') == std::string::npos, "a message is one line");
    return nullptr;
}

void check_value(const std::optional<app::ControlValue>& value) {
    if (!value) return;
    promise(std::isfinite(value->value), "a value of a control is finite");
    promise(value->line > 0, "a value of a control has its line");
}

void check_origin(const app::ControlOrigin& origin) {
    for (const auto& axis : origin.axes) check_value(axis);
    check_value(origin.rotation_deg);
}

void read_offsets(const std::string& text, gcode::DialectId dialect) {
    const std::string path = import_folder().write("offsets.txt", text);
    const auto read = app::read_control_offsets({path}, {.dialect = dialect});
    const app::ControlOffsets* offsets = value_or_complete_error(read);
    if (!offsets) return;
    check_origin(offsets->external);
    check_origin(offsets->shift);
    for (const auto& [index, origin] : offsets->work) check_origin(origin);
    for (const auto& [number, tool] : offsets->tools)
        for (const auto* value : {&tool.length, &tool.wear, &tool.diameter, &tool.diameter_wear})
            check_value(*value);
}

void check_tool(const app::FoundTool& found) {
    promise(found.tool.diameter > 0.0, "a tool has a diameter");
    const auto assembled = core::assemble(app::complete(found).tool);
    if (assembled) promise(std::isfinite(assembled->length), "a tool has a finite length");
}

void read_library(const char* name, const std::string& bytes) {
    const auto read =
        app::read_tool_library(import_folder().write(name, bytes), gcode::LengthUnit::mm);
    if (const auto* tools = value_or_complete_error(read))
        for (const auto& [number, found] : *tools) check_tool(found);
}

void read_machine(const std::string& bytes) {
    const auto read = app::read_autodesk_machine(import_folder().write("m.machine", bytes));
    const app::AutodeskMachine* machine = value_or_complete_error(read);
    if (!machine) return;
    const toml::array* axes = machine->machine["axis"].as_array();
    promise(axes != nullptr, "a machine has a list of axes");
    for (const toml::node& node : *axes) {
        const toml::table& axis = *node.as_table();
        promise(axis["min"].value_or(0.0) <= axis["max"].value_or(0.0), "a travel is in order");
    }
}

void read_job(const std::string& bytes) {
    const auto read = app::read_freecad_job(import_folder().write("j.FCStd", bytes));
    const app::FreeCadJob* job = value_or_complete_error(read);
    if (!job) return;
    for (const auto& [number, found] : job->tools) check_tool(found);
    if (!job->stock) return;
    const core::Vec3 size = core::bounds(*job->stock).size();
    promise(std::isfinite(size.x + size.y + size.z), "a stock has a finite size");
}

} // namespace

void run_any_import(std::span<const uint8_t> bytes) {
    if (bytes.empty()) return;
    const std::string text(bytes.begin() + 1, bytes.end());
    switch (bytes[0] % 8) {
    case 0:
        return read_offsets(text, gcode::DialectId::fanuc);
    case 1:
        return read_offsets(text, gcode::DialectId::linuxcnc);
    case 2:
        return read_library("l.json", text);
    case 3:
        return read_library("l.tools", text);
    case 4:
        return read_library("l.hsmlib", text);
    case 5:
        return read_machine(text);
    case 6:
        return read_job(text);
    default:
        return read_job(zip_of({{"Document.xml", text}}));
    }
}

} // namespace test_support
