#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/output.h"
#include "app/view/model/navigation.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/window.h"
#include "core/base/file_reads.h"
#include "tests/support/scoped_folder.h"

namespace {

using namespace app::viewer;

FindingGroup group_of(const char* rule) {
    FindingGroup group;
    group.rule = rule;
    group.pair = {"holder", "clamp-1"};
    return group;
}

BlockRow row_in(uint32_t line, const char* code) {
    BlockRow row;
    row.line = line;
    row.text = code;
    return row;
}

TEST(FindingNotes, AreKnownAgainWhenLinesWerePutInBefore) {
    std::vector<FindingNote> notes;
    write_note(notes, "/a.nc", group_of("collision"), row_in(44, "Y75."), "raise it");
    EXPECT_EQ(note_on(notes, "/a.nc", group_of("collision"), row_in(44, "Y75.")), "raise it");
    EXPECT_EQ(note_on(notes, "/a.nc", group_of("collision"), row_in(51, "Y75.")), "raise it");
    EXPECT_EQ(note_on(notes, "/a.nc", group_of("collision"), row_in(44, "Y76.")), "");
    EXPECT_EQ(note_on(notes, "/a.nc", group_of("near-miss"), row_in(44, "Y75.")), "");
    EXPECT_EQ(note_on(notes, "/b.nc", group_of("collision"), row_in(44, "Y75.")), "");
}

TEST(FindingNotes, OfLinesThatReadTheSameTheNearestOneCounts) {
    std::vector<FindingNote> notes;
    write_note(notes, "/a.nc", group_of("collision"), row_in(10, "Y75."), "first");
    write_note(notes, "/a.nc", group_of("collision"), row_in(90, "Y75."), "second");
    EXPECT_EQ(notes.size(), 2u);
    EXPECT_EQ(note_on(notes, "/a.nc", group_of("collision"), row_in(20, "Y75.")), "first");
    EXPECT_EQ(note_on(notes, "/a.nc", group_of("collision"), row_in(70, "Y75.")), "second");
    write_note(notes, "/a.nc", group_of("collision"), row_in(10, "Y75."), "");
    EXPECT_EQ(notes.size(), 1u);
}

TEST(FindingNotes, ComeBackFromTheirFileAsTheyWere) {
    std::vector<FindingNote> notes;
    write_note(notes, "/a b/\"q\".nc", group_of("collision"), row_in(44, "(SAY \"X\" \\) Y75."),
               "raise \xC3\xBC \\ \"clamp\"");
    write_note(notes, "/b.nc", group_of("near-miss"), row_in(1, "G0"), "fine");
    EXPECT_EQ(notes_in(text_of(notes)), notes);
    EXPECT_TRUE(notes_in("[[note]\nnonsense").empty());
    EXPECT_TRUE(notes_in("note = 5\n[x]\n").empty());
    EXPECT_TRUE(notes_in("[[note]]\nprogram = 5\ntext = \"a\"\n").empty());
}

/// Programs come in code pages of Windows, and with tabs.
TEST(FindingNotes, OnALineOfAnyCodePageAreKnownAgainFromTheirFile) {
    std::vector<FindingNote> notes;
    const BlockRow umlaut = row_in(7, "G1 X5 (Tasche f\xFCr Fr\xC4SER)"), tab = row_in(8, "G1\tX6");
    ViewModel model;
    OpenedProgram opened;
    opened.program = "/fr\xE4s.nc";
    model.program = std::make_shared<const OpenedProgram>(opened);
    write_note(notes, "/b.nc", group_of("collision"), row_in(1, "G0"), "of another program");
    write_note(notes, notes_key(model), group_of("collision"), umlaut, "raise\nit");
    write_note(notes, notes_key(model), group_of("collision"), tab, "turn it");
    const auto read = notes_in(text_of(notes));
    EXPECT_EQ(read, notes);
    EXPECT_EQ(note_on(read, notes_key(model), group_of("collision"), umlaut), "raise\nit");
    EXPECT_EQ(note_on(read, notes_key(model), group_of("collision"), tab), "turn it");
    EXPECT_EQ(note_on(read, "/b.nc", group_of("collision"), row_in(1, "G0")), "of another program");
}

TEST(FindingNotes, OfOtherProgramsStay) {
    std::vector<FindingNote> kept, ours;
    write_note(kept, "/a.nc", group_of("collision"), row_in(1, "G0"), "old");
    write_note(kept, "/b.nc", group_of("collision"), row_in(1, "G0"), "of another window");
    write_note(ours, "/a.nc", group_of("collision"), row_in(1, "G0"), "new");
    const auto all = merged(kept, ours, "/a.nc");
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(note_on(all, "/a.nc", group_of("collision"), row_in(1, "G0")), "new");
    EXPECT_EQ(note_on(all, "/b.nc", group_of("collision"), row_in(1, "G0")), "of another window");
}

TEST(FindingNotes, AreSavedTogetherWithThoseOfOtherPrograms) {
    const test_support::ScopedFolder folder;
    const std::string path = folder / "new/notes.toml";
    ViewModel model;
    OpenedProgram opened;
    opened.program = "/a.nc";
    model.program = std::make_shared<const OpenedProgram>(opened);
    write_note(model.notes, "/a.nc", group_of("collision"), row_in(1, "G0"), "mine");
    keep_notes(model, path, app::write_output, 0.0);
    EXPECT_EQ(notes_in(*core::file_bytes(path)), model.notes);
    opened.program = "/b.nc";
    ViewModel other;
    other.program = std::make_shared<const OpenedProgram>(opened);
    write_note(other.notes, "/b.nc", group_of("collision"), row_in(1, "G0"), "yours");
    keep_notes(other, path, app::write_output, 0.0);
    EXPECT_EQ(other.notes.size(), 2u);
    EXPECT_EQ(notes_in(*core::file_bytes(path)).size(), 2u);
}

TEST(DroppedFiles, OfAnotherProgramTakeNoEditsAlong) {
    ViewModel model;
    app::CheckJob job;
    job.program = "a.nc";
    job.setup = "s.toml";
    job.setup_text = "allowance = 3\n";
    EXPECT_TRUE(dropped_programs(job, {"clamp.STL"}, model, 0.0).empty());
    EXPECT_TRUE(dropped_programs({}, {"s.toml"}, model, 0.0).empty());
    const auto other = dropped_programs(job, {"b.nc"}, model, 0.0);
    ASSERT_EQ(other.size(), 1u);
    EXPECT_TRUE(other[0].program == "b.nc" && other[0].setup.empty() && !other[0].setup_text);
    const auto with_setup = dropped_programs(job, {"t.TOML"}, model, 0.0);
    ASSERT_EQ(with_setup.size(), 1u);
    EXPECT_TRUE(with_setup[0].program == "a.nc" && with_setup[0].setup == "t.TOML");
}

TEST(DroppedFiles, GiveEachProgramItsSetup) {
    const auto folder = std::filesystem::path(testing::TempDir()) / "dropped";
    std::filesystem::create_directories(folder);
    const auto path = [&](const char* name) { return (folder / name).generic_string(); };
    for (const char* name : {"a.nc", "b.nc", "b.toml", "c.nc"}) {
        const auto written = app::write_output(path(name), "%\n");
        ASSERT_TRUE(written);
    }
    ViewModel model;
    const auto setups_of = [&](const std::vector<std::string>& paths) {
        std::vector<std::string> setups;
        for (const app::CheckJob& job : dropped_programs({}, paths, model, 0.0))
            setups.push_back(std::filesystem::path(job.setup).filename().generic_string());
        return setups;
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(setups_of({path("a.nc"), path("b.nc")}), (Names{"", "b.toml"})) << "next to it";
    EXPECT_EQ(setups_of({path("a.nc"), path("b.nc"), "one.toml"}), (Names{"one.toml", "one.toml"}));
    EXPECT_EQ(setups_of({"c.toml", path("a.nc"), path("c.nc"), "a.toml"}),
              (Names{"a.toml", "c.toml"}));
    EXPECT_EQ(setups_of({"x.toml", path("b.nc"), "y.toml"}), (Names{"b.toml"})) << "neither is its";
}

} // namespace
