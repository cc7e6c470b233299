#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/dbm/cutter.h"
#include "core/dbm/solid.h"
#include "core/distance/body_distance.h"
#include "core/motion/machine.h"
#include "core/sim/finding.h"
#include "core/sim/tool_assembly.h"
#include "core/sim/verdict.h"

namespace core {

struct CutterSweep;

/// A body that holds the work, or a machine body on the table side.
struct Fixture {
    std::string name;
    ExactBody body;
    bool expendable = false; // flutes may cut it in a feed move
    Mount mount = {};        // its link and its frame in that link
    bool is_there = true;    // at the start of the program
    bool is_machine = false;
    Play play = {};         // it may stand anywhere on this segment; in the frame of its link
    double deviation = 0.0; // of `body` from the true one, mm: CAD files (core/cad/README.md)
};

/// Default tolerance of the comparison with the part, mm.
constexpr double default_part_tolerance = 0.1;

/// The design shape of the finished workpiece. Frame: that of the stock.
struct Part {
    SolidMesh solid;
    double tolerance = default_part_tolerance; // mm, either way
    double deviation = 0.0;                    // of `solid` from the true part, less than that

    /// Deviations from `solid` that count: what deviates from the true part by the tolerance may
    /// deviate from `solid` by less.
    double limit() const { return tolerance - deviation; }
};

/// Minimum clearance of a pair of bodies, from the set-up. A name is that of a body or one of:
/// flutes shank holder nose stock fixture machine.
struct AllowanceRule {
    std::array<std::string, 2> between;
    double distance = 0.0;
    double contact = 0.0;
};

/// Adding, removing or replacing a fixture: before a line of the main program runs, or at an M
/// code.
struct FixtureMove {
    std::optional<uint32_t> line;
    std::optional<int> code;  // of the M word
    size_t from = 0;          // index of the fixture that is removed
    std::optional<size_t> to; // the fixture that replaces it; empty: none does
};

/// Everything that stays the same while a program runs. mm.
struct Setup {
    double mesh_size = 0.5;
    std::optional<double> allowance; // overrides the defaults for fixtures and holder
    std::vector<AllowanceRule> allowances;
    Machine machine;
    Mount stock_mount; // link of the stock and its frame in that link
    Solid stock;       // in the stock's frame; its tolerance includes its deviation
    std::shared_ptr<const std::vector<CutterSweep>> earlier_cuts; // of earlier programs, in order
    std::optional<Part> part;                                     // the design shape
    std::vector<Fixture> fixtures;
    std::vector<FixtureMove> fixture_moves;
    std::map<ToolNumber, ToolAssembly> tools;
    std::optional<ToolNumber> tool_at_start;
    SpindleDirection spindle_at_start = SpindleDirection::stopped;
    std::array<bool, 3> start_is_assumed{}; // of X, Y, Z: nobody states their start position
    RuleSeverities rules;
    Detail detail = Detail::every_pair;
    double search_limit = 50.0;                 // clearances beyond it are not measured
    double memory_limit = default_memory_limit; // bytes, of the stock's model
    // For checks that must hold for a range of set-ups (docs/decisions/tolerances.md):
    double cut_error = 0.0;      // a cut removes for certain only what is this deep in it, mm
    std::vector<Play> body_play; // of each machine body on the tool side; empty: none
    // Bounds on a leg that turns are not sharpened further than its verdict needs, and after a pair
    // that is not clear nothing more is measured on it.
    bool needs_only_verdict = false;
};

} // namespace core
