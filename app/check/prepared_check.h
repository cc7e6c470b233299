#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/check/check_run.h"
#include "app/setup/setup_file.h"

namespace core {
struct Machine;
struct SimulatorState;
} // namespace core
namespace gcode {
struct Program;
class ProgramLibrary;
} // namespace gcode

namespace app {

struct CheckJob;
struct ToolMismatch;

/// A program and its complete set-up before the first block.
struct PreparedCheck {
    PreparedCheck();
    PreparedCheck(PreparedCheck&&) noexcept;
    PreparedCheck& operator=(PreparedCheck&&) noexcept;
    ~PreparedCheck();

    /// Whether the first unit that the program states, or else the one at its start, is the inch.
    bool is_in_inches() const;

    std::unique_ptr<const gcode::Program> program;
    std::shared_ptr<gcode::ProgramLibrary> library; // the subprograms
    SetupFile file;                                 // its setup has been moved to `run`
    CheckRun run;                                   // without blocks
    std::unique_ptr<core::SimulatorState> machine;  // before the first block
    bool stock_is_stated = true;                    // false: inferred from the program's cuts
    std::vector<ToolMismatch> tool_mismatches;      // of the tools that the set-up states
};

/// Reads program and set-up and infers missing values. place_check then adds the simulator with the
/// model of the stock, which takes longest.
///
/// Errors: as run_check.
core::Result<PreparedCheck> read_check(const CheckJob& job);

/// Builds the model of the stock and the simulator's first state.
///
/// Errors: as run_check.
core::Result<void> place_check(const CheckJob& job, PreparedCheck& check);

/// read_check and place_check.
///
/// Errors: as run_check.
core::Result<PreparedCheck> prepare_check(const CheckJob& job);

/// The assumptions about times on this machine.
std::vector<std::string> timing_notes(const core::Machine& machine);

} // namespace app
