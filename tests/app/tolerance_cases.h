#pragma once

#include <optional>
#include <string>

#include <fmt/format.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/check/program_runner.h"
#include "app/tolerance/tolerances.h"
#include "core/sim/run/simulator.h"
#include "tests/support/random_setup.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace app_test {

/// States that lengths without a decimal point are millimetres.
inline const std::string lengths_in_mm = "[control]\n\"3401#0\" = 1\n";

/// A program and a set-up in files.
struct ToleranceCase {
    test_support::ScopedFolder folder;
    app::CheckJob job;

    ToleranceCase(const std::string& setup, const std::string& program) {
        job.program = folder.write("program.nc", program);
        job.setup = folder.write("setup.toml", setup);
    }
};

/// How a check ends.
struct DeviatedEnd {
    core::Verdict verdict = core::Verdict::clear;
    bool is_beyond_travel = false;

    bool is_clear() const { return verdict == core::Verdict::clear && !is_beyond_travel; }
    /// Whether something certainly goes wrong.
    bool is_wrong() const { return verdict > core::Verdict::undecided || is_beyond_travel; }
};

/// Checks the case with one value changed, as if the set-up stated it; empty if no such set-up
/// exists.
inline std::optional<DeviatedEnd> checked_with(const app::CheckJob& job,
                                               const app::Deviation& deviation, double by) {
    auto check = app::read_check(job);
    if (!check) return std::nullopt;
    if (!app::deviate({check->run.setup, check->file.environment}, deviation, by))
        return std::nullopt;
    if (!app::place_check(job, *check)) return std::nullopt;
    app::ProgramRunner runner(*check);
    runner.run_to_end();
    DeviatedEnd end{check->run.verdict};
    for (const core::Finding& finding : check->run.findings)
        end.is_beyond_travel = end.is_beyond_travel || finding.rule == "over-travel";
    return end;
}

/// Some random machining of a plate: slots, pockets, holes and arcs with up to two tools, one or
/// two work offsets, clamps around it, and retracts by G0, G53 or G28.
struct RandomJob {
    test_support::Dice dice;
    std::string setup, program;

    /// `rounding`: how far the control rounds corners between rapids, mm.
    explicit RandomJob(unsigned seed, double rounding = 0.0) : dice{std::mt19937(seed)} {
        write_setup(rounding);
        write_program();
    }

private:
    bool two_offsets = false, two_tools = false;
    double d1 = 10.0, d2 = 6.0;
    // The frame of G55 in that of G54.
    core::Vec3 second = core::Vec3(0.0);

    void write_setup(double rounding) {
        two_offsets = dice.chance(0.4);
        two_tools = dice.chance(0.6);
        d1 = dice.between(8.0, 14.0);
        d2 = dice.between(4.0, 8.0);
        second = {dice.between(-20.0, 20.0), dice.between(-20.0, 20.0), dice.between(-5.0, 5.0)};
        test_support::SetupWriter writer;
        writer.also(lengths_in_mm);
        if (rounding > 0.0)
            writer.machine(fmt::format("rapid_corner_tolerance = {}\n", rounding)
                           + test_support::SetupWriter::mill());
        writer.root(dice.chance(0.3) ? "mesh_size = 0.8\nallowance = 1.5" : "mesh_size = 0.8");
        const double out1 = dice.between(30.0, 50.0), out2 = dice.between(25.0, 45.0);
        const double h1 = out1 + 40.0, h2 = out2 + 40.0;
        writer.lengths(fmt::format("[[length_offset]]\nnumber = 1\nlength = {}\n"
                                   "[[length_offset]]\nnumber = 2\nlength = {}\n",
                                   h1, h2));
        writer.offsets(fmt::format(
            "G54 = {{ X = -350, Y = -200, Z = -320 }}\nG55 = {{ X = {}, Y = {}, Z = {} }}",
            -350.0 + second.x, -200.0 + second.y, -320.0 + second.z));
        writer.tool(fmt::format("number = 1\nshape = \"{}\"\ndiameter = {}\nflute_length = 22\n"
                                "{}stick_out = {}\nholder = [[{}, {}, 40]]\n",
                                dice.chance(0.5) ? "flat" : "bull", d1, "", out1,
                                dice.between(20.0, 50.0), dice.between(30.0, 60.0)));
        writer.also_tool(fmt::format("number = 2\nshape = \"{}\"\ndiameter = {}\n"
                                     "flute_length = 20\nstick_out = {}\nholder = [[{}, {}, 40]]\n",
                                     dice.chance(0.5) ? "drill" : "ball", d2, out2,
                                     dice.between(20.0, 40.0), dice.between(20.0, 50.0)));
        if (dice.chance(0.2))
            writer.stock("cylinder = { radius = 60, height = 30 }\nat = [50, 50, -30]\n");
        const size_t clamps = dice.index(3);
        for (size_t i = 0; i < clamps; ++i) {
            const double x = dice.between(-30.0, 110.0), high = dice.between(2.0, 40.0);
            const double y =
                dice.chance(0.5) ? dice.between(-30.0, -15.0) : dice.between(100.0, 115.0);
            writer.fixture(fmt::format("clamp {}", i + 1),
                           fmt::format("box = [[{}, {}, -30], [{}, {}, {}]]\n", x, y, x + 20.0,
                                       y + 15.0, high));
        }
        setup = writer.text();
        const size_t bull = setup.find("shape = \"bull\"");
        if (bull != std::string::npos) setup.insert(bull, "corner_radius = 1.5\n");
    }

    void line(const std::string& text) { program += text + "\n"; }

    void slot(const core::Vec3& at, double depth, double over) {
        const double x = dice.between(15.0, 85.0) - at.x, y = dice.between(15.0, 85.0) - at.y;
        const double to_x = dice.between(15.0, 85.0) - at.x, to_y = dice.between(15.0, 85.0) - at.y;
        line(fmt::format("G0 X{:.3f} Y{:.3f}", x, y));
        line(fmt::format("Z{:.3f}", over - at.z));
        line(fmt::format("G1 Z{:.3f} F200", -depth - at.z));
        if (dice.chance(0.3))
            line(fmt::format("G2 X{:.3f} Y{:.3f} I8 J0", x + 16.0, y));
        else
            line(fmt::format("X{:.3f} Y{:.3f}", to_x, to_y));
        line(fmt::format("G0 Z{:.3f}", (dice.chance(0.5) ? over : 30.0) - at.z));
    }

    void pocket(const core::Vec3& at, double depth, double over, double d) {
        const double x = dice.between(20.0, 50.0) - at.x, y = dice.between(20.0, 50.0) - at.y;
        const double wide = dice.between(10.0, 35.0), step = 0.6 * d;
        line(fmt::format("G0 X{:.3f} Y{:.3f}", x, y));
        line(fmt::format("Z{:.3f}", over - at.z));
        line(fmt::format("G1 Z{:.3f} F200", -depth - at.z));
        for (double v = 0.0; v <= wide; v += step)
            line(fmt::format("Y{:.3f}\nX{:.3f}\nX{:.3f}", y + v, x + wide, x));
        if (dice.chance(0.5)) {
            // A rapid inside the pocket, and down again.
            line(fmt::format("G0 Z{:.3f}", -depth + dice.between(0.3, 2.0) - at.z));
            line(fmt::format("X{:.3f} Y{:.3f}", x + 0.5 * wide, y + 0.5 * step));
        }
        line(fmt::format("G0 Z{:.3f}", 30.0 - at.z));
    }

    void hole(const core::Vec3& at, double over) {
        line(fmt::format("G0 X{:.3f} Y{:.3f}", dice.between(10.0, 90.0) - at.x,
                         dice.between(10.0, 90.0) - at.y));
        line(fmt::format("Z{:.3f}", over - at.z));
        line(fmt::format("G1 Z{:.3f} F100", -dice.between(2.0, 15.0) - at.z));
        line(fmt::format("G0 Z{:.3f}", over - at.z));
    }

    void with_tool(int tool, double d) {
        line(fmt::format("T{} M6\nS3000 M3", tool));
        const bool second_offset = two_offsets && dice.chance(0.5);
        const core::Vec3 at = second_offset ? second : core::Vec3(0.0);
        line(second_offset ? "G55" : "G54");
        line(fmt::format("G0 X{:.3f} Y{:.3f}", 50.0 - at.x, 50.0 - at.y));
        line(fmt::format("G43 H{} Z{:.3f}", tool, 40.0 - at.z));
        const size_t features = 1 + dice.index(3);
        for (size_t i = 0; i < features; ++i) {
            const double over = dice.between(1.0, 8.0), depth = dice.between(1.0, 9.0);
            if (tool == 2)
                hole(at, over);
            else if (dice.chance(0.5))
                slot(at, depth, over);
            else
                pocket(at, depth, over, d);
        }
        if (dice.chance(0.5)) line(fmt::format("G0 Z{:.3f}", 40.0 - at.z));
        line(dice.chance(0.5) ? "G28 G91 Z0\nG90" : "G53 G0 Z0");
        if (dice.chance(0.3)) line("G53 G0 X-50 Y-50");
    }

    void write_program() {
        line("G21 G90 G17 G40 G49 G80");
        with_tool(1, d1);
        if (two_tools) with_tool(2, d2);
        if (two_tools && dice.chance(0.4)) with_tool(1, d1);
        line("M30");
    }
};

/// What a comparison of tolerances with checks has shown.
struct ToleranceTally {
    size_t jobs = 0, clear_jobs = 0, limits = 0, open = 0, zero = 0, undecided = 0, wrong = 0;
    size_t beyond = 0, beyond_clear = 0; // just beyond a limit; and still clear there
};

/// Checks a random job at several deviations inside its tolerances, and just outside.
void compare_tolerances(unsigned seed, ToleranceTally& tally, double rounding = 0.0);

} // namespace app_test
