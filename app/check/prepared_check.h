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

/// A program and its set-up, read, completed and put in place, before the first block. The program
/// must stay where it is while it is run.
struct PreparedCheck {
    PreparedCheck();
    PreparedCheck(PreparedCheck&&) noexcept;
    PreparedCheck& operator=(PreparedCheck&&) noexcept;
    ~PreparedCheck();

    std::unique_ptr<const gcode::Program> program;
    std::shared_ptr<gcode::ProgramLibrary> library; // of the subprograms, for all who run it
    SetupFile file;                                 // its setup is in `run`
    CheckRun run;                                   // without blocks
    std::unique_ptr<core::SimulatorState> machine;  // before the first block
    bool stock_is_stated = true; // false: it was made from the program's own cuts
};

/// The same without the machine and the model of the stock, which take the longest: place_check
/// adds them.
///
/// Errors: as run_check.
core::Result<PreparedCheck> read_check(const CheckJob& job);

/// Errors: as run_check.
core::Result<void> place_check(const CheckJob& job, PreparedCheck& check);

/// Both.
///
/// Errors: as run_check.
core::Result<PreparedCheck> prepare_check(const CheckJob& job);

/// What the times of a run take for granted on this machine, for its assumptions.
std::vector<std::string> timing_notes(const core::Machine& machine);

} // namespace app
