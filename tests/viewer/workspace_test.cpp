#include <chrono>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/base/sha256.h"
#include "app/check/setup_sheet.h"
#include "app/commands/output.h"
#include "app/setup/presets/preset.h"
#include "app/setup/setup_changes.h"
#include "app/setup/stated_setup.h"
#include "app/view/model/placing.h"
#include "app/view/model/preset_fixture.h"
#include "app/view/model/samples.h"
#include "app/view/model/unsaved_setup.h"
#include "app/view/model/view_model.h"
#include "app/view/model/workspace.h"
#include "tests/support/scoped_folder.h"

namespace {

using namespace app::viewer;
using app::SetupDocument;
using test_support::bytes_of;
using testing::HasSubstr;
using Kind = SetupItem::Kind;

/// A window with a program and the assumed set-up of a worker.
ViewModel opened_model(const std::string& text = {}, const std::string& path = {},
                       bool is_inch = false) {
    ViewModel model;
    OpenedProgram opened;
    opened.is_inch = is_inch;
    opened.program = "/jobs/plate.nc";
    opened.proposed_path = "/jobs/plate.toml";
    auto sheet = std::make_shared<app::SetupSheet>();
    sheet->frame = "G54";
    sheet->stock = {core::SolidBox{{{0, 0, -10}, {120, 80, 0}}}, 0.0};
    sheet->stock_source = app::SetupSource::assumed;
    core::ToolDescription tool;
    tool.number = core::ToolNumber{3};
    tool.diameter = 6.0;
    tool.flute_length = 18.0;
    sheet->tools.push_back({tool, app::SetupSource::assumed, "because", {}});
    sheet->offsets.push_back({"G54", {0, 0, -500}, app::SetupSource::assumed, true, "G54"});
    opened.sheet = sheet;
    opened.setup_text = text;
    model.program = std::make_shared<const OpenedProgram>(opened);
    open_document(model, SetupDocument(path, text));
    return model;
}

const std::string& text_of_setup(const ViewModel& model) { return model.workspace.document.text(); }

std::vector<std::string> titles(const ViewModel& model) {
    std::vector<std::string> all;
    for (const SetupRow& row : rows_of_setup(model)) all.push_back(row.title);
    return all;
}

TEST(Workspace, ShowsTheSetupAsATree) {
    const ViewModel model = opened_model(
        "[[fixture]]\nname = \"vise\"\nbox = [[0, 0, 0], [10, 20, 30]]\n[part]\nmesh = "
        "\"a/part.stl\"\n");
    EXPECT_EQ(titles(model), (std::vector<std::string>{"Machine", "Work offsets", "G54", "Stock",
                                                       "Fixtures", "vise", "Part", "Tools",
                                                       "T3  flat 6.00", "Minimum clearance"}));
    const auto rows = rows_of_setup(model);
    EXPECT_TRUE(rows[0].is_missing);
    EXPECT_EQ(rows[3].source, app::SetupSource::assumed);
    EXPECT_EQ(rows[5].detail, "10.00 x 20.00 x 30.00 mm");
    EXPECT_EQ(rows[6].detail, "part.stl");
    EXPECT_EQ(rows[8].detail, "no holder");
}

TEST(Workspace, StatesWhatIsAssumedWithOneClick) {
    ViewModel model = opened_model();
    const SetupItem stock{Kind::stock, {}, {}}, offset{Kind::offset, "G54", {}},
        tool{Kind::tool, {}, core::ToolNumber{3}};
    for (const SetupItem& item : {stock, offset, tool}) {
        EXPECT_TRUE(can_state(model, item));
        state_item(model, item);
        EXPECT_EQ(model.workspace.refusal, "");
    }
    EXPECT_THAT(text_of_setup(model), HasSubstr("box = [[0, 0, -10], [120, 80, 0]]"));
    EXPECT_THAT(text_of_setup(model), HasSubstr("G54 = { X = 0, Y = 0, Z = -500 }"));
    EXPECT_THAT(text_of_setup(model), HasSubstr("number = 3\nshape = \"flat\"\ndiameter = 6"));
    for (int i = 0; i < 3; ++i) undo(model, 0.0);
    EXPECT_EQ(text_of_setup(model), "");
}

TEST(Workspace, NamesToolsThatNothingDescribesBesideTheFirstStatedOne) {
    ViewModel model = opened_model();
    auto opened = std::make_shared<OpenedProgram>(*model.program);
    auto sheet = std::make_shared<app::SetupSheet>(*opened->sheet);
    app::SheetTool guess = sheet->tools.at(0), of_comment = guess;
    guess.tool.number = core::ToolNumber{4};
    guess.is_guess = true;
    of_comment.tool.number = core::ToolNumber{5};
    sheet->tools.insert(sheet->tools.end(), {guess, of_comment});
    opened->sheet = sheet;
    model.program = opened;
    add_box(model);
    EXPECT_THAT(text_of_setup(model), testing::Not(HasSubstr("[[tool]]")))
        << "nothing is lost while no tool is stated";
    state_item(model, {Kind::tool, {}, core::ToolNumber{3}});
    EXPECT_THAT(text_of_setup(model), HasSubstr("[[tool]]\nnumber = 4\n"));
    EXPECT_THAT(text_of_setup(model), testing::Not(HasSubstr("number = 5")));
    model.workspace.selected = {Kind::tool, {}, core::ToolNumber{4}};
    delete_selected(model);
    EXPECT_THAT(text_of_setup(model), testing::Not(HasSubstr("number = 4")));
    state_item(model, {Kind::stock, {}, {}});
    EXPECT_THAT(text_of_setup(model), testing::Not(HasSubstr("number = 4"))) << "it was deleted";
    for (int i = 0; i < 3; ++i) undo(model, 0.0);
    EXPECT_THAT(text_of_setup(model), testing::Not(HasSubstr("[[tool]]")));
}

TEST(Workspace, ShowsAToolThatTheSetupLacks) {
    ViewModel model = opened_model();
    auto opened = std::make_shared<OpenedProgram>(*model.program);
    auto sheet = std::make_shared<app::SetupSheet>(*opened->sheet);
    app::SheetTool missing{.source = app::SetupSource::assumed, .is_described = false};
    missing.tool.number = core::ToolNumber{4};
    sheet->tools.push_back(missing);
    opened->sheet = sheet;
    model.program = opened;
    const SetupItem tool{Kind::tool, {}, core::ToolNumber{4}};
    EXPECT_THAT(titles(model), testing::Contains("T4"));
    EXPECT_FALSE(can_state(model, tool)) << "nothing is known of it";
    model.workspace.selected = tool;
    copy_selected(model);
    EXPECT_EQ(text_of_setup(model), "");
    describe_tool(model, core::ToolNumber{4});
    EXPECT_THAT(text_of_setup(model), HasSubstr("[[tool]]\nnumber = 4\n"));
    undo(model, 0.0);
    EXPECT_EQ(text_of_setup(model), "");
}

TEST(Workspace, KeepsTheRowsOfATextThatIsDamaged) {
    const std::string text = "[[fixture]]\nname = \"vise\"\nbox = [[0, 0, 0], [10, 20, 30]]\n";
    ViewModel model = opened_model(text, "/jobs/plate.toml");
    take_file(model, "[offsets]\nG54 = { X = 1q }\n" + text);
    EXPECT_THAT(titles(model), testing::Contains("vise"));
    add_box(model);
    EXPECT_THAT(model.workspace.refusal, HasSubstr("Correct the set-up file first"));
    take_file(model, "[offsets]\nG54 = { X = 1 }\n");
    EXPECT_THAT(titles(model), testing::Not(testing::Contains("vise")));
}

TEST(Workspace, StatesAStockThatTheFileCallsAssumed) {
    const std::string stock = "[stock] # sawn\nbox = [[0, 0, -10], [120, 80, 0]]\n";
    ViewModel model = opened_model("assumed = [\"stock\"]\n" + stock, "/jobs/plate.toml");
    state_item(model, {Kind::stock, {}, {}});
    EXPECT_EQ(text_of_setup(model), stock);
}

TEST(Workspace, EditsStartFromTheTextAndNotFromTheLastCheck) {
    ViewModel model = opened_model("[offsets]\nG54 = { X = -300, Y = -150, Z = -450 } # probed\n",
                                   "/jobs/plate.toml");
    EXPECT_TRUE(is_current(model));
    const app::SheetOffset old{"G54", {0, 0, -500}, app::SetupSource::stated, true};
    // The check does not come, as with an error elsewhere in the set-up.
    for (int axis = 0; axis < 3; ++axis) {
        core::Vec3 origin = origin_of(*model.workspace.stated, old);
        origin[axis] += 7.0;
        edit_setup(model, "Change G54",
                   [&](const std::string& t) { return app::with_offset(t, "G54", origin); });
        EXPECT_FALSE(is_current(model));
    }
    EXPECT_THAT(text_of_setup(model), HasSubstr("G54 = { X = -293, Y = -143, Z = -443 } # probed"));
    undo(model, 0.0);
    EXPECT_EQ(model.workspace.replacements, 1u) << "fields forget what was typed";
}

TEST(Workspace, AddsCopiesRenamesAndDeletesWithUndo) {
    ViewModel model = opened_model();
    add_box(model);
    EXPECT_EQ(model.workspace.selected, (SetupItem{Kind::fixture, "block-1", {}}));
    EXPECT_THAT(text_of_setup(model), HasSubstr("at = [-50, 0, -10]"));
    const std::string first = text_of_setup(model);
    copy_selected(model);
    EXPECT_EQ(model.workspace.selected.name, "block-2");
    rename_selected(model, "jaw");
    EXPECT_THAT(titles(model), testing::IsSupersetOf({"block-1", "jaw"}));
    rename_selected(model, "block-1");
    EXPECT_THAT(model.workspace.refusal, HasSubstr("already"));
    EXPECT_EQ(model.workspace.selected.name, "jaw");
    delete_selected(model);
    EXPECT_EQ(model.workspace.selected.kind, Kind::none);
    EXPECT_EQ(text_of_setup(model), first);
    undo(model, 0.0);
    EXPECT_NE(model.workspace.stated->fixture("jaw"), nullptr);
    undo(model, 0.0);
    undo(model, 0.0);
    EXPECT_EQ(text_of_setup(model), first);
    redo(model, 0.0);
    EXPECT_NE(model.workspace.stated->fixture("block-2"), nullptr);
}

TEST(Workspace, DeletesAFixtureWithWhatStandsOnIt) {
    const std::string clamp = "[[fixture]]\nname = \"clamp\"\nbox = [[0, 0, 0], [1, 1, 1]]\n";
    const std::string text = "[[fixture]]\nname = \"vise\"\nbox = [[0, 0, 0], [9, 9, 9]]\n"
                             "[[fixture]] # fixed\nname = \"jaw\"\nbox = [[0, 0, 0], [1, 1, 1]]\n"
                             "frame = \"vise\"\n[[fixture]]\nname = \"pad\"\nbox = [[0, 0, 0], "
                             "[1, 1, 1]]\nframe = \"jaw\"\n"
                             + clamp;
    ViewModel model = opened_model(text, "/jobs/plate.toml");
    model.workspace.selected = {Kind::fixture, "vise", {}};
    delete_selected(model);
    EXPECT_EQ(model.workspace.refusal, "");
    EXPECT_EQ(text_of_setup(model), clamp);
    EXPECT_EQ(model.workspace.document.undo_title(), "Delete vise and 2 that stand on it");
    undo(model, 0.0);
    EXPECT_EQ(text_of_setup(model), text);
}

TEST(Workspace, BeginsInTheUnitOfTheProgram) {
    ViewModel model = opened_model({}, {}, true);
    model.settings.inch = true;
    delete_selected(model);
    EXPECT_EQ(text_of_setup(model), "");
    EXPECT_FALSE(edit_setup(model, "Delete the jaw", [](const std::string& text) {
        return app::without_fixture(text, "jaw");
    }));
    EXPECT_EQ(text_of_setup(model), "") << "nothing was changed";
    add_box(model);
    EXPECT_THAT(text_of_setup(model), testing::StartsWith("length_unit = \"inch\"\n"));
    EXPECT_THAT(text_of_setup(model), HasSubstr("box = [[0, 0, 0], [2, 1, 1]]"));
    EXPECT_EQ(rows_of_setup(model)[5].detail, "2.0000 x 1.0000 x 1.0000 in");
    undo(model, 0.0);
    EXPECT_EQ(text_of_setup(model), "");
    state_item(model, {Kind::offset, "G54", {}});
    EXPECT_THAT(text_of_setup(model), HasSubstr("Z = -19.68503937 }"));
    EXPECT_EQ(rows_of_setup(model)[2].detail, "0.0000, 0.0000, -19.6850");
    // A set-up in mm stays in mm.
    ViewModel other = opened_model("mesh_size = 1\n", "/jobs/plate.toml", true);
    add_box(other);
    EXPECT_THAT(text_of_setup(other), HasSubstr("box = [[0, 0, 0], [50, 25, 25]]"));
    EXPECT_THAT(text_of_setup(other), testing::Not(HasSubstr("length_unit")));
}

TEST(Workspace, NamesMeshesRelativeToItsFolder) {
    ViewModel model = opened_model();
    EXPECT_EQ(path_in_setup(model, "/jobs/meshes/vise.stl"), "meshes/vise.stl");
    EXPECT_EQ(path_in_setup(model, "/other/vise.stl"), "/other/vise.stl");
    add_mesh(model, "/jobs/meshes/vise.stl");
    EXPECT_THAT(text_of_setup(model), HasSubstr("name = \"vise\"\nmesh = \"meshes/vise.stl\""));
}

/// The stock measures 120 x 80 x 10; vise-4 opens to 130 mm.
TEST(Workspace, PutsAViseAroundTheStockTurnedIfItMustBe) {
    ViewModel model = opened_model();
    add_preset(model, *app::find_preset("vise-4"));
    EXPECT_THAT(text_of_setup(model), HasSubstr("opening = 80\nat = [60, 80, "));
    auto with_stock = [&](const core::Vec3& size) {
        model = opened_model();
        OpenedProgram opened = *model.program;
        auto sheet = std::make_shared<app::SetupSheet>(*opened.sheet);
        sheet->stock = {core::SolidBox{{{0, 0, -10}, {size.x, size.y, 0}}}, 0.0};
        opened.sheet = sheet;
        model.program = std::make_shared<const OpenedProgram>(opened);
        add_preset(model, *app::find_preset("vise-4"));
    };
    with_stock({100, 300, 10});
    EXPECT_THAT(text_of_setup(model), HasSubstr("opening = 100\nat = [0, 150, "));
    EXPECT_THAT(text_of_setup(model), HasSubstr("rotate_deg = [0, 0, 90]"));
    EXPECT_EQ(model.workspace.refusal, "");
    EXPECT_TRUE(usual_grip(model, *model.workspace.stated->fixture("vise-4")));
    with_stock({400, 300, 10});
    EXPECT_THAT(text_of_setup(model), testing::Not(HasSubstr("opening")));
    EXPECT_THAT(model.workspace.refusal, HasSubstr("it stands beside the stock"));
}

TEST(Workspace, ChangesTheFrameThatCannotBeRead) {
    ViewModel model = opened_model("[stock]\nbox = [[0, 0, 0], [1, 1, 1]]\nframe = \"G55\"\n");
    model.workspace.error = core::Error{core::ErrorCode::invalid_value, {}, "no such offset"};
    EXPECT_TRUE(change_frame(model, "stock", "G54"));
    EXPECT_EQ(text_of_setup(model), "[stock]\nbox = [[0, 0, 0], [1, 1, 1]]\nframe = \"G54\"\n");
}

TEST(Workspace, AddsFilesByTheirKind) {
    const test_support::ScopedFolder folder;
    ViewModel model = opened_model("", folder / "p.toml");
    EXPECT_TRUE(add_file(model, folder / "a/VISE.STL"));
    EXPECT_TRUE(add_file(model, folder / "shop.tools"));
    EXPECT_TRUE(add_file(model, folder.write("mill.toml", "[[axis]]\nname = \"X\"\n")));
    EXPECT_TRUE(add_file(model, folder / "emc/mill.ini"));
    EXPECT_FALSE(add_file(model, folder.write("other.toml", "[stock]\n"))) << "a set-up";
    EXPECT_FALSE(add_file(model, folder / "p.nc"));
    add_part(model, folder / "part.stl");
    EXPECT_EQ(text_of_setup(model),
              "tool_library = \"shop.tools\"\n\n[[fixture]]\nname = \"VISE\"\nmesh = "
              "\"a/VISE.STL\"\nat = [0, 0, 0]\nframe = \"G54\"\n\n[machine]\nfile = "
              "\"mill.toml\"\n\n[program]\nini = \"emc/mill.ini\"\n\n[part]\nmesh = "
              "\"part.stl\"\nframe = \"G54\"\n");
    EXPECT_EQ(model.workspace.selected.kind, Kind::part);
    use_tool_library(model, "");
    use_machine(model, "");
    use_ini(model, "");
    EXPECT_EQ(text_of_setup(model).find("shop"), std::string::npos);
    EXPECT_EQ(text_of_setup(model).find("mill"), std::string::npos);
}

TEST(Workspace, ExchangesAToolForAnother) {
    ViewModel model =
        opened_model("[[tool]]\nnumber = 3 # in pocket 7\nshape = \"flat\"\ndiameter = 6\n"
                     "flute_length = 18\ncorner_radius = 1\n");
    app::FoundTool found{.tool = {}, .has_shape = true, .source = "shop.tools"};
    core::ToolDescription& tool = found.tool;
    tool.number = core::ToolNumber{40};
    tool.shape = core::ToolShape::drill;
    tool.diameter = 8.5;
    tool.point_deg = 140.0;
    tool.stick_out = 75.0;
    take_library_tool(model, core::ToolNumber{3}, found);
    EXPECT_EQ(text_of_setup(model),
              "[[tool]]\nnumber = 3 # in pocket 7\nshape = \"drill\"\ndiameter = 8.5\n"
              "flute_length = \"unknown\"\npoint_deg = 140\nshank_diameter = "
              "\"unknown\"\nstick_out = 75\n")
        << "states what the library states";
    edit_setup(model, "Choose a holder", [](const std::string& text) {
        return app::toml_with_value(text, {"tool", size_t{0}, "holder"}, "\"BT40-ER32\"");
    });
    take_library_tool(model, core::ToolNumber{3}, found);
    EXPECT_THAT(text_of_setup(model), HasSubstr("holder = \"BT40-ER32\"\n")) << "it stays";
    tool.holder = {{30.0, 40.0, 25.0}};
    take_library_tool(model, core::ToolNumber{3}, found);
    EXPECT_THAT(text_of_setup(model), HasSubstr("30, 40, 25"));
}

TEST(Workspace, AddsCopiesAndRenumbersTools) {
    ViewModel model = opened_model("[[tool]]\nnumber = 3\nstick_out = 50\n");
    add_tool(model);
    EXPECT_EQ(model.workspace.selected, (SetupItem{Kind::tool, {}, core::ToolNumber{4}}));
    EXPECT_THAT(text_of_setup(model),
                HasSubstr("[[tool]]\nnumber = 4\nshape = \"flat\"\ndiameter = 10\n"));
    model.workspace.selected = {Kind::tool, {}, core::ToolNumber{3}};
    copy_selected(model);
    EXPECT_EQ(model.workspace.selected.tool, core::ToolNumber{5});
    EXPECT_THAT(text_of_setup(model), HasSubstr("[[tool]]\nnumber = 5\nstick_out = 50\n"));
    renumber_selected(model, core::ToolNumber{12});
    EXPECT_EQ(model.workspace.selected.tool, core::ToolNumber{12});
    EXPECT_THAT(text_of_setup(model), HasSubstr("[[tool]]\nnumber = 12\nstick_out = 50\n"));
    const std::string before = text_of_setup(model);
    renumber_selected(model, core::ToolNumber{3});
    EXPECT_EQ(text_of_setup(model), before);
    EXPECT_THAT(model.workspace.refusal, HasSubstr("tool 3 already"));
    delete_selected(model);
    EXPECT_EQ(text_of_setup(model).find("12"), std::string::npos);
}

TEST(Workspace, MarksWhatAnErrorIsAbout) {
    ViewModel model =
        opened_model("mesh_size = 1\n[stock]\nbox = 3\n\n[[fixture]]\nname = \"a\"\n"
                     "box = [[0, 0, 0], [1, 1, 1]]\n\n[[tool]]\nnumber = 3\nstick = 1\n"
                     "[program]\nstart = 1\n");
    const auto item = [&](uint32_t line) { return item_at_line(model.workspace, line); };
    EXPECT_EQ(item(1).kind, Kind::none);
    EXPECT_EQ(item(3).kind, Kind::stock);
    EXPECT_EQ(item(7), (SetupItem{Kind::fixture, "a", {}}));
    EXPECT_EQ(item(11), (SetupItem{Kind::tool, {}, core::ToolNumber{3}}));
    EXPECT_EQ(item(13).kind, Kind::none);
    model.workspace.error = core::Error{core::ErrorCode::invalid_value, {3, 1, 0}, "no"};
    size_t marked = 0;
    for (const SetupRow& row : rows_of_setup(model)) {
        marked += row.has_error;
        EXPECT_EQ(row.has_error, row.item.kind == Kind::stock);
    }
    EXPECT_EQ(marked, 1u);
}

TEST(Workspace, SavesUnderItsNameOrAsksForOne) {
    const test_support::ScopedFolder folder;
    ViewModel model = opened_model();
    add_box(model);
    EXPECT_FALSE(save_document(model, "", app::write_output, 0.0));
    EXPECT_TRUE(model.workspace.is_naming);
    EXPECT_TRUE(save_document(model, folder / "s.toml", app::write_output, 0.0));
    EXPECT_FALSE(model.workspace.is_naming || model.workspace.document.is_modified());
    EXPECT_EQ(bytes_of(folder / "s.toml"), text_of_setup(model));
    copy_selected(model);
    EXPECT_TRUE(save_document(model, "", app::write_output, 0.0));
    folder.write("s.toml", "changed = 1\n");
    copy_selected(model);
    EXPECT_FALSE(save_document(model, "", app::write_output, 0.0));
    EXPECT_THAT(model.workspace.refusal, HasSubstr("changed by another program"));
    EXPECT_EQ(bytes_of(folder / "s.toml"), "changed = 1\n");
    model.workspace.may_replace = true;
    EXPECT_TRUE(save_document(model, "", app::write_output, 0.0));
    EXPECT_EQ(bytes_of(folder / "s.toml"), text_of_setup(model));
    // Nothing has changed, so nothing is written, unless the file is gone.
    size_t written = 0;
    const auto count = [&](const std::string& path, const std::string& text) {
        ++written;
        return app::write_output(path, text);
    };
    EXPECT_TRUE(save_document(model, "", count, 0.0));
    EXPECT_EQ(written, 0u);
    std::filesystem::remove(folder / "s.toml");
    EXPECT_TRUE(save_document(model, "", count, 0.0));
    EXPECT_EQ(written, 1u);
}

TEST(Workspace, SavesNothingAmongTheSamples) {
    const test_support::ScopedFolder folder;
    std::filesystem::create_directories(folder.path() / "samples/setups");
    std::filesystem::create_directories(folder.path() / "mine");
    const std::string sample = folder / "samples/setups/plate.toml";
    const std::string text = "[machine]\nfile = \"../machines/mill.toml\" # of the shop\n\n"
                             "[[fixture]]\nname = \"a\"\nmesh = \"../meshes/a.stl\"\n\n"
                             "[[fixture]]\nname = \"b\"\nmesh = \"/whole/b.stl\"\n";
    std::ofstream(sample) << text;
    ViewModel model = opened_model(text, sample);
    model.samples = folder / "samples";
    add_box(model);
    for (const std::string& target : {std::string(), sample, folder / "samples/new.toml"}) {
        model.workspace.may_replace = true;
        EXPECT_FALSE(save_document(model, target, app::write_output, 0.0));
        EXPECT_TRUE(model.workspace.is_naming);
        EXPECT_FALSE(is_below(model.workspace.file_name, model.samples));
        EXPECT_THAT(model.workspace.refusal, HasSubstr("samples"));
    }
    EXPECT_EQ(bytes_of(sample), text);
    EXPECT_FALSE(std::filesystem::exists(folder / "samples/new.toml"));
    ASSERT_TRUE(save_document(model, folder / "mine/plate.toml", app::write_output, 0.0))
        << model.workspace.refusal;
    const std::string saved = bytes_of(folder / "mine/plate.toml");
    EXPECT_THAT(saved, HasSubstr(folder / "samples/machines/mill.toml\" # of the shop"));
    EXPECT_THAT(saved, HasSubstr("mesh = \"" + (folder / "samples/meshes/a.stl")));
    EXPECT_THAT(saved, HasSubstr("mesh = \"/whole/b.stl\""));
    EXPECT_EQ(model.workspace.document.path(), folder / "mine/plate.toml");
}

TEST(UnsavedSetups, AreFoundAgainUntilForgotten) {
    const test_support::ScopedFolder folder;
    const UnsavedSetups kept(folder / "unsaved", app::write_output);
    const std::string text = "# set-up: no\nmesh_size = 2\r\n\n";
    EXPECT_TRUE(kept.find("a.nc", "", "").empty());
    const std::filesystem::path file = kept.free_file("a.nc", "").path;
    EXPECT_TRUE(kept.keep(file, "a.nc", "", text, "old"));
    const std::vector<UnsavedSetup> found = kept.find("./a.nc", "", "");
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].base, app::sha256_of("old"));
    EXPECT_EQ(found[0].text, text);
    EXPECT_EQ(found[0].file, file);
    EXPECT_TRUE(kept.find("a.nc", "a.toml", "").empty()) << "another set-up";
    EXPECT_TRUE(kept.find("a.nc", "", text).empty()) << "it was saved";
    kept.forget(file);
    EXPECT_TRUE(kept.find("a.nc", "", "").empty());
    EXPECT_TRUE(UnsavedSetups().find("a.nc", "", "").empty());
    EXPECT_FALSE(UnsavedSetups().keep(file, "a.nc", "", text, "old"));
}

TEST(UnsavedSetups, OfTwoSessionsAreKeptApart) {
    const test_support::ScopedFolder folder;
    const UnsavedSetups kept(folder / "unsaved", app::write_output);
    auto held = std::optional(kept.free_file("a.nc", ""));
    const std::filesystem::path first = held->path, second = kept.free_file("a.nc", "").path;
    EXPECT_NE(first, second);
    EXPECT_TRUE(kept.keep(first, "a.nc", "", "x = 1\n", ""));
    EXPECT_TRUE(kept.keep(second, "a.nc", "", "x = 2\n", ""));
    ASSERT_EQ(kept.find("a.nc", "", "").size(), 1U) << "one of the sessions has not ended";
    EXPECT_EQ(kept.find("a.nc", "", "")[0].text, "x = 2\n");
    held.reset();
    EXPECT_NE(kept.free_file("a.nc", "").path, first) << "it keeps edits";
    std::filesystem::last_write_time(first,
                                     std::filesystem::last_write_time(second)
                                         + std::chrono::seconds(5)); // edited again
    const std::vector<UnsavedSetup> found = kept.find("a.nc", "", "");
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].text, "x = 2\n");
    EXPECT_EQ(found[1].text, "x = 1\n");
    kept.forget(first);
    EXPECT_EQ(kept.free_file("a.nc", "").path, first);
    ASSERT_EQ(kept.find("a.nc", "", "").size(), 1U);
    EXPECT_EQ(kept.find("a.nc", "", "x = 2\n").size(), 0U);
}

TEST(UnsavedSetups, DamagedFilesAreIgnored) {
    const UnsavedSetup unsaved{"/p.nc", "", "x = 1\n"};
    const std::string whole = text_of(unsaved);
    for (size_t length = 0; length + unsaved.text.size() < whole.size(); ++length) {
        const auto read = unsaved_in(whole.substr(0, length));
        EXPECT_TRUE(!read || read->text.empty());
    }
    EXPECT_EQ(unsaved_in(whole)->text, unsaved.text);
    EXPECT_FALSE(unsaved_in("mesh_size = 1\n"));
}

} // namespace
