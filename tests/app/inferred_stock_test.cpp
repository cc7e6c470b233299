#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/setup/inference/inferred_stock.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/source.h"
#include "tests/support/scoped_folder.h"

namespace app_test {
namespace {

using test_support::ScopedFolder;
using testing::HasSubstr;

struct Inferred {
    app::CheckRun run;
    std::string assumed;

    size_t count(const std::string& rule) const {
        size_t found = 0;
        for (const core::Finding& finding : run.findings) found += finding.rule == rule;
        return found;
    }
    core::Aabb stock() const { // relative to the first work offset
        return core::bounds(run.setup.stock);
    }
};

Inferred infer(const std::string& program, const std::string& name = "p.nc") {
    const ScopedFolder folder;
    auto run = app::run_check(
        {.program = folder.write(name, program), .setup = {}, .allowance = {}, .mesh_size = {}});
    EXPECT_TRUE(run) << (run ? "" : run.error().message);
    Inferred result;
    if (!run) return result;
    result.run = *std::move(run);
    EXPECT_FALSE(result.run.stopped) << result.run.stopped->message;
    for (const std::string& each : result.run.all_assumptions()) result.assumed += each + "\n";
    return result;
}

/// Faces a block with 20 mm beyond its edges, then cuts a groove that begins with a rapid plunge at
/// an X.
std::string faced_then_grooved(double x) {
    return "G21 G90 G54\nM3 S1000\nG0 Z10\nX-20 Y0\nG1 Z-1 F500\nX120\nY8\nX-20\nG0 Z10\nX"
           + std::to_string(x) + " Y4\nZ-3\nG1 Z-4\nX60\nG0 Z10\nM2\n";
}

TEST(InferredStock, EndsWhereARapidGoesDownNextToTheCuts) {
    const Inferred run = infer(faced_then_grooved(-15.0));
    EXPECT_EQ(run.count("rapid-in-stock"), 0u);
    EXPECT_THAT(run.assumed, HasSubstr("it ends at X -12.000, because line 11 plunges next to it"));
    EXPECT_DOUBLE_EQ(run.stock().min.x, -12.0);
    EXPECT_DOUBLE_EQ(run.stock().max.x, 123.0);
}

TEST(InferredStock, StaysUnderAPlungeFarInside) {
    const Inferred run = infer(faced_then_grooved(50.0));
    EXPECT_EQ(run.count("rapid-in-stock"), 1u);
    EXPECT_DOUBLE_EQ(run.stock().min.x, -23.0);
    EXPECT_DOUBLE_EQ(run.stock().max.x, 123.0);
}

TEST(InferredStock, StaysUnderAPlungeIntoAHoleThatIsCut) {
    const Inferred run =
        infer("G21 G90 G54\nM3 S1000\nG0 Z10\nX0 Y0\nG1 Z-5 F500\nX60\nY40\nX0\nY0\nG0 Z10\n"
              "X0 Y0\nZ-4\nG1 Z-6\nX60\nG0 Z10\nM2\n");
    EXPECT_EQ(run.count("rapid-in-stock"), 0u);
    EXPECT_DOUBLE_EQ(run.stock().min.x, -3.0);
    EXPECT_EQ(run.assumed.find("next to it"), std::string::npos);
}

TEST(InferredStock, EndsBelowThePlaneOfTravelOfAProgramWithoutRapids) {
    const Inferred run =
        infer("G21 G90\nM3 S1000\nG1 Z5 F900\nX0 Y0\nZ-2\nX40\nZ5\nY20\nZ-2\nX0\nZ5\nX9\nM2\n");
    EXPECT_FALSE(run.run.has_errors());
    EXPECT_DOUBLE_EQ(run.stock().max.z, 0.0);
    const Inferred flat = infer("G21 G90\nM3 S1000\nG1 Z5 F900\nX0 Y0\nX40\nY20\nX0\nM2\n");
    EXPECT_DOUBLE_EQ(flat.stock().max.z, 5.0);
}

TEST(DeclaredStock, IsTheBlankOfKlartext) {
    const Inferred run = infer("0 BEGIN PGM P MM\n1 BLK FORM 0.1 Z X-10 Y+0 Z-20\n"
                               "2 BLK FORM 0.2 X+90 Y+50 Z+0\n3 TOOL CALL 1 Z S2000\n"
                               "4 L X+0 Y+10 Z+5 R0 FMAX M3\n5 L Z-3 F200\n6 L X+50\n"
                               "7 L Z+50 FMAX M2\n8 END PGM P MM\n",
                               "p.h");
    EXPECT_THAT(run.assumed,
                HasSubstr("the stock is the box given by BLK FORM in line 3: X -10.000 to "
                          "90.000, Y 0.000 to 50.000, Z -20.000 to 0.000"));
    EXPECT_EQ(run.stock().min, core::Vec3(-10, 0, -20));
    EXPECT_EQ(run.stock().max, core::Vec3(90, 50, 0));
}

std::optional<app::DeclaredStock> stated(const std::string& text,
                                         gcode::LengthUnit unit = gcode::LengthUnit::mm) {
    const ScopedFolder folder;
    const auto program = gcode::read_program(folder.write("p.h", text + "M30\n"));
    EXPECT_TRUE(program) << (program ? "" : program.error().message);
    return program ? app::declared_stock(*program, unit) : std::nullopt;
}

TEST(DeclaredStock, CountsIncrementsFromTheLowCorner) {
    const auto stock = stated("1 BLK FORM 0.1 Z X+5 Y+5 Z-8\n2 BLK FORM 0.2 IX+10 IY+20 IZ+8\n");
    ASSERT_TRUE(stock);
    EXPECT_EQ(stock->box.min, core::Vec3(5, 5, -8));
    EXPECT_EQ(stock->box.max, core::Vec3(15, 25, 0));
}

TEST(DeclaredStock, IsTheBoxOfAWorkpiece) {
    const auto stock = stated("N10 WORKPIECE(,\"\",,\"BOX\",112,1,-20,-80,-5,0,100,60)\n");
    ASSERT_TRUE(stock);
    EXPECT_EQ(stock->box.min, core::Vec3(-5, 0, -20));
    EXPECT_EQ(stock->box.max, core::Vec3(100, 60, 1));
}

TEST(DeclaredStock, IsReadInInches) {
    const auto stock = stated("1 BLK FORM 0.1 Z X+0 Y+0 Z-1\n2 BLK FORM 0.2 X+2 Y+3 Z+0\n",
                              gcode::LengthUnit::inch);
    ASSERT_TRUE(stock);
    EXPECT_NEAR(stock->box.max.x, 50.8, 1e-12);
    EXPECT_NEAR(stock->box.max.y, 76.2, 1e-12);
}

const std::string vectric = "( Cross2 )\n( Material Size )\n( X=96 mm, Y=120.0, Z=6 )\n";

TEST(DeclaredStock, IsTheMaterialOfAHeader) {
    const auto top = stated(vectric
                            + "( Z Origin for Material = Material Surface)\n"
                              "( XY Origin for Job = Center)\n");
    ASSERT_TRUE(top);
    EXPECT_EQ(top->box.min, core::Vec3(-48, -60, -6));
    EXPECT_EQ(top->box.max, core::Vec3(48, 60, 0));
    const auto table = stated(vectric + "( Z Origin = Table Surface)\n( XY Origin = Top Right)\n");
    ASSERT_TRUE(table);
    EXPECT_EQ(table->box.min, core::Vec3(-96, -120, 0));
    EXPECT_EQ(table->box.max, core::Vec3(0, 0, 6));
}

TEST(DeclaredStock, LiesWhereItsSizeHoldsWhatIsCut) {
    const auto low_corner = [&](const core::Aabb& reach) -> std::optional<core::Vec3> {
        const ScopedFolder folder;
        const auto program = gcode::read_program(folder.write("p.tap", vectric + "M30\n"));
        EXPECT_TRUE(program);
        const auto stock = app::declared_stock(*program, gcode::LengthUnit::mm, reach);
        return stock ? std::optional(stock->box.min) : std::nullopt;
    };
    EXPECT_EQ(low_corner({{-2, -2, -6}, {98, 122, 0}}), core::Vec3(0, 0, -6));
    EXPECT_EQ(low_corner({{-45, -50, -6}, {45, 50, 0}}), core::Vec3(-48, -60, -6));
    EXPECT_EQ(low_corner({{200, 0, -6}, {250, 50, 0}}), std::nullopt);
    EXPECT_FALSE(stated(vectric)); // no cutting
}

TEST(DeclaredStock, IsEmptyWithoutABody) {
    EXPECT_FALSE(stated("1 BLK FORM 0.1 Z X+0 Y+0 Z-1\n"));
    EXPECT_FALSE(stated("1 BLK FORM 0.1 Z X+0 Y+0 Z-1\n2 BLK FORM 0.2 X+0 Y+3 Z+0\n"));
    EXPECT_FALSE(
        stated("1 BLK FORM 0.2\n2 BLK FORM 0.\n3 BLK FORM\n4 WORKPIECE(\n5 WORKPIECE()\n"));
    EXPECT_FALSE(stated("; BLK FORM 0.1 Z X+0 Y+0 Z-1\n; BLK FORM 0.2 X+2 Y+3 Z+0\n"));
}

const std::string two_places = "G21 G90 G54\nT1 M6\nM3 S1000\nG43 H1 Z50\nX0 Y0\nZ2\nG1 Z-5 F500\n"
                               "X80\nY40\nX0\nG0 Z50\nG55\nX40 Y20\nZ-30\nG1 Z-32\nX60\n"
                               "G0 Z50\nM30\n";

TEST(StockAtWorkOffsets, LieApart) {
    const Inferred run = infer(two_places);
    EXPECT_FALSE(run.run.has_errors());
    EXPECT_THAT(run.assumed,
                HasSubstr("The stock is at G54, where most is cut; there is none at G55"));
    EXPECT_DOUBLE_EQ(run.stock().min.z, -7.0); // cuts in G55 do not count
}

TEST(StockAtWorkOffsets, DoNotHideCollisionsAtTheMainOne) {
    std::string through = two_places;
    through.replace(through.find("G0 Z50\nG55"), 6, "G0 X40 Y20\nZ50");
    const Inferred run = infer(through);
    EXPECT_EQ(run.count("rapid-in-stock"), 1u);
}

const std::string turned = "G21 G18 G8\nM3 S1000\nG0 X20 Z2\nG1 X10 F100\nZ-30\nX20\nG0 Z2\nM2\n";

TEST(TurningProgram, IsNotJudgedAndSaysSo) {
    const Inferred run = infer(turned);
    EXPECT_EQ(run.run.verdict, core::Verdict::undecided);
    EXPECT_EQ(run.count("undecided"), 1u);
    EXPECT_EQ(run.count("rapid-in-stock") + run.count("collision"), 0u);
    EXPECT_THAT(run.run.findings.back().message, HasSubstr("line 1 has G8"));
}

TEST(TurningProgram, ThatIsNotReadToItsEndIsNotJudgedEither) {
    const std::string begin = "O0001\nG21 G40\nG50 S2000\nT0101\nG96 S200 M3\nG0 X52. Z2.\n";
    for (const std::string cycle : {"G71 U2. R1.\n", "G76 P010060 Q100 R50\n", "G32 Z-20. F1.\n"}) {
        const Inferred run = infer(begin + cycle + "M30\n");
        EXPECT_FALSE(run.run.stopped) << cycle;
        EXPECT_EQ(run.run.verdict, core::Verdict::undecided);
        EXPECT_EQ(run.count("undecided"), 2u);
        EXPECT_THAT(run.run.findings.front().message, HasSubstr("which is written for a lathe"));
    }
    // LinuxCNC has turning cycles, so their errors are those of the program.
    const ScopedFolder folder;
    const auto run = app::run_check(
        {.program = folder.write("p.ngc", "G8 G18 G21\nT1 M6\nG0 X5 Z2\nG71 Q9\nM2\n")});
    ASSERT_TRUE(run);
    EXPECT_TRUE(run->stopped);
}

std::optional<std::string> reason(const std::string& text) {
    const ScopedFolder folder;
    const auto program = gcode::read_program(folder.write("p.nc", text));
    EXPECT_TRUE(program);
    return program ? app::turning_reason(*program) : std::nullopt;
}

TEST(TurningProgram, IsKnownByItsCodes) {
    EXPECT_TRUE(reason("T0101\nG96 S200 M3\nG0 X50 Z2\n"));
    EXPECT_TRUE(reason("G50 S2000\nG0 X50 Z2\n"));
    EXPECT_TRUE(reason("T0303\nG0 X50 Z2\nG71 U1 R1\n"));
    EXPECT_TRUE(reason("G0 X50 Z2\nG71 P10 Q20 U.5 W.1 F.2\n"));
    EXPECT_TRUE(reason("T0101\nG0 X50 Z2\nG1 Z-5 F.1\n"));
    EXPECT_TRUE(reason("G18\nG0 X1 Z1\n(Y axis)\n"));
    EXPECT_FALSE(reason("G18\nG0 X1 Y0 Z1\n"));
    EXPECT_FALSE(reason("T0101 M6\nG0 X1 Z1\n"));
    EXPECT_FALSE(reason("G71\nG0 X1 Z1\n")); // millimetres
    EXPECT_FALSE(reason("G0 X1 Z1\nG1 Z-1 F100\n"));
    EXPECT_FALSE(reason("G18\nG0 Z1\n"));
}

TEST(MeasuringProgram, HasNoStock) {
    const Inferred run = infer("BEGIN PGM P MM\nTOOL CALL 0 Z S5\nSTOP\n"
                               "FN18: SYSREAD Q12 = ID270 NR1 IDX3\nL IZ-5 R0 F200\n"
                               "L IX-2 R0 F200\nL Z-10 R0 FMAX M91\nEND PGM P MM\n",
                               "p.h");
    EXPECT_THAT(run.assumed, HasSubstr("line 4 reads the axis positions"));
    EXPECT_FALSE(run.run.has_errors());
}

TEST(NamedTool, IsWhatItsNameSays) {
    const Inferred run =
        infer("N10 G17 G710 G90 G54\nN20 T=\"DRILL 8.5\" M6\nN30 M3 S1000\nN40 G0 X0 Y0 Z10 D1\n"
              "N50 G1 Z-5 F100\nN60 G0 Z10\nN70 T=\"BALL_MILL_6MM\" M6\nN80 M3 S1000\n"
              "N90 G0 X20 Z10 D1\nN100 G1 Z-2 F100\nN110 X30\nN120 G0 Z10\nN130 M30\n",
              "p.mpf");
    EXPECT_THAT(run.assumed,
                HasSubstr("tool 1 is a drill of 8.5 mm, according to its name in line 2"));
    EXPECT_THAT(run.assumed,
                HasSubstr("tool 2 is a ball end mill of 6 mm, according to its name in line 7"));
}

TEST(NamedTool, IsNoDrillWhereItCutsSideways) {
    const Inferred run =
        infer("N10 G17 G710 G90 G54\nN20 T=\"DRILL 8.5\" M6\nN30 M3 S1000\nN40 G0 X0 Y0 Z10 D1\n"
              "N50 G1 Z-5 F100\nN60 X50\nN70 G0 Z10\nN80 M30\n",
              "p.mpf");
    EXPECT_THAT(run.assumed,
                HasSubstr("tool 1 is a flat end mill of 8.5 mm, according to its name in line 2 "
                          "and its use, because drills do not cut sideways"));
}

TEST(InferredStock, IsNoHigherThanRapidsGoDownToBeforeTheyDrill) {
    const Inferred run =
        infer("G21 G90 G54\nM3 S1000\nG0 Z10\nX0 Y0\nZ6\nG1 X60 F500\nY40\nG0 Z10\n"
              "G0 X30 Y20\nG81 R1 Z-4 F100\nG80\nG0 Z9\nM2\n");
    EXPECT_EQ(run.count("collision") + run.count("rapid-in-stock"), 0u);
    EXPECT_DOUBLE_EQ(run.stock().max.z, 1.0);
}

TEST(MeshSize, FollowsTheSizeOfASmallStock) {
    const auto mesh_size = [](const std::string& x, const std::string& z = "-1") {
        return infer("G21 G90\nM3 S1\nG0 Z3\nX0 Y0\nG1 Z" + z + " F9\nX" + x + "\nG0 Z3\nM2\n")
            .run.setup.mesh_size;
    };
    EXPECT_DOUBLE_EQ(mesh_size("0.5"), 0.2); // 6.5 mm with the tool
    EXPECT_DOUBLE_EQ(mesh_size("80"), 0.5);
    EXPECT_DOUBLE_EQ(mesh_size("594", "-20"), 1.0);
    EXPECT_DOUBLE_EQ(mesh_size("594"), 0.75); // four cells across a thickness of 3 mm
}

} // namespace
} // namespace app_test
