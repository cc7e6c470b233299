#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/motion/plane_turn.h"
#include "gcode/language/control.h"
#include "tests/gcode/driven_machine.h"

namespace gcode {
namespace {

using core::PathCertainty;
using core::Vec3;
using testing::HasSubstr;

/// Everything that the program does not say is as on most machines.
Environment siemens_on(const core::Machine& machine) {
    Environment environment = environment_of(machine, DialectId::siemens);
    environment.control.answers[ControlQuestion::machine_moves_tip] = 0;
    return environment;
}

Driven driven_siemens(const std::string& lines, const core::Machine& machine) {
    return driven("G71 G90 G94 G17 G54\nT1 D1\nM6\n" + lines, siemens_on(machine));
}

Vec3 direction_at(const core::Machine& machine, const core::AxisPosition& position) {
    return core::tool_frame(machine, values_of(position))[2];
}

struct Target {
    Vec3 tip, direction;
    double first, second;
};

/// Targets with the direction that the axes give.
std::vector<Target> random_targets(const core::Machine& machine, size_t first, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-120.0, 120.0), tilt(8.0, 80.0), turn(-80, 80);
    std::vector<Target> targets(150);
    for (Target& target : targets) {
        target = {
            {place(random), place(random), place(random)}, Vec3(0.0), tilt(random), turn(random)};
        core::AxisValues values{};
        values[first] = target.first, values[5] = target.second;
        target.direction = core::tool_frame(machine, values)[2];
    }
    return targets;
}

std::string at(const Vec3& tip) {
    return fmt::format(" X={:.4f} Y={:.4f} Z={:.4f}", tip.x, tip.y, tip.z);
}

/// The same moves under TRAORI and under Fanuc's G43.4, whose motions are tested against sampling.
void expect_as_g434(const core::Machine& machine, size_t first) {
    const char letter = core::axis_letters[first];
    std::string siemens = "TRAORI\nORIMKS\nORIAXES\n", fanuc = "G21 G90 G94\nT1 M6\nG43.4 H1\n";
    for (const Target& target : random_targets(machine, first, 71)) {
        siemens += fmt::format("G1{} {}={:.4f} C={:.4f} F900\n", at(target.tip), letter,
                               target.first, target.second);
        fanuc += fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f} {}{:.4f} C{:.4f} F900\n", target.tip.x,
                             target.tip.y, target.tip.z, letter, target.first, target.second);
    }
    expect_same_tip_paths(driven_siemens(siemens, machine),
                          driven(fanuc, environment_of(machine, DialectId::fanuc)), 150);
}

TEST(SiemensOrientation, OfAxesUnderOrimksIsDrivenAsFanucDrivesIt) {
    expect_as_g434(trunnion(), 3);
    expect_as_g434(fork_head(), 4);
}

/// Under ORIWKS the tip goes straight and the tool turns in the plane of both directions, evenly.
void expect_in_plane(const core::Machine& machine, size_t first, bool by_vectors) {
    std::string lines = "TRAORI\nORIWKS\n";
    const auto targets = random_targets(machine, first, 72);
    for (const Target& target : targets) {
        const Vec3 d = 0.7 * target.direction; // the length of the vector has no meaning
        lines += "G1" + at(target.tip);
        lines += by_vectors ? fmt::format(" A3={:.9f} B3={:.9f} C3={:.9f} F900\n", d.x, d.y, d.z)
                            : fmt::format(" {}={:.9f} C={:.9f} F900\n", core::axis_letters[first],
                                          target.first, target.second);
    }
    const Driven found = driven_siemens(lines, machine);
    ASSERT_EQ(found.paths.size(), targets.size());
    size_t motion = 0;
    Vec3 tip_before(0.0), before(0.0);
    for (size_t i = 0; i < targets.size(); ++i) {
        const Vec3 there = targets[i].tip + datum;
        size_t count = 0;
        while (motion + count < found.motions.size()) {
            ++count;
            if (glm::distance(found.motions[motion + count - 1].tip->to, there) < 1e-4) break;
        }
        ASSERT_GT(count, 0u);
        const core::Motion& last = found.motions[motion + count - 1];
        EXPECT_LT(glm::distance(last.tip->to, there), 1e-4);
        EXPECT_LT(glm::distance(direction_at(machine, last.to), targets[i].direction), 1e-6);
        if (i > 0 && found.paths[i] == PathCertainty::known) {
            const Vec3 after = targets[i].direction;
            const Vec3 normal = glm::normalize(glm::cross(before, after));
            const double angle = std::acos(std::clamp(glm::dot(before, after), -1.0, 1.0));
            for (size_t part = 0; part < count; ++part) {
                const core::Motion& piece = found.motions[motion + part];
                const double fraction = static_cast<double>(part + 1) / static_cast<double>(count);
                EXPECT_LT(
                    glm::distance(piece.tip->to, tip_before + fraction * (there - tip_before)),
                    1e-3);
                const Vec3 d = direction_at(machine, piece.to);
                EXPECT_LT(std::abs(glm::dot(d, normal)), 1e-6);
                EXPECT_NEAR(std::acos(std::clamp(glm::dot(before, d), -1.0, 1.0)), fraction * angle,
                            1e-5);
                EXPECT_LE(piece.tip->turn_error, count < 1024 ? core::turn_error : 1e-3);
                if (part > 0) {
                    EXPECT_EQ(piece.from, found.motions[motion + part - 1].to);
                }
            }
        }
        motion += count;
        tip_before = there, before = targets[i].direction;
    }
    EXPECT_EQ(motion, found.motions.size());
    EXPECT_GT(found.motions.size(), 20 * targets.size()) << "they turn by up to 160 degrees";
}

TEST(SiemensOrientation, ByVectorsTurnsTheToolInTheirPlane) {
    expect_in_plane(trunnion(), 3, true);
    expect_in_plane(fork_head(), 4, true);
}

TEST(SiemensOrientation, ByAxesTurnsTheToolInThePlaneAsStated) {
    expect_in_plane(trunnion(), 3, false);
    Environment environment = siemens_on(trunnion());
    environment.control.answers[ControlQuestion::axes_turn_in_plane] = 0;
    const Driven even =
        driven("G71 G90 G94 G17 G54\nT1 D1\nM6\nTRAORI\nG0 A=40 C=0\nC=50\n", environment);
    EXPECT_EQ(even.motions.size(), 2u);
}

TEST(SiemensOrientation, LeavesAPoleByTurningInPlaceFirst) {
    const Driven found =
        driven_siemens("TRAORI\nG0 X=0 Y=0 Z=50\nG1 X=10 A3=0.5 B3=0.5 C3=0.7 F500\n"
                       "G1 X=20 A3=0 B3=0 C3=1\n",
                       trunnion());
    ASSERT_EQ(found.motions.size(), 4u);
    EXPECT_EQ(found.motions[1].from[3], found.motions[1].to[3]) << "A stays";
    EXPECT_EQ(found.motions[1].tip->from, found.motions[1].tip->to);
    EXPECT_EQ(found.motions[2].from[5], found.motions[2].to[5]) << "C stays";
    EXPECT_NEAR(*found.motions[3].to[3], 0.0, 1e-9);
    for (const PathCertainty path : found.paths) EXPECT_EQ(path, PathCertainty{});
}

TEST(SiemensOrientation, NearAPoleIsNotKnown) {
    const auto path = [](const std::string& lines, double limit) {
        Environment environment = siemens_on(trunnion());
        environment.control.answers[ControlQuestion::pole_limit] = limit;
        const Driven found =
            driven("G71 G90 G94 G17 G54\nT1 D1\nM6\nTRAORI\n" + lines, environment);
        return found.paths.back();
    };
    // One degree from the axis of C, turning about it.
    const std::string near = "G0 X=0 Y=0 Z=50 A=1\nG1 A=1 C=40 F500\n";
    EXPECT_EQ(path(near, 2.0), PathCertainty::doubtful);
    EXPECT_EQ(path(near, 0.5), PathCertainty::known);
    EXPECT_EQ(path("G0 X=0 Y=0 Z=50 A=30\nG1 C=180 F500\n", 0.0), PathCertainty::doubtful);
    EXPECT_EQ(path("G0 X=0 Y=0 Z=50 A=30\nG2 X=10 Y=0 CR=8 C=30 F500\n", 0.0),
              PathCertainty::doubtful);
}

TEST(SiemensOrientation, ComesOutOfAnUnknownPositionByAnUnknownWay) {
    // Through the pole: which of two positions the axes then have is not known.
    const Driven found = driven_siemens("TRAORI\nG0 X=0 Y=0 Z=50 A=1 C=10\n"
                                        "G1 A3=-0.02 B3=0.3 C3=0.95 F500\nG0 X=5\n"
                                        "TRAFOOF\nG54\nG0 X=0 Y=0 Z=80 A=20 C=30\nG0 A=25\n",
                                        trunnion());
    ASSERT_EQ(found.paths.size(), 5u);
    EXPECT_EQ(found.paths[0], PathCertainty::known);
    EXPECT_GT(found.paths[1], PathCertainty::known);
    EXPECT_GT(found.paths[2], PathCertainty::known);
    EXPECT_EQ(found.paths[3], PathCertainty::unknown)
        << "both axes are programmed, but from where?";
    EXPECT_EQ(found.paths[4], PathCertainty::known);
}

TEST(SiemensOrientation, CodesChooseHowTheToolTurns) {
    const auto count = [](const std::string& codes, int by_code) {
        Environment environment = siemens_on(trunnion());
        environment.control.answers[ControlQuestion::orientation_by_code] = by_code;
        return driven("G71 G90 G94 G17 G54\nT1 D1\nM6\nTRAORI\n" + codes
                          + "\nG0 A=40\nG0 A3=0.5 B3=0.3 C3=0.8\n",
                      environment)
            .motions.size();
    };
    for (const int by_code : {0, 1}) EXPECT_GT(count("", by_code), 2u);
    EXPECT_EQ(count("ORIMKS", 0), 2u);
    EXPECT_GT(count("ORIMKS", 1), 2u);
    EXPECT_GT(count("ORIAXES", 0), 2u);
    EXPECT_EQ(count("ORIAXES", 1), 2u);
    EXPECT_EQ(count("ORIMKS ORIAXES", 0), 2u);
}

/// A2, B2 and C2 turn the tool as the vector does that the manual's rotations give.
TEST(SiemensOrientation, ByAnglesIsAsByTheirVector) {
    std::mt19937 random(1129);
    std::uniform_real_distribution<double> place(-60.0, 60.0), angle(-70.0, 70.0);
    for (const bool is_euler : {true, false})
        for (const int by_code : {1, 0}) {
            const core::Machine machine = by_code ? trunnion() : fork_head();
            std::string angles = "TRAORI\n", vectors = "TRAORI\n";
            if (by_code) angles += is_euler ? "ORIEULER\n" : "ORIRPY\n";
            if (!by_code) angles += is_euler ? "ORIRPY\n" : "ORIEULER\n"; // has no meaning
            for (int i = 0; i < 60; ++i) {
                const double a = angle(random), b = angle(random), c = angle(random);
                const Vec3 z(0, 0, 1);
                const Vec3 d =
                    is_euler ? about_z(about_x(z, b), a) : about_z(about_y(about_x(z, a), b), c);
                const std::string where = at({place(random), place(random), place(random)});
                angles +=
                    "G1" + where + fmt::format(" A2={:.12f} B2={:.12f} C2={:.12f} F900\n", a, b, c);
                vectors += "G1" + where
                           + fmt::format(" A3={:.15f} B3={:.15f} C3={:.15f} F900\n", d.x, d.y, d.z);
            }
            Environment environment = siemens_on(machine);
            environment.control.answers[ControlQuestion::angles_by_code] = by_code;
            environment.control.answers[ControlQuestion::angles_are_euler] =
                by_code ? !is_euler : is_euler;
            const std::string start = "G71 G90 G94 G17 G54\nT1 D1\nM6\n";
            const Driven found = driven(start + angles, environment);
            const Driven other = driven(start + vectors, environment);
            ASSERT_GE(found.motions.size(), 60u);
            expect_same_ends(found, other);
        }
}

TEST(SiemensOrientation, C2IsOnlyMissedWhereAnglesAreSaidToBeRpy) {
    Environment environment = siemens_on(trunnion());
    const auto error = [&] {
        const Ran ran =
            run_text("G71 G90 G94 G17 G54\nT1 D1\nM6\nTRAORI\nG0 A2=20 B2=10\n", environment);
        return ran.run.error ? ran.run.error->message : std::string();
    };
    EXPECT_EQ(error(), "");
    environment.control.answers[ControlQuestion::angles_are_euler] = 0;
    EXPECT_THAT(error(), HasSubstr("all of A2, B2 and C2"));
}

TEST(SiemensOrientation, AngleToThePathIsUndecided) {
    const auto paths = [](const std::string& lines) {
        return driven_siemens("TRAORI\nG0 X=0 Y=0 Z=50 A=20 C=10\n" + lines, trunnion()).paths;
    };
    for (const std::string code : {"ORIPATH\nG1 X=10 F500\n", "G1 X=10 LEAD=5 TILT=2 F500\n",
                                   "ORIPATH\nG1 X=10 A5=0 B5=0.1 C5=1 F500\n"}) {
        const auto found =
            paths(code + "G1 X=20\nTRAFOOF\nG54\nG0 Z=90\nG0 A=0 C=0\nG0 X=1 Y=1 Z=80\nG0 Z=85\n");
        ASSERT_EQ(found.size(), 7u) << code;
        for (size_t i = 1; i < 5; ++i) EXPECT_GT(found[i], PathCertainty::known) << code << i;
        EXPECT_EQ(found.back(), PathCertainty::known) << code;
    }
    EXPECT_EQ(paths("G1 X=10 A5=0 B5=0.1 C5=1 F500\n").back(), PathCertainty::known)
        << "normals alone have no effect";
    // Where X and Y are after TRAFOOF depends on how the tool was turned, and words for rotary axes
    // in a block in which it follows the path are no positions.
    for (const std::string code : {"G1 X=46 Y=0 Z=60 LEAD=30 F500\nTRAFOOF\nG54\nG0 A=0 C=0\n",
                                   "ORIPATH\nG1 X=10 A=0 C=0 LEAD=5 F500\nTRAFOOF\nG54\n",
                                   "G1 A2=200 B2=2 F500\nTRAFOOF\nG54\nG0 A=0 C=0\n"})
        EXPECT_GT(paths(code + "G0 Z=100\nG0 Z=90\n").back(), PathCertainty::known) << code;
}

TEST(SiemensOrientation, OfAnUndescribedMachineLeavesItsAxesUnknown) {
    // An upright tool, but the table may have turned about it.
    const auto last = [](const std::string& lines) {
        return driven("G71 G90 G94 G17 G54\nT1 D1\nM6\nTRAORI\nG0 X=0 Y=0 Z=90\n" + lines,
                      known_environment(DialectId::siemens))
            .paths.back();
    };
    for (const std::string upright : {"G0 A2=0 B2=0 C2=0\n", "G0 A3=0 B3=0 C3=1\n"}) {
        EXPECT_EQ(last(upright + "G0 X=10 Y=10 Z=80\n"), PathCertainty::known);
        EXPECT_EQ(last(upright + "TRAFOOF\nG54\nG0 X=10 Y=10 Z=80\nG0 Z=70\n"),
                  PathCertainty::unknown);
        EXPECT_EQ(last(upright + "TRAFOOF\nG54\nG0 A=0 C=0\nG0 X=10 Y=10 Z=80\nG0 Z=70\n"),
                  PathCertainty::known);
    }
}

/// Z of TOROT is along the tool, and X as SD42980 says; coordinates are those of the work.
TEST(SiemensOrientation, TorotTurnsTheCoordinatesToTheTool) {
    const double kinds[] = {static_cast<double>(ToolFrameAxes::x_in_zx),
                            static_cast<double>(ToolFrameAxes::y_in_yz),
                            static_cast<double>(ToolFrameAxes::between),
                            static_cast<double>(ToolFrameAxes::of_machine)};
    for (const core::Machine& machine : {trunnion(), fork_head()})
        for (const double kind : kinds) {
            Environment environment = siemens_on(machine);
            environment.control.answers[ControlQuestion::tool_frame_axes] = kind;
            environment.control.answers[ControlQuestion::increment_has_offset] = 0;
            const std::string words =
                machine.spindle == core::link_of(4) ? "B=25 C=40" : "A=25 C=40";
            const auto tip = [&](const std::string& lines) {
                const Driven found =
                    driven("G71 G90 G94 G17 G54\nT1 D1\nM6\nTRAORI\nG0 X=3 Y=4 Z=50 " + words + "\n"
                               + lines,
                           environment);
                for (const PathCertainty path : found.paths) EXPECT_EQ(path, PathCertainty{});
                return core::tip_position(machine, values_of(found.motions.back().to), tool_length)
                       - datum;
            };
            const Vec3 before = tip("");
            EXPECT_LT(glm::distance(before, Vec3(3, 4, 50)), 1e-9);
            const Vec3 zero = tip("TOROT\nG0 X=0 Y=0 Z=0\n");
            EXPECT_LT(glm::length(zero), 1e-9) << "the origin stays";
            const Vec3 x = tip("TOROT\nG0 X=1 Y=0 Z=0\n"), y = tip("TOROTZ\nG0 X=0 Y=1 Z=0\n"),
                       z = tip("TOROT\nG0 X=0 Y=0 Z=1\n");
            core::AxisValues turned{};
            turned[machine.spindle == core::link_of(4) ? 4 : 3] = 25.0, turned[5] = 40.0;
            const core::Mat3 tool = core::tool_frame(machine, turned);
            EXPECT_LT(glm::distance(z, tool[2]), 1e-9);
            EXPECT_LT(glm::distance(glm::cross(x, y), z), 1e-9);
            const auto is = [&](ToolFrameAxes some) { return kind == static_cast<double>(some); };
            if (is(ToolFrameAxes::x_in_zx)) {
                EXPECT_NEAR(x.y, 0.0, 1e-9);
                EXPECT_GT(x.x, 0.0);
            } else if (is(ToolFrameAxes::y_in_yz)) {
                EXPECT_NEAR(y.x, 0.0, 1e-9);
                EXPECT_GT(y.y, 0.0);
            } else if (is(ToolFrameAxes::between)) {
                EXPECT_NEAR(x.y, y.x, 1e-9);
                EXPECT_GT(x.x, 0.0);
            } else {
                EXPECT_LT(glm::distance(x, tool[0]), 1e-9);
            }
            // The usual way out, along the tool.
            EXPECT_LT(glm::distance(tip("TOROT\nG91 G0 Z=100\n"), before + 100.0 * tool[2]), 1e-9);
            EXPECT_LT(glm::distance(tip("TOROT\nG0 X=1\nTOROTOF\nG0 X=1 Y=2 Z=3\n"), Vec3(1, 2, 3)),
                      1e-9);
        }
}

TEST(SiemensOrientation, SmoothingEndsWithOrisofAlone) {
    const auto path = [](const std::string& codes) {
        return driven_siemens("TRAORI\n" + codes + "\nG0 A=40\nG0 A3=0.5 B3=0.3 C3=0.8\n",
                              trunnion())
            .paths.back();
    };
    EXPECT_EQ(path("ORISON\nORIVECT"), PathCertainty::doubtful);
    EXPECT_EQ(path("ORISON\nORISOF"), PathCertainty::known);
    EXPECT_EQ(path("ORICONCW\nORISOF"), PathCertainty::doubtful);
}

/// The nearest position with a direction may be on the other side of the pole, where the tool does
/// not come past.
TEST(SiemensOrientation, ByVectorsReachesThePositionOnItsWay) {
    const Driven found = driven_siemens(
        "TRAORI\nG0 X=0 Y=0 Z=50 A=10\nG1 A3=0.15 B3=0.18 C3=0.98 F500\n", trunnion());
    EXPECT_EQ(found.paths.back(), PathCertainty::known);
    EXPECT_GT(*found.motions.back().to[3], 5.0);
    EXPECT_GT(std::abs(*found.motions.back().to[5]), 90.0);
    // Where it may go past either way, nobody knows on which side it is from then on.
    const Driven near = driven_siemens(
        "TRAORI\nG0 X=0 Y=0 Z=50 A=10\nG1 A3=0.001 B3=0.18 C3=0.98 F500\nG1 X=5\n", trunnion());
    EXPECT_EQ(near.paths.back(), PathCertainty::unknown);
}

TEST(SiemensOrientation, IsGivenBackBySave) {
    const auto count = [](const std::string& codes, const std::string& in_subprogram) {
        return driven(
                   "%_N_MAIN_MPF\nG71 G90 G94 G17 G54\nT1 D1\nM6\nTRAORI\n" + codes
                       + "\nG0 A=40\nSUB1\nG0 A3=0.5 B3=0.3 C3=0.8\nM30\n%_N_SUB1_SPF\nPROC SUB1 "
                         "SAVE\n"
                       + in_subprogram + "\nM17\n",
                   siemens_on(trunnion()))
            .motions.size();
    };
    EXPECT_GT(count("ORIWKS", "ORIMKS"), 2u);
    EXPECT_EQ(count("ORIMKS", "ORIWKS"), 2u);
}

TEST(SiemensOrientation, TraoriMayDeselectTheWorkOffset) {
    const auto end = [](const std::string& lines, int kept) {
        Environment environment = siemens_on(trunnion());
        environment.control.answers[ControlQuestion::frame_survives_traori] = kept;
        return *driven("G71 G90 G94 G17 G54\nT1 D1\nM6\n" + lines, environment)
                    .motions.back()
                    .to[0];
    };
    EXPECT_NEAR(end("TRAORI\nG0 X=10 Y=0 Z=0\n", 1), 10.0 + datum.x, 1e-9);
    EXPECT_NEAR(end("TRAORI\nG0 X=10 Y=0 Z=0\n", 0), 10.0, 1e-9);
    EXPECT_NEAR(end("TRANS X5\nTRAORI\nG54\nG0 X=10 Y=0 Z=0\n", 0), 10.0 + datum.x, 1e-9);
    EXPECT_NEAR(end("TRANS X5\nTRAORI\nG0 X=10 Y=0 Z=0\nTRAFOOF\nG0 X=1 Y=0 Z=0\n", 1),
                6.0 + datum.x, 1e-9);
}

TEST(SiemensOrientation, IsNotFollowedWhereNobodyKnowsWhatTheAxesDo) {
    const auto last = [](const std::string& lines, const core::Machine& machine = trunnion()) {
        return driven_siemens(lines, machine).paths.back();
    };
    EXPECT_EQ(last("TRAORI(2)\nG0 X=0 Y=0 Z=50 A=30\n"), PathCertainty::unknown);
    EXPECT_EQ(last("TRAORI(1,0,1,0)\nG0 X=0 Y=0 Z=50 A=30\n"), PathCertainty::unknown);
    EXPECT_EQ(last("TRAORI(1)\nG0 X=0 Y=0 Z=50 A=30\n"), PathCertainty::known);
    EXPECT_EQ(last("TRAORI\nG0 X=0 Y=0 Z=50 A=30\nSUPA G0 Z0\n"), PathCertainty::unknown);
    EXPECT_EQ(last("TRAORI\nG0 X=0 Y=0 Z=50\nSUPA G0 Z0\n"), PathCertainty::known);
    EXPECT_EQ(last("TRAORI\nORICONCW\nG0 X=0 Y=0 Z=50 A=30\n"), PathCertainty::doubtful);
    // Without the rotary axes of the machine.
    const Driven bare = driven("G71 G90 G94 G17 G54\nT1 D1\nM6\nTRAORI\n"
                               "G0 X=0 Y=0 Z=50 A3=0.5 B3=0 C3=0.8\n",
                               known_environment(DialectId::siemens));
    EXPECT_EQ(bare.paths.back(), PathCertainty::unknown);
    const auto refused = [](const std::string& lines) {
        const Ran ran =
            run_text("G71 G90 G94 G17 G54\nT1 D1\nM6\n" + lines, siemens_on(trunnion()));
        return ran.run.error ? ran.run.error->message : std::string();
    };
    EXPECT_THAT(refused("G0 A3=0 B3=0 C3=1\n"), HasSubstr("program TRAORI before"));
    EXPECT_THAT(refused("TRAORI\nG0 A3=0 B3=0 C3=0\n"), HasSubstr("no tool direction"));
    EXPECT_THAT(refused("G0 A2=0 B2=10\n"), HasSubstr("program TRAORI before"));
    EXPECT_THAT(refused("TRAORI\nG0 A2=10\n"), HasSubstr("both A2 and B2"));
    EXPECT_THAT(refused("TRAORI\nORIRPY\nG0 A2=10 B2=10\n"), HasSubstr("all of A2, B2 and C2"));
    EXPECT_THAT(refused("TRAORI\nORIRPY2\nG0 A2=10 B2=10 C2=10\n"), HasSubstr("A3= B3= C3="));
    EXPECT_THAT(refused("TRAORI\nG0 A2=10 B2=10 A3=1\n"), HasSubstr("in one block"));
    EXPECT_THAT(refused("TRAORI\nG0 A2=10 B2=10 C=5\n"), HasSubstr("cannot have both"));
    EXPECT_THAT(refused("TRAORI\nG0 A3=1 C3=1 A=5\n"), HasSubstr("cannot have both"));
    EXPECT_THAT(refused("TRAORI\nORIAXPOS\nG0 A2=10 B2=10 C2=5\n"), HasSubstr("A3= B3= C3="));
    EXPECT_THAT(refused("TRAORI\nG0 A=20\nTOROT\nTRANS X5\n"), HasSubstr("TOROTOF"));
    EXPECT_THAT(refused("TOROT\n"), HasSubstr("while TRAORI is on"));
    EXPECT_THAT(refused("TRAORI\nTRANS X5\nTOROT\n"), HasSubstr("TRANS"));
    EXPECT_THAT(refused("TRAORI\nG0 A=20\nTOROT\nG0 A=30\n"), HasSubstr("TOROTOF"));
    EXPECT_THAT(refused("TRAORI\nG0 A=20\nTOROT\nTRAFOOF\n"), HasSubstr("TOROTOF"));
    EXPECT_THAT(refused("G41 G1 X5 F100\nTRAORI\n"), HasSubstr("G40"));
    EXPECT_THAT(refused("TRAORI\nG41 G1 X5 F100\nX20 A=10\n"), HasSubstr("G40"));
    EXPECT_THAT(refused("TRAORI\nSCALE X2\nG0 A3=0.5 B3=0 C3=0.5\n"), HasSubstr("SCALE"));
    EXPECT_THAT(refused("TRAORI\nG74 X1=0\n"), HasSubstr("TRAFOOF"));
}

} // namespace
} // namespace gcode
