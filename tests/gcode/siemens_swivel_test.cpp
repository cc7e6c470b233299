#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/driven_machine.h"

namespace gcode {
namespace {

using core::Vec3;
using testing::HasSubstr;

Driven driven_siemens(const std::string& lines, const core::Machine& machine) {
    Environment environment = environment_of(machine, DialectId::siemens);
    return driven("T1 M6 D1\nG17 G90 G54 G710\n" + lines + "M30\n", environment);
}

Vec3 tip_at_end(const Driven& found, const core::Machine& machine) {
    return core::tip_position(machine, values_of(found.motions.back().to), tool_length);
}

using Turn = Vec3 (*)(const Vec3&, double);

/// A mode of CYCLE800, and its rotations in their order; each is about the axes turned before.
struct Mode {
    int number;
    std::array<Turn, 3> turns;
};

constexpr Mode modes[] = {{57, {about_x, about_y, about_z}}, {54, {about_y, about_x, about_z}},
                          {39, {about_z, about_x, about_y}}, {27, {about_z, about_y, about_x}},
                          {45, {about_x, about_z, about_y}}, {30, {about_y, about_z, about_x}}};

TEST(SiemensSwivel, IsWhereTheManualPutsIt) {
    std::mt19937 random(800);
    std::uniform_real_distribution<double> angle(-50.0, 50.0), place(-40.0, 40.0);
    for (int i = 0; i < 1000; ++i) {
        const Mode& mode = modes[static_cast<size_t>(i) % std::size(modes)];
        const Vec3 a(angle(random), angle(random), angle(random));
        const Vec3 before(place(random), place(random), place(random));
        const Vec3 after(place(random), place(random), place(random));
        const core::Machine machine = i % 2 ? trunnion() : fork_head();
        const Driven found = driven_siemens(
            fmt::format(
                "G0 X5 Y6 Z80\nCYCLE800(0,\"T\",200000,{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},"
                "{:.9f},{:.9f},{:.9f},{:.9f},-1,100,1)\nG0 X20 Y-15 Z33\n",
                mode.number, before.x, before.y, before.z, a[0], a[1], a[2], after.x, after.y,
                after.z),
            machine);
        ASSERT_FALSE(found.motions.empty());
        const auto turned = [&](Vec3 p) {
            for (size_t k = 3; k-- > 0;) p = mode.turns[k](p, a[static_cast<int>(k)]);
            return p;
        };
        ASSERT_LT(glm::distance(tip_at_end(found, machine),
                                datum + before + turned(after + Vec3(20, -15, 33))),
                  1e-6)
            << mode.number;
        const core::AxisValues end = values_of(found.motions.back().to);
        const Vec3 above = core::tip_position(machine, end, tool_length - 10.0);
        ASSERT_LT(glm::distance(above - tip_at_end(found, machine), turned({0, 0, 10})), 1e-6);
        for (const core::PathCertainty path : found.paths) EXPECT_EQ(path, core::PathCertainty{});
    }
}

TEST(SiemensSwivel, BySolidAngleAndAddedToAnother) {
    const core::Machine machine = trunnion();
    const Driven solid = driven_siemens("CYCLE800(0,\"T\",0,64,0,0,0,30,20,0,0,0,0,-1,100,1)\n"
                                        "G0 X20 Y-15 Z33\n",
                                        machine);
    EXPECT_LT(
        glm::distance(tip_at_end(solid, machine), datum + about_z(about_y({20, -15, 33}, 20), 30)),
        1e-9);
    const Driven added =
        driven_siemens("CYCLE800(0,\"T\",0,57,10,0,0,30,0,0,0,0,0,-1,100,1)\n"
                       "CYCLE800(0,\"T\",1,57,0,5,0,0,20,0,0,0,0,-1,100,1)\nTRANS X3\n"
                       "G0 X20 Y-15 Z33\n",
                       machine);
    EXPECT_LT(glm::distance(tip_at_end(added, machine),
                            datum + Vec3(10, 0, 0)
                                + about_x(Vec3(0, 5, 0) + about_y({23, -15, 33}, 20), 30)),
              1e-9);
}

/// X of the plane stays in the ZX plane, turned about Y; Y turned about X lies in the plane, too.
TEST(SiemensSwivel, ByProjectionAngles) {
    std::mt19937 random(185);
    std::uniform_real_distribution<double> angle(-60.0, 60.0);
    for (int i = 0; i < 300; ++i) {
        const double a = angle(random), b = angle(random), turn = angle(random);
        const bool x_first = i % 2;
        const core::Machine machine = i % 4 < 2 ? trunnion() : fork_head();
        const Vec3 along = about_y({1, 0, 0}, b), other = about_x({0, 1, 0}, a);
        const Vec3 z = glm::normalize(glm::cross(along, other)), across = glm::cross(z, along);
        const double c = std::cos(turn * M_PI / 180.0), s = std::sin(turn * M_PI / 180.0);
        const Vec3 x = c * along + s * across, y = c * across - s * along;
        const Driven found = driven_siemens(
            fmt::format("CYCLE800(0,\"T\",0,{},0,0,0,{:.12f},{:.12f},{:.12f},0,0,0,-1,100,1)\n"
                        "G0 X20 Y-15 Z33\n",
                        x_first ? 185 : 182, x_first ? a : b, x_first ? b : a, turn),
            machine);
        ASSERT_LT(glm::distance(tip_at_end(found, machine), datum + 20.0 * x - 15.0 * y + 33.0 * z),
                  1e-6);
        // ROTS makes the same plane, which AROT turns.
        const Driven frame = driven_siemens(
            fmt::format("ROTS X={:.12f} Y={:.12f}\nAROT Z={:.12f}\nG0 X20 Y-15 Z33\n", a, b, turn),
            core::Machine());
        ASSERT_LT(
            glm::distance(Vec3(*frame.motions.back().to[0], *frame.motions.back().to[1],
                               *frame.motions.back().to[2]),
                          datum + 20.0 * x - 15.0 * y + 33.0 * z + Vec3(0.0, 0.0, tool_length)),
            1e-6);
    }
}

TEST(SiemensSwivel, RotsLeavesAnAxisOfThePlaneInAPlaneOfTheWork) {
    const auto axes = [](const std::string& words) {
        std::array<Vec3, 3> found;
        for (int axis = 0; axis < 3; ++axis) {
            const Driven run =
                driven_siemens(words
                                   + fmt::format("\nG0 X{} Y{} Z{}\n", int(axis == 0),
                                                 int(axis == 1), int(axis == 2)),
                               core::Machine());
            const auto& to = run.motions.back().to;
            found[static_cast<size_t>(axis)] =
                Vec3(*to[0], *to[1], *to[2]) - datum - Vec3(0.0, 0.0, tool_length);
        }
        return found;
    };
    const auto xy = axes("ROTS X=20 Y=30"), zx = axes("ROTS Z=20 X=30"),
               yz = axes("ROTS Y=20 Z=30");
    EXPECT_LT(glm::distance(xy[0], about_y({1, 0, 0}, 30)), 1e-9);
    EXPECT_NEAR(glm::dot(xy[2], about_x({0, 1, 0}, 20)), 0.0, 1e-9);
    EXPECT_LT(glm::distance(zx[2], about_x({0, 0, 1}, 30)), 1e-9);
    EXPECT_NEAR(glm::dot(zx[1], about_z({1, 0, 0}, 20)), 0.0, 1e-9);
    EXPECT_LT(glm::distance(yz[1], about_z({0, 1, 0}, 30)), 1e-9);
    EXPECT_NEAR(glm::dot(yz[0], about_y({0, 0, 1}, 20)), 0.0, 1e-9);
    const auto one = axes("ROTS Y=25");
    EXPECT_LT(glm::distance(one[0], about_y({1, 0, 0}, 25)), 1e-9);
    const auto added = axes("ROT Z=40\nAROTS X=20 Y=30");
    EXPECT_LT(glm::distance(added[0], about_z(about_y({1, 0, 0}, 30), 40)), 1e-9);
    const Ran three =
        run_text("G710\nROTS X1 Y2 Z3\n", environment_of(core::Machine(), DialectId::siemens));
    ASSERT_TRUE(three.run.error);
    EXPECT_THAT(three.run.error->message, HasSubstr("two angles"));
    const Ran more =
        run_text("G710\nROTS X1 RPL=2\n", environment_of(core::Machine(), DialectId::siemens));
    ASSERT_TRUE(more.run.error);
    EXPECT_THAT(more.run.error->message, HasSubstr("or RPL"));
}

TEST(SiemensSwivel, ChoosesTheSideAndGoesBack) {
    const core::Machine machine = trunnion();
    for (const int direction : {-1, 1}) {
        const Driven found = driven_siemens(
            fmt::format("CYCLE800(0,\"T\",0,57,0,0,0,30,0,0,0,0,0,{},100,1)\n", direction),
            machine);
        EXPECT_EQ(values_of(found.motions.back().to)[3] > 0.0, direction > 0);
    }
    const Driven back = driven_siemens(
        "CYCLE800(0,\"T\",0,57,0,0,0,30,0,0,0,0,0,1,100,1)\nG0 X1 Y2 Z3\n"
        "CYCLE800(0,\"T\",0,57,0,0,0,0,0,0,0,0,0,1,100,1)\nCYCLE800()\nG0 X1 Y2 Z3\n",
        machine);
    EXPECT_EQ(values_of(back.motions.back().to)[3], 0.0);
    EXPECT_LT(glm::distance(tip_at_end(back, machine), datum + Vec3(1, 2, 3)), 1e-9);
}

TEST(SiemensSwivel, WithDirectionZeroTakesRotaryAxesThatAreInThePlane) {
    for (const core::Machine& machine : {trunnion(), fork_head()}) {
        const std::string swivel = "CYCLE800(0,\"T\",0,57,3,4,5,25,15,40,1,2,3,{},100,1)\n";
        const std::string move = "G0 X20 Y-15 Z33\n";
        const Driven turned = driven_siemens(
            "G0 X1 Y2 Z300\n" + fmt::format(fmt::runtime(swivel), -1) + move, machine);
        const core::AxisValues there = values_of(turned.motions.back().to);
        const std::string axes = machine.axes[3].present
                                     ? fmt::format("G0 A{:.3f} C{:.3f}\n", there[3], there[5])
                                     : fmt::format("G0 B{:.3f} C{:.3f}\n", there[4], there[5]);
        const Driven found = driven_siemens(
            "G0 X1 Y2 Z300\n" + axes + fmt::format(fmt::runtime(swivel), 0) + move, machine);
        EXPECT_LT(glm::distance(tip_at_end(found, machine), tip_at_end(turned, machine)), 1e-9);
        EXPECT_EQ(found.motions.size(), 3u); // the cycle moves nothing
        for (const core::PathCertainty path : found.paths) EXPECT_EQ(path, core::PathCertainty{});
        const Ran ran = run_text("T1 M6 D1\nG17 G90 G54 G710\nG0 A0 B0 C10\n"
                                     + fmt::format(fmt::runtime(swivel), 0) + "M30\n",
                                 environment_of(machine, DialectId::siemens));
        ASSERT_TRUE(ran.run.error);
        EXPECT_THAT(ran.run.error->message, HasSubstr("before it"));
    }
}

TEST(SiemensSwivel, OfNoSwivelDataIsOff) {
    const core::Machine machine = trunnion();
    for (const char* name : {"\"0\"", " \"0\"", "\"0\" "}) {
        const Driven found = driven_siemens(
            fmt::format("TRANS X10\nCYCLE800(0,{},0,57,0,0,0,30,0,0,0,0,0,-1,100,1)\nG0 X1 Y2 Z3\n",
                        name),
            machine);
        ASSERT_EQ(found.motions.size(), 1u) << name;
        EXPECT_LT(glm::distance(tip_at_end(found, machine), datum + Vec3(1, 2, 3)), 1e-9);
    }
    // A text of another statement in the block is none.
    const Driven other = driven_siemens(
        "CYCLE800(0,\"T\",0,57,0,0,0,30,0,0,0,0,0,-1,100,1) ; was CYCLE800(0,\"0\")\n", machine);
    EXPECT_EQ(other.motions.size(), 1u);
}

TEST(SiemensSwivel, KeepsTheTipIfItIsTracked) {
    const core::Machine machine = trunnion();
    const Driven found = driven_siemens(
        "G0 X30 Y-20 Z15\nCYCLE800(0,\"T\",10,57,0,0,0,40,0,0,0,0,0,-1,100,1)\n", machine);
    ASSERT_EQ(found.motions.size(), 2u);
    const auto tip = [&](size_t i) {
        return core::tip_position(machine, values_of(found.motions[i].to), tool_length);
    };
    EXPECT_LT(glm::distance(tip(0), tip(1)), 1e-9);
}

TEST(SiemensSwivel, RetractsWhereTheSetupSays) {
    core::Machine machine = trunnion();
    machine.axes[2].max = 600.0;
    const auto retracted = [&](int kind, Position stated, const std::string& before = "") {
        Environment environment = environment_of(machine, DialectId::siemens);
        environment.swivel_retract = stated;
        return driven(
            fmt::format("T1 M6 D1\nG17 G90 G54 G710\nG0 X30 Y-20 Z15\n{}CYCLE800({},\"T\","
                        "0,57,0,0,0,40,0,0,0,0,0,-1,70,1)\nG0 X1 Y2\nM30\n",
                        before, kind),
            environment);
    };
    const auto at = [](const Driven& found, size_t i) { return values_of(found.motions[i].to); };
    const Position of_z{std::nullopt, std::nullopt, 555.0}, of_all{-11.0, -12.0, 555.0};

    const Driven along_z = retracted(1, of_z);
    ASSERT_EQ(along_z.motions.size(), 4u) << "approach, retract, turn, next";
    core::AxisValues expected = at(along_z, 0);
    expected[2] = 555.0;
    EXPECT_EQ(at(along_z, 1), expected);
    EXPECT_NE(at(along_z, 2)[3], 0.0);
    EXPECT_EQ(at(along_z, 2)[2], 555.0) << "the linear axes stand while the table turns";
    for (const core::PathCertainty path : along_z.paths) EXPECT_EQ(path, core::PathCertainty{});

    const Driven aside = retracted(2, of_all);
    ASSERT_EQ(aside.motions.size(), 5u);
    EXPECT_EQ(at(aside, 1), expected);
    EXPECT_NEAR(at(aside, 2)[0], -11.0, 1e-9);
    EXPECT_NEAR(at(aside, 2)[1], -12.0, 1e-9);
    EXPECT_NEAR(at(aside, 2)[2], 555.0, 1e-9);

    EXPECT_NEAR(at(retracted(4, {}), 1)[2], 600.0, 1e-9) << "as far as Z goes";
    EXPECT_NEAR(at(retracted(5, {}), 1)[2], at(along_z, 0)[2] + 70.0, 1e-9);

    // From a plane that is tilted already: along Z of the machine, not of the plane.
    const Driven tilted =
        retracted(1, of_z, "CYCLE800(0,\"T\",0,57,0,0,0,20,0,0,0,0,0,-1,100,1)\nG0 X30 Y-20 Z15\n");
    const size_t last = tilted.motions.size() - 3; // before turn and next
    EXPECT_NEAR(at(tilted, last)[2], 555.0, 1e-9);
    for (const size_t axis : {0, 1, 3, 4})
        EXPECT_NEAR(at(tilted, last)[axis], at(tilted, last - 1)[axis], 1e-9);
}

TEST(SiemensSwivel, IsUndecidedIfItRetractsToAnUnknownPlace) {
    core::Machine machine = trunnion();
    machine.axes[2].max.reset();
    const auto is_certain = [&](int kind, Position stated) {
        Environment environment = environment_of(machine, DialectId::siemens);
        environment.swivel_retract = stated;
        const Driven found = driven(
            fmt::format(
                "T1 M6 D1\nG17 G90 G54 G710\nG0 X3 Y-2 Z15\nCYCLE800({},\"T\",0,57,0,0,0,40,0,"
                "0,0,0,0,-1,70,1)\nG0 X1 Y2\nM30\n",
                kind),
            environment);
        return found.paths.back() == core::PathCertainty{};
    };
    EXPECT_TRUE(is_certain(0, {}));
    EXPECT_FALSE(is_certain(1, {}));
    EXPECT_FALSE(is_certain(1, {1.0, 2.0, std::nullopt}));
    EXPECT_FALSE(is_certain(2, {std::nullopt, std::nullopt, 500.0}));
    EXPECT_FALSE(is_certain(3, {1.0, 2.0, 500.0})) << "no known kind";
    EXPECT_FALSE(is_certain(4, {1.0, 2.0, 500.0})) << "Z has no limit";
    EXPECT_TRUE(is_certain(5, {}));
    EXPECT_FALSE(is_certain(1, {std::nullopt, std::nullopt, -900.0})) << "below the tool";
    EXPECT_FALSE(is_certain(1, {std::nullopt, std::nullopt, 1e300}));
}

TEST(SiemensSwivel, RetractsByAPositiveDistanceOnly) {
    const auto is_certain = [](const std::string& kind, const std::string& last) {
        const Driven found =
            driven("T1 M6 D1\nG17 G90 G54 G710\nG0 X3 Y-2 Z15\nCYCLE800(" + kind
                       + ",\"T\",0,57,0,0,0,40,0,0,0,0,0,-1" + last + ")\nG0 X1 Y2\nM30\n",
                   environment_of(trunnion(), DialectId::siemens));
        return found.paths.back() == core::PathCertainty{};
    };
    EXPECT_TRUE(is_certain("5", ",70,1"));
    EXPECT_FALSE(is_certain("5", ",-70,1"));
    EXPECT_FALSE(is_certain("5", ",0,1"));
    EXPECT_FALSE(is_certain("5", ",1EX300,1"));
    EXPECT_FALSE(is_certain("5", ""));
    EXPECT_FALSE(is_certain("5.5", ",70,1")) << "no kind of retract";
}

TEST(SiemensSwivel, RetractsAlongZOfTheMachineAfterARotation) {
    Environment environment = environment_of(trunnion(), DialectId::siemens);
    environment.swivel_retract[2] = 555.0;
    const Driven found =
        driven("T1 M6 D1\nG17 G90 G54 G710\nG0 X3 Y-2 Z15\nROT X20\n"
               "CYCLE800(1,\"T\",0,57,0,0,0,40,0,0,0,0,0,-1,70,1)\nG0 X1 Y2\nM30\n",
               environment);
    core::AxisValues expected = values_of(found.motions[0].to);
    expected[2] = 555.0;
    const core::AxisValues retracted = values_of(found.motions[1].to);
    for (size_t axis = 0; axis < 5; ++axis) EXPECT_NEAR(retracted[axis], expected[axis], 1e-9);
}

TEST(SiemensSwivel, RetractsToKnownPlacesWithOneSetOfSwivelDataOnly) {
    const auto is_certain = [](const std::string& first, const std::string& second) {
        Environment environment = environment_of(trunnion(), DialectId::siemens);
        environment.swivel_retract[2] = 555.0;
        const std::string rest = ",0,57,0,0,0,40,0,0,0,0,0,-1,70,1)\n";
        const Driven found =
            driven("T1 M6 D1\nG17 G90 G54 G710\nG0 X3 Y-2 Z15\nCYCLE800(0," + first + rest
                       + "G0 X1 Y2 Z15\nCYCLE800(1," + second + rest + "G0 X1 Y2\nM30\n",
                   environment);
        return found.paths.back() == core::PathCertainty{};
    };
    EXPECT_TRUE(is_certain("\"TABLE\"", "\"TABLE\""));
    EXPECT_TRUE(is_certain("\"TABLE\"", "\"\"")) << "the data that are active";
    EXPECT_TRUE(is_certain("\"\"", "\"TABLE\"")) << "the machine has one";
    EXPECT_FALSE(is_certain("\"TABLE\"", "\"HEAD\""));
    EXPECT_FALSE(is_certain("\"TABLE\"", "\"0\"")) << "no data";
}

TEST(SiemensSwivel, IsUndecidedWithoutTheRotaryAxes) {
    const Driven bare =
        driven("G17 G90 G710\nG0 X1 Y1 Z50\nCYCLE800(0,\"T\",0,57,0,0,0,30,0,0,0,0,0,-1,100,1)\n"
               "G0 X1 Y1 Z1\nM30\n",
               known_environment(DialectId::siemens));
    EXPECT_EQ(bare.paths.front(), core::PathCertainty{});
    EXPECT_EQ(bare.paths.back(), core::PathCertainty::unknown);
}

TEST(SiemensSwivel, RefusesWhatTheMachineDecides) {
    const auto error_of_cycle = [](const std::string& parameters) {
        const Ran ran = run_text("G710\nCYCLE800(" + parameters + ")\n",
                                 environment_of(trunnion(), DialectId::siemens));
        return ran.run.error ? ran.run.error->message : "";
    };
    EXPECT_THAT(error_of_cycle("0,\"T\",0,173,0,0,0,30,0,0,0,0,0,-1,100,1"),
                HasSubstr("projection angles"));
    EXPECT_THAT(error_of_cycle("0,\"T\",0,185,0,0,0,90,90,0,0,0,0,-1,100,1"),
                HasSubstr("define no plane"));
    EXPECT_THAT(error_of_cycle("0,\"T\",0,192,0,0,0,30,0,0,0,0,0,-1,100,1"),
                HasSubstr("rotary axes"));
    EXPECT_THAT(error_of_cycle("0,\"T\",0,57,0,0,0,0,0,25,0,0,0,-1,100,1"),
                HasSubstr("level plane"));
    EXPECT_THAT(error_of_cycle("0,\"T\",0,57,0,0,0,30,0,0,0,0,0,0,100,1"), HasSubstr("direction"));
    EXPECT_THAT(error_of_cycle("0,\"T\",0,57,0,0,0,30,0,0,0,0,0,-1,100,1)\nG0 A10\nCYCLE800("),
                HasSubstr("program CYCLE800() before it"));
    EXPECT_THAT(error_of_cycle("0,\"T\",0,57,0,0,0,30,0,0,0,0,0,-1,100,1)\nTRANS X5\n"
                               "CYCLE800(0,\"T\",1,57,0,0,0,30,0,0,0,0,0,-1,100,1"),
                HasSubstr("adds a plane"));
    EXPECT_EQ(error_of_cycle("0,\"T\",0,57,0,0,0,30,0,0,0,0,0,-1,100,1)\nCYCLE800(0,\"0\",0,57,0,0,"
                             "0,50,0,0,0,0,0,-1,100,1"),
              "");
    EXPECT_THAT(error_of_cycle("0,\"T\",0,9,0,0,0,0,0,25,0,0,0,-1,100,1"), HasSubstr("no axis"));
}

} // namespace
} // namespace gcode
