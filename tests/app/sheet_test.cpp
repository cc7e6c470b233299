#include <regex>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "app/base/sha256.h"
#include "app/base/version.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/report/sheet/html_sheet.h"
#include "app/report/sheet/sheet_run.h"
#include "app/tolerance/tolerances.h"
#include "tests/app/checked.h"

namespace app_test {
namespace {

using app::CheckJob;
using app::CheckRun;
using app::SheetContent;
using test_support::bytes_of;
using test_support::ScopedFolder;
using testing::HasSubstr;
using testing::Not;

const std::string assets = std::string(FEELER_SOURCE_DIR) + "/assets/";
const std::string golden = std::string(FEELER_SOURCE_DIR) + "/tests/golden/sheet/";

CheckJob job_of_assets(const std::string& program, const std::string& setup) {
    return {.program = assets + "programs/" + program,
            .setup = setup.empty() ? "" : assets + "setups/" + setup};
}

SheetContent content_of(const CheckJob& job) {
    const auto check = app::read_check(job);
    if (!check) {
        ADD_FAILURE() << check.error().message;
        return {};
    }
    SheetContent content = app::sheet_content(*check, job.setup.empty() ? "" : bytes_of(job.setup));
    content.program_date = "2026-01-02 03:04";
    content.check_date = "2026-05-06 07:08";
    content.pictures.missing = "this is a test";
    return content;
}

std::string sheet_of_job(const CheckJob& job) {
    const auto run = app::run_check(job);
    if (!run) {
        ADD_FAILURE() << run.error().message;
        return {};
    }
    return app::html_sheet(*run, content_of(job));
}

/// The words of a page, a line for each row, heading and paragraph.
std::string words_of_page(std::string html) {
    const auto replace = [&html](const std::string& pattern, const std::string& by) {
        html = std::regex_replace(html, std::regex(pattern), by);
    };
    html.erase(0, html.find("<body"));
    replace("\n", "");
    replace("</t[hd]><t[hd][^>]*>", " | ");
    replace("</(tr|h1|h2|p)>", "\n");
    replace("<[^>]*>", "");
    replace("&amp;", "&");
    replace("Feeler " + std::string(app::version), "Feeler VERSION");
    return html;
}

void expect_golden(const std::string& name, const CheckJob& job) {
    const ScopedFolder folder;
    const std::string words = words_of_page(sheet_of_job(job));
    if (words == bytes_of(golden + name + "/expected.txt")) return;
    const std::string path = testing::TempDir() + "/sheet-" + name + ".txt";
    std::ofstream(path, std::ios::binary) << words;
    ADD_FAILURE() << "the sheet differs from tests/golden/sheet/" << name << "; it is in " << path
                  << "\n"
                  << words;
}

TEST(Sheet, OfAClampedPlate) {
    expect_golden("clamped_plate", job_of_assets("clamped_plate_low.nc", "clamped_plate.toml"));
}

TEST(Sheet, OfAProgramInInches) {
    expect_golden("parallel", job_of_assets("PARALLEL.NC", "parallel.toml"));
}

TEST(Sheet, OfAProgramWithoutASetup) {
    expect_golden("inferred", job_of_assets("clamped_plate.nc", ""));
}

/// A stock in a vise with two jaws, and the tools 1 and 2.
const std::string small_setup = R"(mesh_size = 2
[program]
dialect = "fanuc"
start = { X = -350, Y = -200, Z = 0 }
[stock]
box = [[0, 0, -30], [100, 100, 0]]
tolerance = 0.5
[offsets]
G54 = { X = -350, Y = -200, Z = -420 }
G55 = { X = -340, Y = -180, Z = -420 }
[[length_offset]]
number = 1
length = 95.0
[[length_offset]]
number = 7
length = 105.0
[[tool]]
number = 1
shape = "bull"
diameter = 10
corner_radius = 1
flute_length = 20
shank = [[10, 10, 25]]
holder = [[40, 40, 50]]
[[tool]]
number = 2
shape = "drill"
diameter = 8
flute_length = 40
stick_out = 55
holder = [[40, 40, 50]]
[[fixture]]
name = "jaw left"
box = [[-40, 0, -60], [0, 100, -20]]
[[fixture]]
name = "jaw right"
box = [[100, 0, -60], [140, 100, -18]]
)";

const std::string small_program = R"(O1000
G21 G90 G17 G54
T2 M6
S2000 M3
G0 G43 H7 Z60.
X20. Y30.
G1 Z20. F500.
S2500
G1 Z19. F500.
G0 Z60.
T1 M6
S6000 M3
G55
G0 G43 H1 Z60.
G41 D11 X10. Y10.
G1 X20. Y10. F500.
G40 G1 X30. Y30.
G52 X5.
G0 X20. Y20.
G52 X0.
M30
)";

struct SmallJob {
    ScopedFolder folder;
    std::string program, setup;

    explicit SmallJob(const std::string& program_text = small_program,
                      const std::string& setup_text = small_setup)
        : program(folder.write("small.nc", program_text)),
          setup(folder.write("small.toml", setup_text)) {}
    CheckJob job() const { return {.program = program, .setup = setup}; }
};

TEST(ProgramUse, ListsToolsInTheOrderOfTheirUse) {
    const SmallJob small;
    const auto check = app::read_check(small.job());
    ASSERT_TRUE(check) << check.error().message;
    const app::ProgramUse use = app::program_use(*check);
    ASSERT_EQ(use.tools.size(), 2U);
    EXPECT_EQ(use.tools[0].tool, core::ToolNumber{2});
    EXPECT_EQ(use.tools[0].lengths, std::set{core::OffsetNumber{7}});
    EXPECT_EQ(use.tools[0].control_lengths, std::set{105.0});
    EXPECT_EQ(use.tools[0].least_speed, 2000.0);
    EXPECT_EQ(use.tools[0].most_speed, 2500.0);
    EXPECT_TRUE(use.tools[0].radii.empty());
    EXPECT_EQ(use.tools[1].tool, core::ToolNumber{1});
    EXPECT_EQ(use.tools[1].radii, std::set{11});
    ASSERT_EQ(use.offsets.size(), 2U);
    EXPECT_EQ(use.offsets.at(0).origin, core::Vec3(-350, -200, -420));
    EXPECT_FALSE(use.offsets.at(0).shifted_in);
    EXPECT_EQ(use.offsets.at(1).shifted_in, 19U);
    EXPECT_FALSE(use.offsets.at(1).set_in);
}

TEST(ProgramUse, StopsWhenItIsTold) {
    const SmallJob small("O1\nG21 G90 G54\nWHILE [1 EQ 1] DO1\nG0 X#1\n#1=#1+0.001\nEND1\nM30\n");
    CheckJob job = small.job();
    job.settings.max_blocks = 10000;
    const auto check = app::read_check(job);
    ASSERT_TRUE(check) << check.error().message;
    int asked = 0;
    app::program_use(*check, [&] { return ++asked > 3; });
    EXPECT_LE(asked, 10);
}

/// A program can use any number of values; a page can not show them.
TEST(ProgramUse, KeepsAFewValuesOfEachTool) {
    std::string program = "O1\nG21 G90 G54\nT1 M6\nS1000 M3\n#1=1\nWHILE [#1 LT 200] DO1\n"
                          "G10 L10 P1 R#1\nG43 H1\nG1 X#1 F100.\n#1=#1+1\nEND1\nM30\n";
    const SmallJob small(program);
    const auto check = app::read_check(small.job());
    ASSERT_TRUE(check) << check.error().message;
    const app::ProgramUse use = app::program_use(*check);
    ASSERT_EQ(use.tools.size(), 1U);
    EXPECT_EQ(use.tools[0].control_lengths.size(), app::most_kept_values);
}

TEST(Sheet, SaysWhereEverythingIs) {
    const std::string words = words_of_page(sheet_of_job(SmallJob().job()));
    EXPECT_THAT(words, HasSubstr("G54 | the left front top corner of the stock"));
    EXPECT_THAT(words, HasSubstr("G55 | X+10 Y+20 from the left front top corner of the stock; "
                                 "line 19 moves program zero away from it | X-340 Y-180 Z-420"));
    EXPECT_THAT(words, HasSubstr("stands 18 mm out of the jaws; may be larger by 0.5 mm on every "
                                 "side"));
    EXPECT_THAT(words, HasSubstr("jaw left | vise, box | -40 to 0 | 0 to 100 | -60 to -20"));
    EXPECT_THAT(words, HasSubstr("T1 | bull nose end mill | 10 | 1 | 20 | 45 | "));
    EXPECT_LT(words.find("T2 | drill"), words.find("T1 | bull"));
}

TEST(Sheet, TellsASurfaceSpeedFromRevolutions) {
    const std::string program =
        std::regex_replace(small_program, std::regex("S6000 M3"), "G96 S120 M3");
    EXPECT_THAT(words_of_page(sheet_of_job(SmallJob(program).job())),
                HasSubstr("H1: 95 | D11 | 120 (surface speed)"));
}

/// The numbers of the program's own zero count, not those of the set-up.
TEST(Sheet, FollowsAZeroThatTheProgramSets) {
    std::string program = small_program;
    program.insert(program.find("T2 M6"), "G90 G10 L2 P1 X-340. Y-200. Z-420.\n");
    const std::string words = words_of_page(sheet_of_job(SmallJob(program).job()));
    EXPECT_THAT(words, HasSubstr("G54 | X+10 from the left front top corner of the stock"));
    EXPECT_THAT(words, HasSubstr("X-340 Y-200 Z-420, set by the program"));
}

TEST(Sheet, IsNoReleaseUnlessAllIsClear) {
    const std::string incomplete = sheet_of_job(SmallJob().job());
    EXPECT_THAT(incomplete, HasSubstr("does not release the program"));
    EXPECT_THAT(incomplete, HasSubstr("<p class=\"verdict "));
    EXPECT_THAT(incomplete, Not(HasSubstr("<p class=\"verdict clear\">")));
    EXPECT_THAT(incomplete, HasSubstr("Not checked:"));
    const std::string clear = sheet_of_job(job_of_assets("clamped_plate.nc", "clamped_plate.toml"));
    EXPECT_THAT(clear, HasSubstr("<p class=\"verdict clear\">"));
    EXPECT_THAT(clear, Not(HasSubstr("does not release the program")));
}

TEST(Sheet, LeavesNothingThatABrowserReadsAsMoreThanText) {
    const std::string evil = "</td><script>alert(1)</script><img src=x onerror=alert(1)>\xe4 &";
    const SmallJob hostile(
        small_program,
        std::regex_replace(small_setup, std::regex("name = \"jaw left\""),
                           "name = '</td><script>alert(1)</script><img src=x onerror=1>'"));
    const CheckJob job = hostile.job();
    auto run = app::run_check(job);
    ASSERT_TRUE(run) << run.error().message;
    run->program_file = evil;
    SheetContent content = content_of(job);
    content.control = content.program_date = content.sheet.path = evil;
    content.stated.machine_file = content.pictures.missing = evil;
    content.sheet.tools[0].tool.name = evil;
    content.pictures.iso.labels = {{evil, 0.5, 0.5}};
    std::string html = app::html_sheet(*run, content);
    EXPECT_THAT(html, Not(HasSubstr("<script")));
    EXPECT_THAT(html, Not(HasSubstr("<img")));
    EXPECT_THAT(html, HasSubstr("&lt;script&gt;"));
    content.pictures.missing.clear();
    content.pictures.iso.jpeg = content.pictures.top.jpeg = "not a picture";
    html = app::html_sheet(*run, content);
    EXPECT_THAT(html, HasSubstr("&lt;img src=x"));
    EXPECT_THAT(html, Not(HasSubstr("<img src=x")));
}

TEST(Sheet, ShowsTolerancesNextToTheValues) {
    const SmallJob small;
    auto run = app::run_check(small.job());
    ASSERT_TRUE(run) << run.error().message;
    app::Tolerances tolerances;
    app::Tolerance stick_out{
        .deviation = {.quantity = app::Quantity::stick_out, .tool = core::ToolNumber{2}},
        .less = {.by = 3.4567, .not_shown = 3.5, .line = 7, .pair = {"holder", "stock"}},
        .more = {.by = 20.0, .is_open = true}};
    app::Tolerance offset{
        .deviation = {.quantity = app::Quantity::work_offset, .axis = 1, .offset = 1},
        .not_studied = "there was no time"};
    app::Tolerance jaw{.deviation = {.quantity = app::Quantity::fixture, .fixture = "jaw left"},
                       .less = {.by = 20.0, .is_open = true},
                       .more = {.by = 20.0, .is_open = true}};
    app::Tolerance jaw_in_y = jaw;
    jaw_in_y.deviation.axis = 1;
    tolerances.list = {stick_out, offset, jaw, jaw_in_y};
    run->tolerances = std::make_shared<const app::Tolerances>(tolerances);
    const std::string words = words_of_page(app::html_sheet(*run, content_of(small.job())));
    EXPECT_THAT(words, HasSubstr("55 (at least 51.55)"));
    EXPECT_THAT(words, HasSubstr("may be off: stick-out -3.45 to +20 or more mm (less: line 7: "
                                 "holder near stock)"));
    EXPECT_THAT(words, HasSubstr("may be off: X, Y 20 mm or more either way\n"));
    EXPECT_THAT(words, HasSubstr("may be off: Y not studied: there was no time"));
    EXPECT_THAT(words, HasSubstr("a value without a line has no effect on the check"));
    SheetContent stopped = content_of(small.job());
    stopped.tolerances_were_stopped = true;
    EXPECT_THAT(words_of_page(app::html_sheet(*run, stopped)),
                HasSubstr("a value without a line was not studied"));
    tolerances = {.refusal = "the check has errors"};
    run->tolerances = std::make_shared<const app::Tolerances>(tolerances);
    EXPECT_THAT(words_of_page(app::html_sheet(*run, content_of(small.job()))),
                HasSubstr("none: the check has errors"));
}

TEST(Sheet, SaysWhichSetUpItIsOf) {
    const ScopedFolder folder;
    const std::string setup = "[stock]\nbox = [[0, 0, -10], [50, 50, 0]]\n";
    CheckJob job;
    job.program = folder.write("p.nc", "G21 G90\nT1 M6\nM3 S3000\nG0 X0 Y0 Z9.\nG1 Z-2. F300.\n"
                                       "G0 Z20.\nM30\n");
    job.setup = folder.write("p.toml", setup);
    app::SheetWishes wishes;
    wishes.pictures = false;
    const auto words = [&] {
        const auto sheet = app::make_sheet(job, wishes);
        EXPECT_TRUE(sheet);
        return sheet ? words_of_page(sheet->html) : std::string();
    };
    EXPECT_THAT(words(), HasSubstr("p.toml"));
    EXPECT_THAT(words(), HasSubstr(app::sha256_of(setup).substr(0, 16)));
    job.setup_text = setup;
    EXPECT_THAT(words(), Not(HasSubstr("not saved")));
    job.setup_text = "mesh_size = 1\n" + setup;
    EXPECT_THAT(words(), HasSubstr("p.toml with edits that are not saved"));
    EXPECT_THAT(words(), HasSubstr(app::sha256_of(*job.setup_text).substr(0, 16)));
    std::filesystem::remove(job.setup);
    job.setup.clear();
    EXPECT_THAT(words(), HasSubstr("not saved yet"));
    job.setup_text.reset();
    EXPECT_THAT(words(), HasSubstr("inferred from the program"));
}

TEST(SheetCommand, WritesAFileAndReplacesNoInput) {
    const SmallJob small;
    const std::string out = small.folder / "sheet.html";
    const auto ran = feeler({"sheet", small.program, "--no-pictures", "-o", out});
    EXPECT_LE(ran.status, 1) << ran.err;
    EXPECT_THAT(bytes_of(out), HasSubstr("<title>Set-up sheet: small.nc</title>"));
    EXPECT_EQ(feeler({"sheet", small.program, "-o", small.setup}).status, 2);
    EXPECT_EQ(bytes_of(small.setup), small_setup);
    EXPECT_EQ(feeler({"sheet", small.folder / "none.nc"}).status, 2);
}

TEST(SheetCommand, WritesNoSheetOfAProgramThatStops) {
    const SmallJob stops("O1\nG21 G90 G54\nT1 M6\nG0 X1.\nG1 X2. Q\nM30\n");
    const std::string out = stops.folder / "sheet.html";
    const auto ran = feeler({"sheet", stops.program, "--no-pictures", "-o", out});
    EXPECT_EQ(ran.status, 2);
    EXPECT_THAT(ran.err, HasSubstr("there is no sheet"));
    EXPECT_THAT(ran.err, HasSubstr("small.nc:5"));
    EXPECT_EQ(bytes_of(out), "");
}

} // namespace
} // namespace app_test
