#include <cmath>
#include <functional>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/driven_machine.h"

namespace gcode {
namespace {

using core::Vec3;
using testing::HasSubstr;
using testing::Not;

/// A plane: its statement, and where it puts a point.
struct KnownPlane {
    std::string words;
    std::function<Vec3(const Vec3&)> place;
};

class Planes {
public:
    explicit Planes(unsigned seed) : random_(seed) {}

    double angle(double most) {
        return std::round(1e4 * std::uniform_real_distribution<double>(-most, most)(random_)) / 1e4;
    }

    KnownPlane spatial() {
        const double a = angle(60), b = angle(60), c = angle(170);
        return {fmt::format("SPATIAL SPA{:+} SPB{:+} SPC{:+}", a, b, c),
                [=](const Vec3& p) { return about_z(about_y(about_x(p, a), b), c); }};
    }
    KnownPlane euler() {
        const double pr = angle(170), nu = std::abs(angle(70)), rot = angle(170);
        return {fmt::format("EULER EULPR{:+} EULNU{:+} EULROT{:+}", pr, nu, rot),
                [=](const Vec3& p) { return about_z(about_x(about_z(p, rot), nu), pr); }};
    }
    KnownPlane vector() {
        const KnownPlane any = spatial();
        const Vec3 x = any.place({1, 0, 0}), y = any.place({0, 1, 0}), z = any.place({0, 0, 1});
        // The base vector need not be normal to the other, and neither of length 1.
        const Vec3 base = 1.7 * x + 0.4 * z, normal = 0.8 * z;
        return {fmt::format("VECTOR BX{:+.9f} BY{:+.9f} BZ{:+.9f} NX{:+.9f} NY{:+.9f} NZ{:+.9f}",
                            base.x, base.y, base.z, normal.x, normal.y, normal.z),
                [=](const Vec3& p) { return p.x * x + p.y * y + p.z * z; }};
    }
    KnownPlane points() {
        const KnownPlane any = spatial();
        const Vec3 x = any.place({1, 0, 0}), y = any.place({0, 1, 0}), z = any.place({0, 0, 1});
        const Vec3 first(angle(50), angle(50), angle(50));
        const Vec3 second = first + 31.0 * x, third = first + 12.0 * x + 25.0 * y;
        return {fmt::format("POINTS P1X{:+.9f} P1Y{:+.9f} P1Z{:+.9f} P2X{:+.9f} P2Y{:+.9f} "
                            "P2Z{:+.9f} P3X{:+.9f} P3Y{:+.9f} P3Z{:+.9f}",
                            first.x, first.y, first.z, second.x, second.y, second.z, third.x,
                            third.y, third.z),
                [=](const Vec3& p) { return p.x * x + p.y * y + p.z * z; }};
    }

private:
    std::mt19937 random_;
};

/// Goes to a point of the plane after it was set, and compares tip and tool with the plane.
void expect_in_plane(const core::Machine& machine, const KnownPlane& plane,
                     const std::string& positioning) {
    SCOPED_TRACE(plane.words + " " + positioning);
    const Driven found = driven_klartext("L X+5 Y-8 Z+60 R0 FMAX\nPLANE " + plane.words + " "
                                             + positioning + "\nL X+20 Y-15 Z+33 R0 FMAX\n",
                                         machine);
    ASSERT_FALSE(found.motions.empty());
    const core::AxisValues end = values_of(found.motions.back().to);
    const Vec3 tip = core::tip_position(machine, end, tool_length);
    EXPECT_LT(glm::distance(tip, datum + plane.place({20, -15, 33})), 1e-5);
    const Vec3 above = core::tip_position(machine, end, tool_length - 10.0);
    EXPECT_LT(glm::distance(above - tip, 10.0 * plane.place({0, 0, 1})), 1e-5);
    for (const core::PathCertainty path : found.paths) EXPECT_EQ(path, core::PathCertainty{});
}

TEST(KlartextPlane, IsWhereTheManualPutsIt) {
    Planes planes(20261127);
    for (int i = 0; i < 1000; ++i)
        for (const auto make :
             {&Planes::spatial, &Planes::euler, &Planes::vector, &Planes::points}) {
            const KnownPlane plane = (planes.*make)();
            expect_in_plane(i % 2 ? trunnion() : fork_head(), plane,
                            i % 3 == 0 ? "TURN FMAX" : "MOVE DIST20 FMAX");
            if (HasFailure()) return;
        }
}

TEST(KlartextPlane, MayLeaveTheRotaryAxesToTheProgram) {
    const core::Machine machine = trunnion();
    const Driven found = driven_klartext(
        "PLANE SPATIAL SPA+30 SPB+0 SPC+0 STAY\nL A+Q120 C+Q122 R0 FMAX\nL X+1 Y+2 Z+3 FMAX\n",
        machine);
    const core::AxisValues end = values_of(found.motions.back().to);
    EXPECT_LT(glm::distance(core::tip_position(machine, end, tool_length),
                            datum + about_x({1, 2, 3}, 30)),
              1e-9);
    EXPECT_NEAR(std::abs(end[3]), 30.0, 1e-9);
}

TEST(KlartextPlane, LeavesXYAndZWhenTheProgramTurnsARotaryAxis) {
    const core::Machine machine = trunnion();
    for (const char* plane : {"PLANE SPATIAL SPA+30 SPB+0 SPC+0 STAY\n",
                              "CYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+30 B+0 C+0\n"}) {
        const Driven found = driven_klartext(std::string("L X+5 Y-8 Z+60 R0 FMAX\n") + plane
                                                 + "L A+Q120 C+Q122 R0 FMAX\nL Z+100 A+20 FMAX\n",
                                             machine);
        ASSERT_EQ(found.motions.size(), 3u);
        for (size_t axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(*found.motions[1].to[axis], *found.motions[0].to[axis], 1e-9);
        for (size_t axis = 0; axis < 2; ++axis) // of a block with Z, X and Y follow the plane
            EXPECT_TRUE(found.motions[2].to[axis].has_value());
    }
}

TEST(KlartextPlane, ChoosesTheSolutionThatIsAskedFor) {
    for (const char* sign : {"+", "-"}) {
        const Driven found = driven_klartext(
            fmt::format("PLANE SPATIAL SPA+30 SPB+10 SPC+20 TURN FMAX SEQ{}\n", sign), trunnion());
        EXPECT_EQ(values_of(found.motions.back().to)[3] > 0.0, *sign == '+');
        EXPECT_THAT(found.warnings, Not(HasSubstr("nearest")));
    }
    EXPECT_THAT(
        driven_klartext("PLANE SPATIAL SPA+30 SPB+10 SPC+20 TURN FMAX\n", trunnion()).warnings,
        HasSubstr("nearest"));
}

TEST(KlartextPlane, MoveKeepsAPointOnTheToolWhereItIs) {
    const core::Machine machine = trunnion();
    for (const double distance : {0.0, 25.0}) {
        const Driven found = driven_klartext(
            fmt::format("L X+30 Y-20 Z+15 R0 FMAX\nPLANE SPATIAL SPA+40 SPB+0 SPC+0 MOVE DIST{} "
                        "FMAX\n",
                        distance),
            machine);
        ASSERT_EQ(found.motions.size(), 2u);
        const auto point = [&](size_t i) {
            return core::tip_position(machine, values_of(found.motions[i].to),
                                      tool_length + distance);
        };
        EXPECT_LT(glm::distance(point(0), point(1)), 1e-9);
    }
}

TEST(KlartextPlane, FormsThatBuildOnOthers) {
    const core::Machine machine = trunnion();
    const KnownPlane relative{
        "SPATIAL SPA+20 SPB+10 SPC+0 STAY\nPLANE RELATIV SPB+15",
        [](const Vec3& p) { return about_y(about_x(about_y(p, 15), 20), 10); }};
    expect_in_plane(machine, relative, "TURN FMAX");
    expect_in_plane(machine, {"AXIAL A+25", [](const Vec3& p) { return about_x(p, 25); }},
                    "TURN FMAX");
    expect_in_plane(
        machine,
        {"RESET TURN FMAX\nPLANE AXIAL C+40", [](const Vec3& p) { return about_z(p, 40); }},
        "TURN FMAX");
}

TEST(KlartextPlane, CanBeReset) {
    const core::Machine machine = trunnion();
    for (const char* how : {"TURN FMAX", "MOVE DIST10 FMAX"}) {
        const Driven found =
            driven_klartext(fmt::format("PLANE SPATIAL SPA+40 SPB+0 SPC+0 TURN FMAX\nPLANE RESET "
                                        "{}\nL X+1 Y+2 Z+3 FMAX\n",
                                        how),
                            machine);
        const core::AxisValues end = values_of(found.motions.back().to);
        EXPECT_EQ(end[3], 0.0);
        EXPECT_LT(
            glm::distance(core::tip_position(machine, end, tool_length), datum + Vec3(1, 2, 3)),
            1e-9);
    }
}

TEST(KlartextPlane, ShiftsAfterItAreInThePlane) {
    const core::Machine machine = trunnion();
    const Driven found = driven_klartext(
        "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10\nPLANE SPATIAL SPA+30 SPB+0 SPC+0 TURN FMAX\n"
        "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\nL X+5 Y+0 Z+2 FMAX\n",
        machine);
    const core::AxisValues end = values_of(found.motions.back().to);
    EXPECT_LT(glm::distance(core::tip_position(machine, end, tool_length),
                            datum + Vec3(10, 0, 0) + about_x(about_z({5, 0, 2}, 90), 30)),
              1e-9);
}

TEST(KlartextPlane, OfCycle19) {
    const core::Machine machine = trunnion();
    const Driven found = driven_klartext(
        "CYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+0 B+20 C+30\nL A+Q120 C+Q122 R0 FMAX\n"
        "L X+20 Y-15 Z+33 R0 FMAX\n",
        machine);
    const core::AxisValues end = values_of(found.motions.back().to);
    EXPECT_LT(glm::distance(core::tip_position(machine, end, tool_length),
                            datum + about_z(about_y({20, -15, 33}, 20), 30)),
              1e-9);
    EXPECT_THAT(found.warnings, HasSubstr("spatial angles"));
}

TEST(KlartextPlane, IsUndecidedWithoutTheRotaryAxes) {
    const Driven bare =
        driven(klartext_program("TOOL CALL 1 Z S5000\nL X+1 Y+1 Z+50 FMAX\nPLANE SPATIAL SPA+30 "
                                "SPB+0 SPC+0 TURN FMAX\nL X+1 Y+1 Z+1 FMAX\nPLANE RESET TURN "
                                "FMAX\nL X+1 Y+1 Z+50 FMAX\nL X+3 FMAX\n"),
               known_environment(DialectId::heidenhain));
    ASSERT_GE(bare.paths.size(), 4u);
    EXPECT_EQ(bare.paths[0], core::PathCertainty{});
    EXPECT_EQ(bare.paths[1], core::PathCertainty::unknown);
    EXPECT_EQ(bare.paths.back(), core::PathCertainty{});
    EXPECT_THAT(bare.warnings, HasSubstr("needs the rotary axes"));
}

TEST(KlartextPlane, OfCycle19DoesNotSayWhereTheRotaryAxesAre) {
    const Driven bare =
        driven(klartext_program(
                   "TOOL CALL 1 Z S5000\nPLANE SPATIAL SPA+30 SPB+0 SPC+0 TURN FMAX\n"
                   "PLANE RESET STAY\nCYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+0 B+0 C+0\n"
                   "L X+1 Y+1 Z+1 FMAX\nL A+0 B+0 C+0 FMAX\nL X+1 Y+1 Z+50 FMAX\nL X+3 FMAX\n"),
               known_environment(DialectId::heidenhain));
    ASSERT_EQ(bare.paths.size(), 4u);
    EXPECT_EQ(bare.paths[0], core::PathCertainty::unknown);
    EXPECT_EQ(bare.paths[3], core::PathCertainty{});
}

TEST(KlartextPlane, TableRotTurnsTheTableUnderALevelPlane) {
    const core::Machine machine = trunnion();
    for (const double angle : {35.0, -120.0, 180.0}) {
        const Driven found = driven_klartext(
            fmt::format("L X+5 Y-8 Z+60 R0 FMAX\nPLANE SPATIAL SPA+0 SPB+0 SPC{:+} TURN FMAX TABLE "
                        "ROT\nL X+20 Y-15 Z+33 R0 FMAX\nL X+30 FMAX\n",
                        angle),
            machine);
        const auto at = [&](size_t from_end) {
            return values_of(found.motions[found.motions.size() - 1 - from_end].to);
        };
        EXPECT_LT(glm::distance(core::tip_position(machine, at(1), tool_length),
                                datum + about_z({20, -15, 33}, angle)),
                  1e-6);
        // X of the plane is X of the machine now.
        EXPECT_NEAR(at(0)[0] - at(1)[0], 10.0, 1e-9);
        EXPECT_NEAR(at(0)[1] - at(1)[1], 0.0, 1e-9);
    }
    // The table stays with COORD ROT, and that of a head that turns stays anyway.
    EXPECT_EQ(values_of(driven_klartext("PLANE SPATIAL SPA+0 SPB+0 SPC+35 TURN FMAX COORD ROT\n"
                                        "L X+20 Y-15 Z+33 R0 FMAX\n",
                                        machine)
                            .motions.back()
                            .to)[5],
              0.0);
    const core::Machine head = fork_head();
    const Driven found = driven_klartext(
        "PLANE SPATIAL SPA+0 SPB+0 SPC+35 TURN FMAX TABLE ROT\nL X+20 Y-15 Z+33 R0 FMAX\n", head);
    EXPECT_EQ(values_of(found.motions.back().to)[5], 0.0);
    EXPECT_LT(
        glm::distance(core::tip_position(head, values_of(found.motions.back().to), tool_length),
                      datum + about_z({20, -15, 33}, 35)),
        1e-6);
    // Where C carries the tilting axis, TABLE ROT does nothing, and controls differ as with COORD
    // ROT.
    core::Machine other;
    other.axes[5] = {.direction = {0, 0, 1}, .side = core::Side::table};
    other.axes[3] = {
        .direction = {1, 0, 0}, .side = core::Side::table, .carrier = core::link_of(5)};
    other.table = core::link_of(3);
    const Ran ran =
        run_text(klartext_program(
                     "TOOL CALL 1 Z S5000\nL C+50 R0 FMAX\nPLANE SPATIAL SPA+0 SPB+0 SPC+35 TURN "
                     "FMAX TABLE ROT\n"),
                 environment_of(other, DialectId::heidenhain));
    ASSERT_TRUE(ran.run.error);
    EXPECT_THAT(ran.run.error->message, HasSubstr("controls differ"));
    // A tilted plane is reached in the same way by both.
    const std::string tilted = "PLANE SPATIAL SPA+20 SPB+10 SPC+35 TURN FMAX SEQ+ ";
    expect_same_motions(driven_klartext(tilted + "TABLE ROT\nL X+2 R0 FMAX\n", machine),
                        driven_klartext(tilted + "COORD ROT\nL X+2 R0 FMAX\n", machine));
}

TEST(KlartextPlane, RefusesWhatCannotBe) {
    const auto error_of = [](const std::string& words) {
        const Ran ran = run_text(klartext_program("TOOL CALL 1 Z S5000\nPLANE " + words + "\n"),
                                 environment_of(trunnion(), DialectId::heidenhain));
        return ran.run.error ? ran.run.error->message : "";
    };
    EXPECT_THAT(error_of("VECTOR BX+0 BY+0 BZ+1 NX+0 NY+0 NZ+1 STAY"), HasSubstr("parallel"));
    EXPECT_THAT(error_of("POINTS P1X+0 P1Y+0 P1Z+0 P2X+1 P2Y+0 P2Z+0 P3X+2 P3Y+0 P3Z+0 STAY"),
                HasSubstr("on a line"));
    EXPECT_THAT(error_of("AXIAL B+10 TURN FMAX"), HasSubstr("no axis B"));
    EXPECT_EQ(error_of("AXIAL A+10 TURN FMAX COORD ROT"), "");
    EXPECT_THAT(error_of("SPATIAL SPA+10 SPB+0 SPC+0 TURN FMAX\nL C+90 FMAX\nPLANE SPATIAL SPA+0 "
                         "SPB+0 SPC+0 TURN FMAX"),
                HasSubstr("away from 0"));
    EXPECT_THAT(
        error_of("RESET STAY\nCYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+20\nPLANE SPATIAL "
                 "SPA+10 SPB+0 SPC+0 TURN FMAX\nCYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+30"),
        HasSubstr("came before the tilted plane"));
    EXPECT_THAT(
        error_of("RESET STAY\nCYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+20\nPLANE AXIAL A+10 "
                 "TURN FMAX"),
        HasSubstr("PLANE AXIAL while"));
    EXPECT_THAT(error_of("RESET STAY\nM128\nPLANE SPATIAL SPA+10 SPB+0 SPC+0 TURN FMAX"),
                HasSubstr("M129 before it"));
    EXPECT_THAT(error_of("SPATIAL SPA+10 SPB+0 SPC+0 TABLE FMAX"), Not(testing::IsEmpty()));
    EXPECT_THAT(error_of("PROJECTED PROPR+10 PROMIN+0 ROT+0 STAY"), HasSubstr("not supported"));
}

} // namespace
} // namespace gcode
