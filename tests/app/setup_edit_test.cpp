#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/check/setup_sheet.h"
#include "app/commands/output.h"
#include "app/setup/inference/inferred_setup.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_document.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_length.h"
#include "app/setup/setup_text.h"
#include "app/setup/stated_setup.h"
#include "gcode/language/environment.h"
#include "gcode/text/source.h"
#include "tests/support/scoped_folder.h"

namespace app_test {
namespace {

using app::CheckJob;
using app::SetupDocument;
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
    return app::sheet_of(check->file, check->run.setup);
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
    constexpr double written = 1e-10; // mm, as set-ups state lengths
    EXPECT_NEAR(a.length, b.length, written) << where;
    EXPECT_EQ(a.description.shape, b.description.shape) << where;
    EXPECT_NEAR(a.description.diameter, b.description.diameter, written) << where;
    EXPECT_NEAR(a.description.flute_length, b.description.flute_length, written) << where;
    EXPECT_EQ(a.description.corner_radius, b.description.corner_radius) << where;
    EXPECT_EQ(a.description.point_deg, b.description.point_deg) << where;
    EXPECT_EQ(cones_text(a.description.shank), cones_text(b.description.shank)) << where;
    EXPECT_EQ(cones_text(a.description.holder), cones_text(b.description.holder)) << where;
    EXPECT_EQ(a.description.touched_off, b.description.touched_off) << where;
    EXPECT_EQ(a.description.cuts_at_centre, b.description.cuts_at_centre) << where;
    ASSERT_EQ(a.parts.size(), b.parts.size()) << where;
    for (size_t i = 0; i < a.parts.size(); ++i) {
        EXPECT_EQ(a.parts[i].kind, b.parts[i].kind) << where;
        EXPECT_NEAR(glm::distance(core::bounds(a.parts[i].profile).max,
                                  core::bounds(b.parts[i].profile).max),
                    0.0, written)
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

/// A job for its own program, without a set-up.
struct OwnProgram {
    test_support::ScopedFolder folder;
    CheckJob job;

    explicit OwnProgram(const std::string& text = pocket) {
        job.program = folder.write("p.nc", text);
    }
    /// The sheet of the program with this text of a set-up.
    app::SetupSheet sheet(const std::string& setup) {
        job.setup_text = setup;
        return sheet_of(job);
    }
    /// The error in this text of a set-up.
    core::Error error(const std::string& setup) {
        job.setup_text = setup;
        const auto check = app::read_check(job);
        EXPECT_FALSE(check) << setup;
        return check ? core::Error{} : check.error();
    }
};

/// The programs in the repository that can be read.
std::vector<std::string> real_programs() {
    std::vector<std::string> paths;
    for (const char* where : {"/assets/programs", "/tests/real/programs"})
        for (const auto& file :
             std::filesystem::directory_iterator(std::string(FEELER_SOURCE_DIR) + where)) {
            CheckJob job;
            job.program = file.path().generic_string();
            if (file.path().extension() != ".md" && app::read_check(job))
                paths.push_back(job.program);
        }
    std::sort(paths.begin(), paths.end());
    EXPECT_GE(paths.size(), 10u);
    return paths;
}

TEST(SetupSheet, SaysWhereValuesComeFrom) {
    OwnProgram own;
    const app::SetupSheet bare = sheet_of(own.job);
    ASSERT_EQ(bare.tools.size(), 2u);
    EXPECT_EQ(bare.stock_source, SetupSource::assumed);
    EXPECT_EQ(bare.tools[0].source, SetupSource::assumed);
    EXPECT_THAT(bare.tools[0].why, HasSubstr("tool 1"));
    EXPECT_THAT(bare.stock_why, HasSubstr("stock"));
    EXPECT_FALSE(bare.allowance);
    ASSERT_EQ(bare.offsets.size(), 1u);
    EXPECT_EQ(bare.offsets[0].name, "G54");
    EXPECT_TRUE(bare.offsets[0].is_used);
    EXPECT_EQ(bare.offsets[0].source, SetupSource::assumed);
    EXPECT_FALSE(bare.knows_fixtures);

    const app::SetupSheet stated =
        own.sheet("fixtures = \"none\"\nassumed = [\"stock\"]\n[offsets]\nG54 = { X = 1 }\nG55 = { "
                  "Y = 2 }\n[stock]\nbox = [[0, 0, -9], [40, 30, 0]]\n");
    EXPECT_EQ(stated.stock_source, SetupSource::assumed) << "the file says so";
    ASSERT_EQ(stated.offsets.size(), 2u);
    EXPECT_EQ(stated.offsets[0].source, SetupSource::stated);
    EXPECT_EQ(stated.offsets[1].origin, core::Vec3(0, 2, 0));
    EXPECT_FALSE(stated.offsets[1].is_used);
    EXPECT_TRUE(stated.knows_fixtures);
}

TEST(PartialTool, StatesOnlyWhatIsKnown) {
    OwnProgram own;
    const app::SetupSheet bare = sheet_of(own.job);
    const app::SetupSheet edited =
        own.sheet("[[tool]]\nnumber = 1\ndiameter = 20\nholder = \"BT40-ER32\"\n");
    const app::SheetTool& tool = edited.tools[0];
    EXPECT_EQ(tool.tool.diameter, 20.0);
    EXPECT_EQ(app::holder_name(tool.tool), "BT40-ER32");
    EXPECT_EQ(tool.source_of("diameter"), SetupSource::stated);
    EXPECT_EQ(tool.source_of("holder"), SetupSource::stated);
    EXPECT_EQ(tool.source_of("flute_length"), SetupSource::assumed);
    EXPECT_EQ(tool.tool.shape, bare.tools[0].tool.shape);
    EXPECT_EQ(edited.tools[1].tool.diameter, bare.tools[1].tool.diameter);
    EXPECT_EQ(edited.tools[1].source, SetupSource::assumed);
    EXPECT_EQ(edited.stock_source, SetupSource::assumed) << "it was not stated";
    EXPECT_GT(core::bounds(edited.stock).size().x, core::bounds(bare.stock).size().x)
        << "a wider tool reaches further";
}

TEST(PartialTool, ChangingAStickOutChangesNothingElse) {
    OwnProgram own;
    const auto tool = [&](const std::string& text) {
        return own.sheet("[[tool]]\nnumber = 1\nholder = \"BT40-ER32\"\n" + text).tools[0].tool;
    };
    const core::ToolDescription before = tool(""), shorter = tool("stick_out = 22\n"),
                                longer = tool("stick_out = 55.5\n");
    EXPECT_EQ(longer.stick_out, 55.5);
    EXPECT_EQ(longer.flute_length, before.flute_length);
    EXPECT_EQ(longer.shank_diameter, before.shank_diameter);
    EXPECT_EQ(shorter.stick_out, 22.0);
    EXPECT_EQ(shorter.diameter, before.diameter);
    EXPECT_EQ(tool("stick_out = 12\n").flute_length, 12.0)
        << "assumed flutes are not longer than the tool";
}

TEST(PartialTool, IsCompletedFromComments) {
    OwnProgram own("(T1 D=10. CR=2. - ZMIN=-3. - bullnose end mill)\n" + std::string(pocket));
    const app::SetupSheet sheet = own.sheet("[[tool]]\nnumber = 1\nflute_length = 31\n");
    EXPECT_EQ(sheet.tools[0].tool.shape, core::ToolShape::bull);
    EXPECT_EQ(sheet.tools[0].tool.corner_radius, 2.0);
    EXPECT_EQ(sheet.tools[0].tool.flute_length, 31.0);
}

TEST(PartialTool, OfAProgramWithoutToolCallsIsTheOneInTheSpindle) {
    OwnProgram own("G21 G90 G54\nS8000 M3\nG0 X0 Y0 Z5\nG1 Z-3 F200\nX40\nG0 Z5\nM30\n");
    const app::SetupSheet sheet = own.sheet("[[tool]]\nnumber = 7\ndiameter = 9\n");
    ASSERT_EQ(sheet.tools.size(), 1u);
    EXPECT_EQ(sheet.tools[0].tool.number, core::ToolNumber{7});
    EXPECT_EQ(sheet.tools[0].tool.diameter, 9.0);
}

TEST(PartialTool, ThatContradictsItselfIsAnErrorWithItsLine) {
    OwnProgram own;
    const core::Error error = own.error("[[tool]]\nnumber = 2\nstick_out = 30\n\n[[tool]]\n"
                                        "number = 1\nflute_length = 30\nstick_out = 20\n");
    EXPECT_EQ(error.where.line, 5u);
    EXPECT_THAT(error.message, HasSubstr("tool 1"));
    EXPECT_THAT(error.file, HasSubstr("p.toml"));
    EXPECT_THAT(own.error("[[tool]]\nnumber = 1\ndiameter = 4\n[[tool]]\nnumber = 1\nshape = "
                          "\"flat\"\ndiameter = 4\nflute_length = 9\n")
                    .message,
                HasSubstr("defined twice"));
    EXPECT_THAT(own.error("[[tool]]\nnumber = 1\npitch = 1\n").message, HasSubstr("pitch"));
}

TEST(PartialTool, ThatIsNotUsedIsLeftOut) {
    OwnProgram own;
    own.job.setup_text = "[[tool]]\nnumber = 9\nstick_out = 30\n";
    const auto check = app::read_check(own.job);
    ASSERT_TRUE(check);
    EXPECT_FALSE(check->run.setup.tools.contains(core::ToolNumber{9}));
    EXPECT_THAT(check->run.assumptions, testing::Contains(HasSubstr("tool 9 is described")));
}

TEST(StatedTool, OfTheSheetIsThatOfTheSetup) {
    for (const char* setup : {"clamped_plate", "test_g90", "test_g90_vise6", "parallel"}) {
        CheckJob job;
        job.program = assets + "programs/clamped_plate.nc";
        job.setup = assets + "setups/" + setup + ".toml";
        const auto check = app::read_check(job);
        ASSERT_TRUE(check) << setup;
        for (const app::SheetTool& tool : sheet_of(job).tools) {
            EXPECT_EQ(tool.is_described, check->run.setup.tools.contains(tool.tool.number));
            if (!tool.is_described) continue;
            const auto assembled = core::assemble(tool.tool);
            ASSERT_TRUE(assembled) << setup << assembled.error().message;
            EXPECT_NEAR(assembled->length, check->run.setup.tools.at(tool.tool.number).length, 1e-9)
                << setup;
        }
    }
}

TEST(StatedTool, CanTakeEveryShape) {
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
        const auto text = app::with_tool("[[tool]]\nnumber = 1\nstick_out = 9 # short\n", tool);
        ASSERT_TRUE(text) << text.error().message;
        EXPECT_EQ(own.sheet(*text).tools[0].tool.shape, shape) << *text;
    }
}

/// The text of a set-up that states everything as it was inferred.
std::string all_stated(const app::SetupSheet& sheet) {
    core::Result<std::string> text = std::string();
    if (!std::holds_alternative<core::SolidMesh>(sheet.stock.shape))
        text = app::with_stock(*text, sheet.stock, sheet.frame);
    for (const app::SheetTool& tool : sheet.tools) {
        if (text) text = app::with_tool(*text, tool.tool);
    }
    EXPECT_TRUE(text) << (text ? "" : text.error().message);
    return text.value_or("");
}

TEST(StatedSetup, MeansWhatWasInferred) {
    for (const std::string& program : real_programs()) {
        CheckJob job;
        job.program = program;
        const auto before = app::read_check(job);
        ASSERT_TRUE(before);
        if (app::stands_for_no_stock(before->run.setup.stock)) continue;
        job.setup_text = all_stated(sheet_of(job));
        const auto after = app::read_check(job);
        ASSERT_TRUE(after) << program << ": " << after.error().message << *job.setup_text;
        ASSERT_EQ(before->run.setup.tools.size(), after->run.setup.tools.size()) << program;
        for (const auto& [number, tool] : before->run.setup.tools)
            expect_same_tool(tool, after->run.setup.tools.at(number), program);
    }
}

TEST(InferredSetup, WrittenToAFileMeansTheSame) {
    for (const std::string& path : real_programs()) {
        const test_support::ScopedFolder folder;
        CheckJob job;
        job.program = path;
        const auto before = app::read_check(job);
        const auto program = gcode::read_program(path);
        const auto setup = app::infer_setup(*program, {});
        ASSERT_TRUE(before && setup);
        job.setup = folder.write("s.toml", app::setup_text(*setup, {.program = path}));
        const auto after = app::read_check(job);
        ASSERT_TRUE(after) << path << ": " << after.error().message;
        expect_same(*before, *after, path);
    }
}

TEST(InferredSetup, IsUtf8ForAnyNameOfTheProgram) {
    const test_support::ScopedFolder folder;
    const auto program = gcode::read_program(folder.write("p.nc", pocket));
    const std::string text =
        app::setup_text(*app::infer_setup(*program, {}), {.program = "fr\xE4s.nc"});
    EXPECT_THAT(text, HasSubstr("fr\xC3\xA4s.nc"));
}

std::string changed(const core::Result<std::string>& text) {
    EXPECT_TRUE(text) << (text ? "" : text.error().message);
    return text.value_or("");
}

TEST(SetupChanges, KeepTextWrittenByTheUser) {
    const std::string before = bytes_of(assets + "setups/clamped_plate.toml");
    const std::string after =
        changed(app::with_stock(before, box_of({0, 0, -25}, {240, 150, 0}), "G54"));
    EXPECT_THAT(after, HasSubstr("[0, 0, -25], [240, 150, 0]"));
    EXPECT_THAT(after, HasSubstr("# Fixtures. `at` is the position of the mesh origin;"));
    EXPECT_THAT(after, HasSubstr("# Drill: 70 + 70 = 140 mm."));
    EXPECT_THAT(after, Not(HasSubstr("[0, 0, -20]")));
}

TEST(SetupChanges, PutAllowancesWhereTomlTakesThem) {
    for (const char* text :
         {"", "mesh_size = 0.4\n", "allowance = 2.0   # old\n[stock]\nbox = [[0,0,0],[1,1,1]]\n",
          "# only\n[[allowance]]\nbetween = [\"holder\", \"stock\"]\ndistance = 5\n",
          "[[allowance]]\ndistance = 2\n\n# next\n[stock]\nbox = [[0,0,0],[1,1,1]]\n",
          "stock = { box = [[0,0,0],[1,1,1]] }\n"}) {
        const std::string after = changed(app::with_allowance(text, 3.0));
        const auto read = app::read_setup_text(after, "s.toml", {});
        ASSERT_TRUE(read) << after << read.error().message;
        EXPECT_EQ(read->setup.allowance, 3.0) << after;
        const auto none =
            app::read_setup_text(changed(app::with_allowance(after, {})), "s.toml", {});
        ASSERT_TRUE(none);
        EXPECT_FALSE(none->setup.allowance);
    }
}

TEST(SetupChanges, StateAStockOfAnotherShape) {
    std::string text = changed(app::with_stock("", box_of({-1, -2, -3}, {4, 5, 6}), "G55"));
    EXPECT_EQ(text, "[stock]\nbox = [[-1, -2, -3], [4, 5, 6]]\nframe = \"G55\"\n");
    text =
        changed(app::with_stock("assumed = [\"stock\", \"start\"]\n" + text,
                                {core::SolidCylinder{{20, 15, -12}, 45.0, 12.0, 0}, 0.0}, "G54"));
    EXPECT_EQ(text, "assumed = [\"start\"]\n[stock]\nframe = \"G55\"\ncylinder = { radius = 45, "
                    "height = 12, axis = \"X\" }\nat = [20, 15, -12]\n");
    text = changed(app::with_stock(text, box_of({0, 0, 0}, {1, 1, 1}), "G54"));
    EXPECT_THAT(text, HasSubstr("box = [[0, 0, 0], [1, 1, 1]]"));
    EXPECT_THAT(text, Not(HasSubstr("at =")));
    EXPECT_THAT(text, HasSubstr("frame = \"G55\""));
}

TEST(SetupChanges, CopyAndRenumberTools) {
    const core::ToolNumber two{2}, five{5};
    const std::string text = "[program]\ntool_at_start = 2\n\n[[tool]]\nnumber = 2 # the long one\n"
                             "stick_out = 90\n\n[[tool]]\nnumber = 3\n";
    const std::string copied = changed(app::with_copied_tool(text, two, five));
    EXPECT_EQ(copied, text + "\n[[tool]]\nnumber = 5 # the long one\nstick_out = 90\n");
    EXPECT_FALSE(app::with_copied_tool(text, two, core::ToolNumber{3}));
    EXPECT_EQ(changed(app::with_copied_tool(text, core::ToolNumber{9}, five)), text);
    const std::string other = changed(app::with_tool_number(text, two, five));
    EXPECT_THAT(other, HasSubstr("tool_at_start = 5\n"));
    EXPECT_THAT(other, HasSubstr("number = 5 # the long one\n"));
    EXPECT_EQ(changed(app::with_tool_number(other, five, two)), text);
    const auto taken = app::with_tool_number(text, two, core::ToolNumber{3});
    ASSERT_FALSE(taken);
    EXPECT_THAT(taken.error().message, HasSubstr("there is a tool 3 already"));
    EXPECT_FALSE(app::with_tool_number(text, two, core::ToolNumber{-1}));
    EXPECT_EQ(changed(app::with_tool_number(text, two, two)), text);
}

TEST(SetupChanges, StateTheUnitOfAMesh) {
    const std::string mm = "[[fixture]]\nname = \"a\"\nmesh = \"a.stl\" # from CAD\n";
    const app::TomlPath a{"fixture", size_t{0}};
    const std::string in = app::with_mesh_unit(mm, a, gcode::LengthUnit::inch).value();
    EXPECT_EQ(in, mm + "mesh_unit = \"inch\"\n");
    EXPECT_EQ(app::stated_in(in).fixtures[0].mesh_unit, gcode::LengthUnit::inch);
    EXPECT_EQ(app::with_mesh_unit(in, a, gcode::LengthUnit::mm).value(), mm);
    // Another shape has none.
    const std::string box = app::with_box(in, a, {core::Vec3(0.0), core::Vec3(1.0)}).value();
    EXPECT_EQ(box.find("mesh"), std::string::npos) << box;
}

TEST(SetupChanges, AddCopyRenameAndRemoveFixtures) {
    std::string text = changed(app::with_fixture("fixtures = \"none\"\n", "vise",
                                                 "box = [[0, 0, 0], [9, 9, 9]] # steel\n"));
    EXPECT_EQ(text, "[[fixture]]\nname = \"vise\"\nbox = [[0, 0, 0], [9, 9, 9]] # steel\n");
    text += "[[fixture.move]]\nline = 9\nremove = true\n\n[[fixture]]\nname = \"jaw\"\nframe = "
            "\"vise\"\nbox = [[0, 0, 0], [1, 1, 1]]\n\n[[allowance]]\nbetween = [\"vise\", "
            "\"holder\"]\ndistance = 3\n";
    EXPECT_FALSE(app::with_fixture(text, "vise", "box = [[0, 0, 0], [1, 1, 1]]\n"));
    const auto carried = app::without_fixture(text, "vise");
    ASSERT_FALSE(carried);
    EXPECT_THAT(carried.error().message, HasSubstr("relative to \"vise\""));
    const std::string renamed = changed(app::with_renamed_fixture(text, "vise", "big vise"));
    EXPECT_THAT(renamed, Not(HasSubstr("\"vise\"")));
    EXPECT_THAT(renamed, HasSubstr("frame = \"big vise\""));
    EXPECT_THAT(renamed, HasSubstr("between = [\"big vise\", \"holder\"]"));
    ASSERT_TRUE(app::read_setup_text(renamed, "s.toml", {}));
    EXPECT_FALSE(app::with_renamed_fixture(text, "vise", "jaw"));
    const std::string copied = changed(app::with_copied_fixture(text, "vise", "vise-2"));
    EXPECT_THAT(copied, HasSubstr("name = \"vise-2\"\nbox = [[0, 0, 0], [9, 9, 9]] # steel\n"));
    ASSERT_TRUE(app::read_setup_text(copied, "s.toml", {}));
    EXPECT_THAT(changed(app::without_fixture(text, "jaw")), Not(HasSubstr("jaw")));
    EXPECT_EQ(app::free_name(text, "vise"), "vise-2");
    EXPECT_EQ(app::free_name(copied, "vise-2"), "vise-3");
    EXPECT_EQ(app::free_name(text, "stud"), "stud");
}

TEST(SetupChanges, GiveNoFixtureTheNameOfAFrame) {
    const std::string text = "[[fixture]]\nname = \"vise\"\nbox = [[0, 0, 0], [1, 1, 1]]\n";
    for (const char* name : {"G54", "g55", "machine", "stock", "part", "holder", ""}) {
        EXPECT_FALSE(app::with_renamed_fixture(text, "vise", name)) << name;
        EXPECT_FALSE(app::with_fixture(text, name, "box = [[0, 0, 0], [1, 1, 1]]\n")) << name;
        EXPECT_FALSE(app::with_copied_fixture(text, "vise", name)) << name;
    }
    EXPECT_EQ(app::free_name(text, "G54"), "G54-1");
    EXPECT_EQ(app::free_name(text, "holder"), "holder-1");
    EXPECT_EQ(app::free_name("[[fixture]]\nname = \"holder-1\"\n", "holder"), "holder-2");
}

TEST(SetupChanges, KeepAWorkOffsetInWhichBodiesAre) {
    const std::string offsets = "[offsets]\nG54 = { X = 1 }\n\"G54.1 P2\" = { X = 2 }\n";
    const std::string text =
        offsets + "[stock]\nmargin = 1\n[[fixture]]\nname = \"vise\"\n" + "frame = \"G154 P2\"\n";
    const auto kept = app::without_offset(text, "G54");
    ASSERT_FALSE(kept);
    EXPECT_THAT(kept.error().message, HasSubstr("the stock is positioned in G54"));
    const auto other = app::without_offset(text, "G54.1 P2");
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, HasSubstr("\"vise\" is positioned in G54.1 P2"));
    EXPECT_EQ(app::without_offset(text, "G55").value_or(""), text);
    EXPECT_THAT(changed(app::without_offset(offsets, "G54")), Not(HasSubstr("G54 =")));
}

TEST(SetupChanges, StateOffsets) {
    EXPECT_EQ(changed(app::with_offset("", "G54", {-350, 0.1 + 0.2, -420})),
              "[offsets]\nG54 = { X = -350, Y = 0.3, Z = -420 }\n");
    EXPECT_EQ(changed(app::with_offset("[offsets]\n\"G54.1 P2\" = { X = 1, C = 90 } # fourth\n",
                                       "G54.1 P2", {5, 6, 7})),
              "[offsets]\n\"G54.1 P2\" = { X = 5, C = 90, Y = 6, Z = 7 } # fourth\n");
    EXPECT_EQ(changed(app::without_offset("mesh_size = 1\n[offsets]\nG54 = { X = 1 }\n", "G54")),
              "mesh_size = 1\n");
}

TEST(SetupChanges, ChangeAnOffsetUnderTheNameThatItHas) {
    const std::string siemens = "[offsets]\nG505 = { X = 1, Y = 2, Z = 3 } # on the left\n";
    EXPECT_EQ(changed(app::with_offset(siemens, "G58", {5, 2, 3})),
              "[offsets]\nG505 = { X = 5, Y = 2, Z = 3 } # on the left\n");
    EXPECT_EQ(changed(app::with_offset("[offsets]\n\"G154 P2\" = { X = 1, Y = 0, Z = 0 }\n",
                                       "G54.1 P2", {2, 0, 0})),
              "[offsets]\n\"G154 P2\" = { X = 2, Y = 0, Z = 0 }\n");
    EXPECT_EQ(changed(app::without_offset("mesh_size = 1\n" + siemens, "G58")), "mesh_size = 1\n");
    const app::StatedSetup stated = app::stated_in(siemens);
    EXPECT_TRUE(stated.has_offset("G58"));
    EXPECT_EQ(stated.origins.at("G58"), core::Vec3(1, 2, 3));
}

TEST(SetupChanges, StateMinimumClearancesOfPairs) {
    std::string text = changed(app::with_new_pair_allowance(
        "allowance = 3 # all\n[stock]\nbox = [[0, 0, 0], [1, 1, 1]]\n", {"flutes", "post"}, 7.5));
    EXPECT_THAT(text, HasSubstr("[[allowance]]\ndistance = 3\n"));
    EXPECT_THAT(text,
                HasSubstr("[[allowance]]\nbetween = [\"flutes\", \"post\"]\ndistance = 7.5\n"));
    text = changed(app::with_new_pair_allowance(text, {"holder", "stock"}, 0.5));
    auto stated = app::stated_in(text).allowances;
    ASSERT_EQ(stated.size(), 2u);
    EXPECT_EQ(stated[0].index, 1u);
    EXPECT_EQ(stated[1].between[0], "holder");
    EXPECT_EQ(stated[1].distance, 0.5);
    text = changed(app::with_pair_allowance(text, 2, 0.25));
    text = changed(app::without_pair_allowance(text, 1));
    stated = app::stated_in(text).allowances;
    ASSERT_EQ(stated.size(), 1u);
    EXPECT_EQ(stated[0].distance, 0.25);
    text = changed(app::without_pair_allowance(text, 1));
    EXPECT_TRUE(app::stated_in(text).allowances.empty());
    for (const double wrong : {-1.0, 1000.5, std::nan("")}) {
        EXPECT_FALSE(app::with_allowance(text, wrong)) << wrong;
        EXPECT_FALSE(app::with_pair_allowance(text, 0, wrong)) << wrong;
    }
    EXPECT_THAT(changed(app::with_new_pair_allowance("length_unit = \"inch\"\n", {"a", "b"}, 25.4)),
                HasSubstr("distance = 1\n"));
}

TEST(SetupChanges, WriteRoundNumbers) {
    EXPECT_EQ(app::setup_number(-14.700000000000045), "-14.7");
    EXPECT_EQ(app::setup_number(-0.0), "0");
    EXPECT_EQ(app::setup_number(25.4 / 3), "8.466667");
    EXPECT_EQ(app::setup_vector({1, 2.5, -1e-9}), "[1, 2.5, 0]");
}

TEST(SetupDocument, UndoesAndRedoesEveryEdit) {
    SetupDocument document("s.toml", "a = 1\n");
    const auto set = [&](const std::string& text, const std::string& mark = "") {
        return document.edit(
            "Set " + text, [&](const std::string&) { return text; }, mark);
    };
    EXPECT_FALSE(document.is_modified());
    ASSERT_TRUE(set("b"));
    ASSERT_TRUE(set("c1", "drag"));
    ASSERT_TRUE(set("c2", "drag"));
    ASSERT_TRUE(set("c3", "drag"));
    document.end_sequence();
    ASSERT_TRUE(set("d", "drag"));
    EXPECT_EQ(document.undo_title(), "Set d");
    document.undo();
    EXPECT_EQ(document.text(), "c3");
    EXPECT_EQ(document.redo_title(), "Set d");
    document.undo();
    EXPECT_EQ(document.text(), "b") << "one drag is one step";
    document.undo();
    EXPECT_EQ(document.text(), "a = 1\n");
    EXPECT_FALSE(document.is_modified());
    document.undo();
    EXPECT_EQ(document.text(), "a = 1\n");
    for (int i = 0; i < 5; ++i) document.redo();
    EXPECT_EQ(document.text(), "d");
    document.undo();
    ASSERT_TRUE(set("e"));
    EXPECT_EQ(document.redo_title(), "") << "a new edit ends what could be redone";
    const uint64_t version = document.version();
    EXPECT_FALSE(document.edit("No", [](const std::string&) -> core::Result<std::string> {
        return core::fail(core::ErrorCode::invalid_value, "no");
    }));
    EXPECT_EQ(document.version(), version);
    EXPECT_EQ(document.text(), "e");
    document.file_changed("f");
    EXPECT_FALSE(document.is_modified());
    document.undo();
    EXPECT_EQ(document.text(), "e") << "nothing is lost when the file changes";
    EXPECT_TRUE(document.is_modified());
    EXPECT_TRUE(document.takes_back_file());
    document.redo();
    EXPECT_FALSE(document.takes_back_file());
    document.undo();
    ASSERT_TRUE(set("g"));
    EXPECT_TRUE(document.takes_back_file());
    document.saved_as("x.toml");
    EXPECT_FALSE(document.takes_back_file());
    document.file_changed("h");
    document.file_changed("i");
    document.undo();
    document.undo();
    document.redo();
    EXPECT_TRUE(document.takes_back_file()) << "the second change is still undone";
    document.redo();
    EXPECT_FALSE(document.takes_back_file());
}

TEST(SavedSetup, DoesNotWriteOverAChangeThatWasUndone) {
    OwnProgram own;
    const std::string path = own.folder.write("s.toml", "mesh_size = 1\n");
    SetupDocument document(path, "mesh_size = 1\n");
    own.folder.write("s.toml", "mesh_size = 2 # mine\n");
    document.file_changed("mesh_size = 2 # mine\n");
    document.undo();
    const auto save = [&](app::Replacing replacing) {
        return app::save_setup(document, path, replacing, own.job.program, app::write_output);
    };
    const auto refused = save(app::Replacing::refused);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("which you have undone"));
    EXPECT_EQ(bytes_of(path), "mesh_size = 2 # mine\n");
    EXPECT_TRUE(save(app::Replacing::allowed));
    EXPECT_EQ(bytes_of(path), "mesh_size = 1\n");
}

#ifndef _WIN32
TEST(SavedSetup, KeepsThePermissionsOfItsFile) {
    OwnProgram own;
    const std::string path = own.folder.write("s.toml", "mesh_size = 1\n");
    using std::filesystem::perms;
    for (const perms mode : {perms{0600}, perms{0640}, perms{0664}}) {
        std::filesystem::permissions(path, mode);
        ASSERT_TRUE(app::write_output(path, "mesh_size = 2\n"));
        EXPECT_EQ(std::filesystem::status(path).permissions(), mode);
    }
}
#endif

TEST(SavedSetup, LeavesAReadOnlyFileAlone) {
    OwnProgram own;
    const std::string path = own.folder.write("s.toml", "mesh_size = 1\n");
    using std::filesystem::perms;
    std::filesystem::permissions(path, perms{0444});
    const auto written = app::write_output(path, "mesh_size = 2\n");
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message, HasSubstr("is read-only"));
    EXPECT_EQ(bytes_of(path), "mesh_size = 1\n");
    std::filesystem::permissions(path, perms{0644});
    EXPECT_TRUE(app::write_output(path, "mesh_size = 2\n"));
}

TEST(SavedSetup, NeverReplacesAFileUnasked) {
    OwnProgram own;
    const std::string path = own.folder.write("s.toml", "mine\n");
    SetupDocument document("", "");
    ASSERT_TRUE(document.edit("Edit", [](const auto&) { return std::string("mesh_size = 1\n"); }));
    const auto save = [&](const std::string& to, app::Replacing replacing) {
        return app::save_setup(document, to, replacing, own.job.program, app::write_output);
    };
    const auto refused = save(path, app::Replacing::refused);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("already exists"));
    EXPECT_EQ(bytes_of(path), "mine\n");
    EXPECT_TRUE(document.is_modified());
    EXPECT_FALSE(save(own.job.program, app::Replacing::allowed));
    EXPECT_EQ(bytes_of(own.job.program), pocket);
    ASSERT_TRUE(save(path, app::Replacing::allowed));
    EXPECT_EQ(bytes_of(path), "mesh_size = 1\n");
    EXPECT_FALSE(document.is_modified());
    EXPECT_TRUE(save(path, app::Replacing::refused)) << "its own file";
    EXPECT_EQ(app::setup_path(own.job), own.folder / "p.toml");
    own.folder.write("s.toml", "mesh_size = 3\n");
    const auto changed_since = save(path, app::Replacing::refused);
    ASSERT_FALSE(changed_since);
    EXPECT_THAT(changed_since.error().message, HasSubstr("changed by another program"));
    EXPECT_EQ(own.folder.names().size(), 2u) << "no other file remains";
}

TEST(SavedSetup, StaysNextToTheProgramIfItNamesFilesThere) {
    OwnProgram own;
    const test_support::ScopedFolder other;
    SetupDocument document("", "");
    ASSERT_TRUE(document.edit("Add", [](const std::string& text) {
        return app::with_fixture(text, "vise", "mesh = \"vise.stl\"\n");
    }));
    const auto save = [&](const std::string& path) {
        return app::save_setup(document, path, app::Replacing::refused, own.job.program,
                               app::write_output);
    };
    const auto refused = save(other / "s.toml");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("save it in"));
    EXPECT_TRUE(save(own.folder / "s.toml"));
}

TEST(SavedSetup, StaysInTheFolderOfTheFilesThatItNames) {
    const test_support::ScopedFolder folder;
    const std::string path = assets + "setups/clamped_plate.toml";
    SetupDocument document(path, bytes_of(path));
    const auto refused = app::save_setup(document, folder / "s.toml", app::Replacing::refused, "",
                                         app::write_output);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("save it in"));
}

} // namespace
} // namespace app_test
