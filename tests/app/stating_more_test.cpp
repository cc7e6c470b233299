#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/setup/coverage.h"
#include "app/setup/inference/inferred_setup.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_length.h"
#include "app/setup/setup_text.h"
#include "core/base/rule_table.h"
#include "gcode/language/canonical.h"
#include "gcode/text/source.h"
#include "tests/app/bare_programs.h"
#include "tests/support/scoped_folder.h"

/// Stating in a set-up what was assumed without it makes no verdict worse, unless it finds
/// something.

namespace app_test {
namespace {

using app::CheckJob;
using app::Known;

/// One thing that a check without a set-up assumes, as it was assumed. Statements of the same
/// subject exclude each other.
struct Statement {
    std::string name, subject, root, program, rest; // text before, in and after [program]
};

std::string tool_value(int number, const std::string& line) {
    return fmt::format("\n[[tool]]\nnumber = {}\n{}\n", number, line);
}

std::string axes_text(const app::SetupFile& file) {
    std::string text = file.uses_other_axes ? "[machine]\nother_axes = \"not described\"\n" : "";
    for (size_t axis = 0; axis < 3; ++axis)
        text +=
            fmt::format("[[machine.axis]]\nname = \"{}\"\nhome = {}\n", core::axis_letters[axis],
                        app::toml_number(file.environment.home->at(axis)));
    return text;
}

std::string origin_of(const app::SetupFile& file, size_t index) {
    const gcode::AxisValues origin = file.environment.work_offset(index);
    return fmt::format("\"{}\" = {{ X = {}, Y = {}, Z = {} }}\n", gcode::name_of_offset(index),
                       app::toml_number(origin[0]), app::toml_number(origin[1]),
                       app::toml_number(origin[2]));
}

/// The work offset of the program at which the stock is.
std::string frame_of_stock(const app::SetupFile& file) {
    const core::Vec3& mount = file.setup.stock_mount.link_from_body.translation;
    for (const size_t index : file.offsets_used) {
        const gcode::AxisValues origin = file.environment.work_offset(index);
        if (core::Vec3(origin[0], origin[1], origin[2]) == mount)
            return gcode::name_of_offset(index);
    }
    return "G54";
}

void add_tools(const app::SetupFile& file, std::vector<Statement>& all) {
    for (const auto& [number, tool] : file.setup.tools) {
        const int n = core::value_of(number);
        const std::string subject = fmt::format("tool {}", n);
        all.push_back(
            {subject, subject, "", "", app::tool_table(tool.description, gcode::LengthUnit::mm)});
        for (const core::ToolSize& size : core::tool_sizes()) {
            const auto value = size.of(tool.description);
            if (value && size.shapes.contains(tool.description.shape))
                all.push_back(
                    {subject + " " + size.key, subject, "", "",
                     tool_value(n, fmt::format("{} = {}", size.key, app::toml_number(*value)))});
        }
        all.push_back({subject + " number", subject, "", "", tool_value(n, "")});
        if (tool.description.length_is_guess)
            all.push_back({subject + " touched_off", subject, "", "",
                           tool_value(n, "touched_off = \"unknown\"")});
    }
}

std::vector<Statement> statements_of(const app::SetupFile& file) {
    std::vector<Statement> all;
    const gcode::Position& start = file.environment.start;
    all.push_back({"fixtures", "fixtures", "fixtures = \"none\"\n", "", ""});
    all.push_back({"mesh size", "mesh size",
                   "mesh_size = " + app::toml_number(file.setup.mesh_size) + "\n", "", ""});
    all.push_back({"start", "start", "",
                   fmt::format("start = {{ X = {}, Y = {}, Z = {} }}\n", start[0].value_or(0.0),
                               start[1].value_or(0.0), start[2].value_or(0.0)),
                   ""});
    all.push_back({"home", "home", "", "", axes_text(file)});
    if (const auto tool = file.setup.tool_at_start)
        all.push_back({"tool at start", "tool at start", "",
                       fmt::format("tool_at_start = {}\n", core::value_of(*tool)), ""});
    if (file.setup.spindle_at_start == core::SpindleDirection::clockwise)
        all.push_back(
            {"spindle at start", "spindle at start", "", "spindle_at_start = \"clockwise\"\n", ""});
    if (file.speed_by_hand)
        all.push_back({"speed by hand", "speed by hand", "", "speed_by_hand = true\n", ""});
    std::string offsets;
    for (const size_t index : file.offsets_used) {
        offsets += origin_of(file, index);
        all.push_back({gcode::name_of_offset(index), "offsets", "", "",
                       "[offsets]\n" + origin_of(file, index)});
    }
    if (file.offsets_used.size() > 1)
        all.push_back({"all offsets", "offsets", "", "", "[offsets]\n" + offsets});
    if (!app::stands_for_no_stock(file.setup.stock)) {
        const auto stock = app::with_stock("", file.setup.stock, frame_of_stock(file));
        EXPECT_TRUE(stock);
        all.push_back({"stock", "stock", "", "", *stock});
    }
    add_tools(file, all);
    return all;
}

std::string text_of(std::initializer_list<const Statement*> statements) {
    std::string root, program, rest;
    for (const Statement* each : statements) {
        root += each->root;
        program += each->program;
        rest += "\n" + each->rest;
    }
    return root + (program.empty() ? "" : "[program]\n" + program) + rest;
}

app::CheckRun run_of(const std::string& program, const std::optional<std::string>& setup,
                     std::optional<double> mesh_size = {}) {
    auto run = app::run_check({.program = program,
                               .setup = {},
                               .allowance = {},
                               .mesh_size = mesh_size,
                               .setup_text = setup});
    EXPECT_TRUE(run) << program << ": " << run.error().message << "\n" << setup.value_or("");
    return run ? *std::move(run) : app::CheckRun{};
}

std::string text_of(const core::Finding& finding) {
    return fmt::format("{} {} {}", core::name_of(finding.severity), finding.rule,
                       core::value_of(finding.block.value_or(core::BlockIndex{})));
}

/// What a check with statements says that a check without them does not.
std::string worse(const app::CheckRun& bare, const app::CheckRun& stated) {
    std::vector<std::string> known, found;
    for (const core::Finding& finding : bare.findings) known.push_back(text_of(finding));
    bool shows = false;
    for (const core::Finding& finding : stated.findings) {
        // What is described shows where the program does not fit to it, and on which reading of the
        // program it is hit.
        shows = shows || finding.rule == core::rule_id("open-premise");
        const bool compares = finding.rule == core::rule_id("open-premise")
                              || finding.rule == core::rule_id("offset-implausible");
        const bool is_new = std::find(known.begin(), known.end(), text_of(finding)) == known.end();
        if (is_new && !compares) found.push_back(text_of(finding));
    }
    if (!shows && bare.verdict != stated.verdict)
        found.push_back(
            fmt::format("{} -> {}", core::name_of(bare.verdict), core::name_of(stated.verdict)));
    if (bare.stopped.has_value() != stated.stopped.has_value()) found.push_back("stopped");
    const auto before = app::items_of(*bare.coverage), after = app::items_of(*stated.coverage);
    for (size_t i = 0; i < before.size(); ++i)
        if (after[i].known < before[i].known) found.push_back(before[i].key);
    return fmt::format("{}", fmt::join(found, ", "));
}

/// The programs in the repository that can be checked, and those that others share.
std::vector<std::string> real_programs() {
    std::vector<std::string> paths;
    for (const char* where : {"/assets/programs", "/tests/real/programs"})
        for (const auto& file :
             std::filesystem::directory_iterator(std::string(FEELER_SOURCE_DIR) + where))
            if (file.path().extension() != ".md") paths.push_back(file.path().generic_string());
    std::sort(paths.begin(), paths.end());
    EXPECT_GE(paths.size(), 10u);
    return paths;
}

void expect_not_worse(const std::string& program, std::optional<double> mesh_size, bool pairs) {
    const auto read = gcode::read_program(program);
    ASSERT_TRUE(read);
    const auto setup = app::infer_setup(*read, {});
    ASSERT_TRUE(setup) << program;
    const app::CheckRun bare = run_of(program, {}, mesh_size);
    const std::vector<Statement> all = statements_of(*setup);
    const auto compare = [&](const std::string& name, const std::string& text) {
        EXPECT_EQ(worse(bare, run_of(program, text, mesh_size)), "")
            << program << " with " << name << "\n"
            << text;
    };
    for (size_t i = 0; i < all.size(); ++i) {
        if (!pairs) compare(all[i].name, text_of({&all[i]}));
        for (size_t j = i + 1; pairs && j < all.size(); ++j)
            if (all[i].subject != all[j].subject)
                compare(all[i].name + " and " + all[j].name, text_of({&all[i], &all[j]}));
    }
}

TEST(StatingMore, OfOneThingMakesNoVerdictWorse) {
    for (const std::string& program : real_programs()) expect_not_worse(program, {}, false);
}

TEST(StatingMore, OfTwoThingsMakesNoVerdictWorse) {
    for (const std::string& program : real_programs()) expect_not_worse(program, 2.0, true);
}

TEST(StatingMore, MakesNoVerdictWorseWhereTheOperatorDoesTheRest) {
    for (const char* text : bare_programs) {
        const test_support::ScopedFolder folder;
        const std::string program = folder.write("p.nc", text);
        expect_not_worse(program, {}, false);
        expect_not_worse(program, {}, true);
    }
}

} // namespace
} // namespace app_test
