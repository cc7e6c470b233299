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

/// Something that holds the work, or a body of the machine on the work's side.
struct Fixture {
    std::string name;
    ExactBody body;
    bool expendable = false; // flutes that feed may cut it
    Mount mount = {};        // where its frame stands
    bool is_there = true;    // at the first block
    bool is_machine = false;
};

/// What may differ from the part where nothing is said, mm.
constexpr double default_part_tolerance = 0.1;

/// What is to be made. Frame: that of the stock.
struct Part {
    SolidMesh solid;
    double tolerance = default_part_tolerance; // mm, either way
};

/// What a pair of bodies must keep, as the set-up says it. A name is a body's, or one of: flutes
/// shank holder nose stock fixture machine.
struct AllowanceRule {
    std::array<std::string, 2> between;
    double distance = 0.0;
    double contact = 0.0;
};

/// When somebody moves a fixture: before a line of the main program is run, or when an M code is.
struct FixtureMove {
    std::optional<uint32_t> line;
    std::optional<int> code;  // of the M word
    size_t from = 0;          // the fixture that goes
    std::optional<size_t> to; // the one that takes its place; empty: it is taken away
};

/// Everything that does not change while a program runs. mm.
struct Setup {
    double mesh_size = 0.5;
    std::optional<double> allowance; // replaces the default against fixtures and of the holder
    std::vector<AllowanceRule> allowances;
    Machine machine;
    Mount stock_mount;                                            // where the stock's frame stands
    Solid stock;                                                  // in that frame
    std::shared_ptr<const std::vector<CutterSweep>> earlier_cuts; // of programs before, in order
    std::optional<Part> part;                                     // what is to be made
    std::vector<Fixture> fixtures;
    std::vector<FixtureMove> fixture_moves;
    std::map<ToolNumber, ToolAssembly> tools;
    std::optional<ToolNumber> tool_at_start;
    SpindleDirection spindle_at_start = SpindleDirection::stopped;
    RuleSeverities rules;
    Detail detail = Detail::every_pair;
    double search_limit = 50.0;                 // nobody asks beyond it
    double memory_limit = default_memory_limit; // bytes that the stock's model may take
};

} // namespace core
