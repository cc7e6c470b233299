#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "core/cad/cad_file.h"
#include "core/sim/clearance.h"
#include "core/sim/setup.h"
#include "tests/support/scoped_folder.h"
#ifdef FEELER_CAD_READER
#include "tests/cad/cad_models.h"
#endif

namespace app {
namespace {

using test_support::ScopedFolder;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

const std::string offsets =
    "[offsets]\nG54 = { Z = -300 }\n[stock]\nbox = [[0, 0, -9], [9, 9, 0]]\n";

class CadSetup : public ::testing::Test {
protected:
    core::Result<SetupFile> read(const std::string& text) const {
        return read_setup(folder_.write("setup.toml", text), {});
    }
    std::string error_of(const std::string& text) const {
        const auto file = read(text);
        return file ? "it was read" : file.error().message;
    }

    ScopedFolder folder_;
};

TEST_F(CadSetup, KeysOfCadFilesAreForCadFilesOnly) {
    folder_.write("a.stl", "solid a\nendsolid a\n");
    const std::string fixture = offsets + "[[fixture]]\nname = \"a\"\nmesh = \"a.stl\"\n";
    EXPECT_THAT(error_of(fixture + "solid = \"jaw\"\n"), HasSubstr("only to CAD files"));
    EXPECT_THAT(error_of(fixture + "mesh_deviation = 0.1\n"), HasSubstr("only to CAD files"));
}

#ifndef FEELER_CAD_READER

TEST_F(CadSetup, WithoutOpenCascadeIsAClearError) {
    folder_.write("a.step", "ISO-10303-21;\nEND-ISO-10303-21;\n");
    EXPECT_THAT(error_of(offsets + "[[fixture]]\nname = \"a\"\nmesh = \"a.step\"\n"),
                AllOf(HasSubstr("without Open CASCADE"), HasSubstr("STL")));
    EXPECT_TRUE(core::cad_library().empty());
}

#else

using core::Vec3;

class CadBodies : public CadSetup {
protected:
    CadBodies() {
        core::set_cad_reader(FEELER_CAD_READER);
        test_support::CadPart jaw{"jaw", test_support::cad_cylinder(30, 20), {100, 0, 0}};
        test_support::CadPart base{"base", test_support::cad_box(Vec3(0), Vec3(50, 40, 10))};
        write_step(folder_.path() / "vise.step",
                   test_support::CadPart{"vise", {}, {}, 0, {base, jaw}});
    }
};

TEST_F(CadBodies, AreFixturesWithTheirDeviation) {
    const std::string fixture = offsets + "[[fixture]]\nname = \"v\"\nmesh = \"vise.step\"\n";
    const auto whole = read(fixture);
    ASSERT_TRUE(whole) << whole.error().message;
    const core::Fixture& vise = whole->setup.fixtures.at(0);
    EXPECT_GT(vise.deviation, 0.0);
    EXPECT_LE(vise.deviation, 0.01);
    EXPECT_NEAR(core::bounds(vise.body).max.x, 130.0, 0.01);
    EXPECT_THAT(whole->assumptions,
                Contains(AllOf(HasSubstr("vise.step: meshed within"), HasSubstr("(proven)"))));
    const auto base = read(fixture + "solid = \"base\"\n");
    ASSERT_TRUE(base) << base.error().message;
    EXPECT_NEAR(core::bounds(base->setup.fixtures.at(0).body).max.x, 50.0, 1e-9);
    EXPECT_THAT(error_of(fixture + "solid = \"nut\"\n"),
                AllOf(HasSubstr("\"nut\""), HasSubstr("\"jaw\"")));
    EXPECT_THAT(error_of(fixture + "mesh_unit = \"inch\"\n"), HasSubstr("whose unit is known"));
    EXPECT_THAT(error_of(fixture + "mesh_deviation = 1e-9\n"), HasSubstr("must lie between"));
}

TEST_F(CadBodies, TakeTheirDeviationInTheUnitOfTheSetup) {
    const std::string fixture =
        "[[fixture]]\nname = \"v\"\nmesh = \"vise.step\"\nmesh_deviation = ";
    const auto mm = read(offsets + fixture + "0.254\n");
    const auto inch = read("length_unit = \"inch\"\n" + offsets + fixture + "0.01\n");
    ASSERT_TRUE(mm && inch);
    EXPECT_EQ(mm->setup.fixtures.at(0).deviation, inch->setup.fixtures.at(0).deviation);
    EXPECT_GT(mm->setup.fixtures.at(0).deviation, 0.01);
    // The file states its unit, whatever that of the set-up is.
    EXPECT_EQ(core::bounds(mm->setup.fixtures.at(0).body).max,
              core::bounds(inch->setup.fixtures.at(0).body).max);
}

TEST_F(CadBodies, AreStockAndPartOnTheSafeSide) {
    const auto file =
        read("[offsets]\nG54 = { Z = -300 }\n[stock]\nmesh = \"vise.step\"\ntolerance = 0.5\n"
             "[part]\nmesh = \"vise.step\"\ntolerance = 0.05\nframe = \"G54\"\n");
    ASSERT_TRUE(file) << file.error().message;
    const double deviation = file->setup.stock.deviation;
    EXPECT_GT(deviation, 0.0);
    EXPECT_DOUBLE_EQ(file->setup.stock.tolerance, 0.5 + deviation);
    EXPECT_EQ(file->setup.part->tolerance, 0.05);
    EXPECT_DOUBLE_EQ(file->setup.part->limit(), 0.05 - deviation);
    EXPECT_THAT(error_of("[offsets]\nG54 = { Z = -300 }\n[stock]\nmesh = \"vise.step\"\n"
                         "[part]\nmesh = \"vise.step\"\ntolerance = 0.001\nframe = \"G54\"\n"),
                HasSubstr("may deviate"));
}

TEST_F(CadBodies, AreStoppedWhenTheReaderIs) {
    const core::CadReadObserver observer([](const core::CadProgress&) { return false; });
    EXPECT_THAT(
        error_of(offsets
                 + "[[fixture]]\nname = \"v\"\nmesh = \"vise.step\"\nmesh_deviation = 0.033\n"),
        HasSubstr("stopped"));
}

#endif

} // namespace
} // namespace app
