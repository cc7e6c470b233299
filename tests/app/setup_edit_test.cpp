#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/check/saved_setup.h"
#include "app/check/setup_sheet.h"
#include "app/commands/output.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_edits.h"
#include "app/setup/setup_file.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "tests/support/scoped_folder.h"

namespace app_test {
namespace {

using app::CheckJob;
using app::SetupEdits;
using app::SetupSource;
using test_support::bytes_of;
using testing::HasSubstr;
using testing::Not;

const std::string assets = FEELER_SOURCE_DIR "/assets/";

constexpr const char* pocket = "G21 G90 G54\nT1 M6\nS8000 M3\nG43 H1 Z5\nG0 X0 Y0\nG1 Z-3 F200\n"
                               "X40\nY30\nX0\nY0\nG0 Z5\nT2 M6\nG43 H2 Z5\nG81 X5 Y5 Z-8 R2 F100\n"
                               "G80\nM30\n";

core::Solid box_of(const core::Vec3& low, const core::Vec3& high) {
    return {core::SolidBox{{low, high}}, 0.0};
}

app::SetupSheet sheet_of(const CheckJob& job) {
    const auto check = app::read_check(job);
    EXPECT_TRUE(check) << (check ? "" : check.error().message);
    if (!check) return {};
    return app::sheet_of(check->file, check->run.setup, job.edits);
}

std::string cones_text(const std::vector<core::ConeStep>& cones) {
    std::string text;
    for (const core::ConeStep& cone : cones)
        text += " " + std::to_string(cone.lower_diameter) + "/"
                + std::to_string(cone.upper_diameter) + "/" + std::to_string(cone.length);
    return text;
}

void expect_same_solid(const core::Solid& a, const core::Solid& b, const std::string& where) {
    EXPECT_EQ(a.shape.index(), b.shape.index()) << where;
    EXPECT_EQ(a.tolerance, b.tolerance) << where;
    EXPECT_EQ(core::bounds(a).min, core::bounds(b).min) << where;
    EXPECT_EQ(core::bounds(a).max, core::bounds(b).max) << where;
    const auto* round = std::get_if<core::SolidCylinder>(&a.shape);
    if (!round || a.shape.index() != b.shape.index()) return;
    EXPECT_EQ(round->radius, std::get<core::SolidCylinder>(b.shape).radius) << where;
    EXPECT_EQ(round->axis, std::get<core::SolidCylinder>(b.shape).axis) << where;
}

void expect_same_tool(const core::ToolAssembly& a, const core::ToolAssembly& b,
                      const std::string& where) {
    EXPECT_EQ(a.length, b.length) << where;
    EXPECT_EQ(a.description.shape, b.description.shape) << where;
    EXPECT_EQ(a.description.diameter, b.description.diameter) << where;
    EXPECT_EQ(a.description.flute_length, b.description.flute_length) << where;
    EXPECT_EQ(a.description.corner_radius, b.description.corner_radius) << where;
    EXPECT_EQ(a.description.point_deg, b.description.point_deg) << where;
    EXPECT_EQ(cones_text(a.description.shank), cones_text(b.description.shank)) << where;
    EXPECT_EQ(cones_text(a.description.holder), cones_text(b.description.holder)) << where;
    EXPECT_EQ(a.description.touched_off, b.description.touched_off) << where;
    EXPECT_EQ(a.description.cuts_at_centre, b.description.cuts_at_centre) << where;
    ASSERT_EQ(a.parts.size(), b.parts.size()) << where;
    for (size_t i = 0; i < a.parts.size(); ++i) {
        EXPECT_EQ(a.parts[i].kind, b.parts[i].kind) << where;
        EXPECT_EQ(core::bounds(a.parts[i].profile).max, core::bounds(b.parts[i].profile).max)
            << where;
    }
}

/// Expects that two checks are equal before their first block.
void expect_same(const app::PreparedCheck& a, const app::PreparedCheck& b,
                 const std::string& where) {
    const core::Setup &one = a.run.setup, &two = b.run.setup;
    EXPECT_EQ(a.run.dialect, b.run.dialect) << where;
    EXPECT_EQ(one.mesh_size, two.mesh_size) << where;
    EXPECT_EQ(one.allowance, two.allowance) << where;
    EXPECT_EQ(one.allowances.size(), two.allowances.size()) << where;
    EXPECT_EQ(one.tool_at_start, two.tool_at_start) << where;
    EXPECT_EQ(one.spindle_at_start, two.spindle_at_start) << where;
    EXPECT_EQ(one.rules, two.rules) << where;
    EXPECT_EQ(one.search_limit, two.search_limit) << where;
    expect_same_solid(one.stock, two.stock, where);
    EXPECT_EQ(one.stock_mount.link_from_body.translation,
              two.stock_mount.link_from_body.translation)
        << where;
    ASSERT_EQ(one.fixtures.size(), two.fixtures.size()) << where;
    for (size_t i = 0; i < one.fixtures.size(); ++i)
        EXPECT_EQ(one.fixtures[i].name, two.fixtures[i].name) << where;
    ASSERT_EQ(one.tools.size(), two.tools.size()) << where;
    for (const auto& [number, tool] : one.tools) {
        ASSERT_TRUE(two.tools.contains(number)) << where;
        expect_same_tool(tool, two.tools.at(number), where);
    }
    const gcode::Environment &left = a.file.environment, &right = b.file.environment;
    EXPECT_EQ(left.work_offsets, right.work_offsets) << where;
    EXPECT_EQ(left.start, right.start) << where;
    EXPECT_EQ(left.tool_lengths, right.tool_lengths) << where;
    EXPECT_EQ(left.tool_diameters, right.tool_diameters) << where;
    EXPECT_EQ(a.file.speed_by_hand, b.file.speed_by_hand) << where;
}

/// Saves the set-up of a job to a folder and compares it with what is read from there.
void expect_saved_as_it_is(const CheckJob& job, const std::string& path) {
    const auto before = app::read_check(job);
    if (!before) return; // a program that cannot be read has no set-up
    const auto saved = app::save_setup(job, path, true, app::write_output);
    ASSERT_TRUE(saved) << job.program << ": " << saved.error().message;
    CheckJob again;
    again.program = job.program;
    again.setup = path;
    const auto after = app::read_check(again);
    ASSERT_TRUE(after) << job.program << ": " << after.error().message << " in line "
                       << after.error().where.line;
    expect_same(*before, *after, job.program);
}

/// A job for its own program, without a set-up.
struct OwnProgram {
    test_support::ScopedFolder folder;
    CheckJob job;

    explicit OwnProgram(const std::string& text = pocket) {
        job.program = folder.write("p.nc", text);
    }
};

/// Edits as a user would make to change the stock, sizes of the first tool, and a holder.
SetupEdits some_edits(const app::SetupSheet& shown) {
    app::SetupSheet wanted = shown;
    wanted.stock = box_of({-10, -5, -20.25}, {60, 45.5, 0.1});
    wanted.allowance = 1.5;
    if (!wanted.tools.empty() && wanted.tools[0].tool.shape != core::ToolShape::profile) {
        core::ToolDescription& tool = wanted.tools[0].tool;
        if (tool.stick_out) tool.stick_out = *tool.stick_out + 7.3;
        tool.holder = {{32, 40, 30}, {50, 50, 20}};
        tool.gauge_length.reset();
    }
    return app::edits_between(shown, wanted, {});
}

TEST(SetupEdits, StatedIsNotInferred) {
    OwnProgram own;
    const app::SetupSheet shown = sheet_of(own.job);
    ASSERT_EQ(shown.tools.size(), 2u);
    EXPECT_EQ(shown.stock_source, SetupSource::inferred);
    EXPECT_EQ(shown.tools[0].source, SetupSource::inferred);
    EXPECT_THAT(shown.tools[0].why, HasSubstr("tool 1"));
    EXPECT_THAT(shown.stock_why, HasSubstr("stock"));
    EXPECT_EQ(shown.allowance_source, SetupSource::usual);

    app::SetupSheet wanted = shown;
    wanted.tools[0].tool.diameter = 20.0;
    wanted.tools[0].tool.shank_diameter = 16.0;
    own.job.edits = app::edits_between(shown, wanted, {});
    const app::SetupSheet edited = sheet_of(own.job);
    EXPECT_EQ(edited.tools[0].stated, (std::set<std::string>{"diameter", "shank_diameter"}));
    EXPECT_EQ(edited.tools[0].tool.diameter, 20.0);
    EXPECT_TRUE(edited.tools[1].stated.empty());
    EXPECT_EQ(edited.stock_source, SetupSource::inferred) << "it was not stated";
    EXPECT_GT(core::bounds(edited.stock).size().x, core::bounds(shown.stock).size().x)
        << "a wider tool reaches further";
}

TEST(SetupEdits, WithNothingButAToolAtStartAreNotEmpty) {
    SetupEdits edits;
    EXPECT_TRUE(edits.empty());
    edits.tool_at_start = core::ToolNumber{3};
    EXPECT_FALSE(edits.empty());
}

TEST(SetupEdits, AStatedStockStaysWhereItWasStated) {
    OwnProgram own;
    const app::SetupSheet shown = sheet_of(own.job);
    app::SetupSheet wanted = shown;
    wanted.stock = {core::SolidCylinder{{20, 15, -12}, 45.0, 12.0, 2}, 0.0};
    own.job.edits = app::edits_between(shown, wanted, {});
    const app::SetupSheet edited = sheet_of(own.job);
    EXPECT_EQ(edited.stock_source, SetupSource::stated);
    expect_same_solid(edited.stock, wanted.stock, "as stated");
    const auto check = app::read_check(own.job);
    EXPECT_TRUE(check->stock_is_stated);
    EXPECT_THAT(check->run.assumptions, testing::Contains("the stock is as stated"));
}

TEST(SetupEdits, ASheetThatWasNotTouchedEditsNothing) {
    for (const char* setup : {"clamped_plate", "test_g90", "test_g90_vise6", "parallel"}) {
        CheckJob job;
        job.program = assets + "programs/clamped_plate.nc";
        job.setup = assets + "setups/" + setup + ".toml";
        const app::SetupSheet shown = sheet_of(job);
        EXPECT_FALSE(shown.tools.empty()) << setup;
        EXPECT_TRUE(app::edits_between(shown, shown, {}).empty()) << setup;
        for (const app::SheetTool& tool : shown.tools) {
            const auto assembled = core::assemble(tool.tool);
            ASSERT_TRUE(assembled) << setup << assembled.error().message;
            const auto check = app::read_check(job);
            EXPECT_NEAR(assembled->length, check->run.setup.tools.at(tool.tool.number).length, 1e-9)
                << setup;
        }
    }
}

TEST(SetupEdits, SayWhichFieldIsWrongAndChangeNothing) {
    OwnProgram own;
    const app::SetupSheet shown = sheet_of(own.job);
    struct Wrong {
        const char* key;
        std::function<void(app::SetupSheet&)> make;
    };
    const std::vector<Wrong> all = {
        {"diameter", [](auto& sheet) { sheet.tools[0].tool.diameter = -3.0; }},
        {"flute_length", [](auto& sheet) { sheet.tools[0].tool.flute_length = 9000.0; }},
        {"stick_out", [](auto& sheet) { sheet.tools[0].tool.stick_out = 1.0; }},
        {"corner_radius",
         [](auto& sheet) {
             sheet.tools[0].tool = app::reshaped(sheet.tools[0].tool, core::ToolShape::bull);
             sheet.tools[0].tool.corner_radius = 50.0;
         }},
        {"box",
         [](auto& sheet) {
             sheet.stock = box_of({0, 0, 0}, {10, 10, 0});
         }},
        {"box",
         [](auto& sheet) {
             sheet.stock = box_of({0, 0, 0}, {1e9, 10, 10});
         }},
        {"cylinder",
         [](auto& sheet) {
             sheet.stock = {core::SolidCylinder{{0, 0, 0}, -1.0, 5.0, 2}, 0.0};
         }},
        {"allowance", [](auto& sheet) { sheet.allowance = -1.0; }}};
    for (const Wrong& wrong : all) {
        app::SetupSheet wanted = shown;
        wrong.make(wanted);
        const SetupEdits edits = app::edits_between(shown, wanted, {});
        const auto refused = app::refusals_of(edits);
        ASSERT_EQ(refused.size(), 1u) << wrong.key;
        EXPECT_EQ(refused[0].key, wrong.key) << refused[0].why;
        EXPECT_FALSE(refused[0].why.empty());
        app::SetupFile file;
        EXPECT_FALSE(app::apply(edits, file));
        EXPECT_TRUE(file.setup.tools.empty() && !file.setup.allowance);
    }
}

TEST(SetupEdits, AToolCanTakeEveryShape) {
    OwnProgram own;
    const core::ToolDescription before = sheet_of(own.job).tools[0].tool;
    for (const core::ToolShape shape : app::stateable_shapes()) {
        core::ToolDescription tool = app::reshaped(before, shape);
        EXPECT_EQ(tool.shape, shape);
        const auto assembled = core::assemble(tool);
        EXPECT_TRUE(assembled) << core::name_of(shape) << ": " << assembled.error().message;
        EXPECT_EQ(tool.diameter, before.diameter);
        const auto back = core::assemble(app::reshaped(tool, core::ToolShape::flat));
        EXPECT_TRUE(back) << core::name_of(shape);
    }
}

TEST(SavedSetup, OfTheSampleSetupsMeansTheSame) {
    for (const auto& [setup, program] : {std::pair{"clamped_plate", "clamped_plate"},
                                         {"test_g90", "clamped_plate"},
                                         {"test_g90_vise6", "clamped_plate"},
                                         {"parallel", "clamped_plate"}}) {
        const test_support::ScopedFolder folder;
        std::filesystem::copy(assets, folder / "assets", std::filesystem::copy_options::recursive);
        CheckJob job;
        job.program = assets + "programs/" + program + ".nc";
        job.setup = folder / "assets/setups/" + std::string(setup) + ".toml";
        expect_saved_as_it_is(job, folder / "assets/setups/plain.toml");
        job.edits = some_edits(sheet_of(job));
        expect_saved_as_it_is(job, folder / "assets/setups/edited.toml");
    }
}

TEST(SavedSetup, OfARealProgramMeansWhatWasInferred) {
    size_t count = 0;
    for (const char* where : {"/assets/programs", "/tests/real/programs"})
        for (const auto& file :
             std::filesystem::directory_iterator(std::string(FEELER_SOURCE_DIR) + where)) {
            if (file.path().extension() == ".md") continue;
            const test_support::ScopedFolder folder;
            CheckJob job;
            job.program = file.path();
            if (!app::read_check(job)) continue;
            ++count;
            expect_saved_as_it_is(job, folder / "s.toml");
            job.edits = some_edits(sheet_of(job));
            expect_saved_as_it_is(job, folder / "e.toml");
        }
    RecordProperty("programs", static_cast<int>(count));
    EXPECT_GE(count, 10u);
}

TEST(SavedSetup, KeepsTextWrittenByTheUser) {
    const std::string before = bytes_of(assets + "setups/clamped_plate.toml");
    SetupEdits edits;
    edits.stock = box_of({0, 0, -25}, {240, 150, 0});
    const auto after = app::rewritten_setup(before, edits);
    ASSERT_TRUE(after);
    EXPECT_THAT(*after, HasSubstr("[0, 0, -25], [240, 150, 0]"));
    EXPECT_THAT(*after, HasSubstr("# Fixtures. `at` is the position of the mesh origin;"));
    EXPECT_THAT(*after, HasSubstr("# Drill: 70 + 70 = 140 mm."));
    EXPECT_THAT(*after, Not(HasSubstr("[0, 0, -20]")));
    EXPECT_EQ(*app::rewritten_setup(before, {}), before);
}

TEST(SavedSetup, PutsAllowancesWhereTomlTakesThem) {
    SetupEdits edits;
    edits.allowance = 3.0;
    for (const char* text :
         {"", "mesh_size = 0.4\n", "allowance = 2.0   # old\n[stock]\nbox = [[0,0,0],[1,1,1]]\n",
          "# only\n[[allowance]]\nbetween = [\"holder\", \"stock\"]\ndistance = 5\n",
          "[[allowance]]\ndistance = 2\n\n# next\n[stock]\nbox = [[0,0,0],[1,1,1]]\n",
          "stock = { box = [[0,0,0],[1,1,1]] }\n"}) {
        const auto after = app::rewritten_setup(text, edits);
        ASSERT_TRUE(after) << text << after.error().message;
        const test_support::ScopedFolder folder;
        const auto read = app::read_setup(folder.write("s.toml", *after), {});
        ASSERT_TRUE(read) << *after << read.error().message;
        EXPECT_EQ(read->setup.allowance, 3.0) << *after;
    }
}

TEST(SavedSetup, MarksInferredAndStatedValues) {
    OwnProgram own;
    own.job.edits = some_edits(sheet_of(own.job));
    const auto text = app::setup_file_text(own.job);
    ASSERT_TRUE(text);
    EXPECT_THAT(*text, HasSubstr("the stock is as stated"));
    EXPECT_THAT(*text, HasSubstr("tool 1 is as stated: holder, stick_out; the rest"));
    EXPECT_THAT(*text, HasSubstr("tool 2 is"));
    const std::string dialect(gcode::dialect(app::read_check(own.job)->run.dialect).name);
    EXPECT_THAT(*text, HasSubstr("dialect = \"" + dialect + "\""))
        << "whatever the program becomes";
    expect_saved_as_it_is(own.job, own.folder / "s.toml");
}

TEST(SavedSetup, IsUtf8ForAnyNameOfTheProgram) {
    const test_support::ScopedFolder folder;
    CheckJob job;
    job.program = folder.write("fr\xE4s.nc", pocket);
    expect_saved_as_it_is(job, folder / "s.toml");
    EXPECT_THAT(bytes_of(folder / "s.toml"), HasSubstr("fr\xC3\xA4s.nc"));
}

TEST(SavedSetup, NeverReplacesAFileUnasked) {
    OwnProgram own;
    const std::string path = own.folder.write("s.toml", "mine\n");
    const auto refused = app::save_setup(own.job, path, false, app::write_output);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("already exists"));
    EXPECT_EQ(bytes_of(path), "mine\n");
    EXPECT_FALSE(app::save_setup(own.job, own.job.program, true, app::write_output));
    EXPECT_EQ(bytes_of(own.job.program), pocket);
    ASSERT_TRUE(app::save_setup(own.job, path, true, app::write_output));
    EXPECT_THAT(bytes_of(path), HasSubstr("[stock]"));
    EXPECT_EQ(app::proposed_setup_path(own.job), own.folder / "p.toml");
    EXPECT_EQ(own.folder.names().size(), 2u) << "no other file remains";
}

TEST(SavedSetup, StaysInTheFolderOfTheFilesThatItNames) {
    const test_support::ScopedFolder folder;
    CheckJob job;
    job.program = assets + "programs/clamped_plate.nc";
    job.setup = assets + "setups/clamped_plate.toml";
    const auto refused = app::save_setup(job, folder / "s.toml", false, app::write_output);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("save it in"));
}

} // namespace
} // namespace app_test
