#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/check/input_file.h"
#include "app/check/stock_file.h"
#include "app/setup/setup_edits.h"
#include "core/dbm/stock_mesh.h"
#include "core/sim/part_comparison.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "gcode/exec/interpreter.h"

namespace app {

/// One block as executed, and what it did.
struct CheckedBlock {
    core::BlockIndex block{};
    uint32_t line = 0;
    std::string text;
    std::string file;            // of a subprogram's file; empty for the main program
    std::vector<uint32_t> calls; // lines that called it, the outermost first
    core::BlockResult result;
};

/// Seconds of wall time that the parts of a check took.
struct CheckTimes {
    double read = 0.0;  // program and set-up
    double model = 0.0; // scan lines of the stock
    double check = 0.0; // interpreting, cutting, measuring
};

/// Who says how near bodies come: the distance core, or a coprocessor of which the functional model
/// is asked.
enum class Engine : uint8_t { exact, coprocessor };

/// "exact" or "coprocessor".
const char* name_of(Engine engine);

/// A program that was run against a set-up, to its end or to its first error.
struct CheckRun {
    std::string program_file;
    std::string sha256;
    std::vector<InputFile> inputs; // all that was read, and looked for in vain
    gcode::DialectId dialect{};
    Engine engine = Engine::exact;
    core::Setup setup;
    std::vector<std::string> assumptions;
    std::vector<CheckedBlock> blocks;
    std::vector<core::Finding> findings; // in the order of the blocks
    std::vector<core::Finding> taken_in; // those that another finding tells of
    core::Verdict verdict = core::Verdict::clear;
    std::optional<core::Error> stopped; // why the program could not be run to its end
    core::Statistics statistics;
    size_t points = 0;       // of the stock's model at the end
    size_t lines = 0;        // scan lines
    double cycle_time = 0.0; // of the program, seconds
    double removed = 0.0;    // mm3
    CheckTimes times;
    double memory = 0.0;                 // bytes that the model of the stock was expected to take
    std::optional<core::CutModel> stock; // what is left of it
    std::optional<core::StockMesh> surface; // of it, if it was asked for
    std::optional<SavedStock> saved_stock;
    std::optional<core::PartComparison> comparison; // if the set-up has a part

    bool has_errors() const;
};

/// What is known to be kept in a block by all pairs, where none decides; 0 if nothing is known.
double least_clearance(const core::Setup& setup, const core::BlockResult& result);

/// The block whose deciding pair has the least margin; null if no pair decides any block.
const CheckedBlock* nearest_block(const CheckRun& run);

/// How far a check has come.
struct CheckProgress {
    size_t blocks = 0;
    double share = 0.0; // of the program's lines, 0..1; a program with loops goes back and forth
    size_t findings = 0;
};

/// What a user asks to be checked.
struct CheckJob {
    std::string program;
    std::string setup;               // empty: inferred from the program
    std::optional<double> allowance; // replaces the set-up's
    std::optional<double> mesh_size;
    std::optional<double> memory_limit = {}; // bytes; replaces the set-up's
    core::Detail detail = core::Detail::deciding_pair;
    bool needs_surface = false; // that of the stock is wanted, also without a part
    // Told the bytes that the check will take, about; false: do not begin.
    std::function<bool(double)> before_model = {};
    std::function<bool(const CheckProgress&)> after_block = {}; // false: stop here
    // Asked while the program is looked over, before its first block; true: give up.
    std::function<bool()> is_stopped = {};
    std::string start_line = {}; // "120" or "N210"; empty: from the beginning
    ProgramSettings settings;    // replace what the set-up says under [program]
    Engine engine = Engine::exact;
    SetupEdits edits = {};           // replace what the set-up says, or what would be inferred
    core::RuleSeverities rules = {}; // replace those of the set-up, rule by rule
    bool setup_was_found = false;    // nobody named it: it stands beside the program
};

/// Names the set-up that stands beside the program, if none was named.
void look_beside(CheckJob& job);

/// Runs a program against its set-up, or against what the program itself tells when `setup` is
/// empty.
///
/// Errors: files that cannot be read or make no sense. An error inside the program ends the run
///         instead: everything before it is in the result.
core::Result<CheckRun> run_check(const CheckJob& job);

} // namespace app
