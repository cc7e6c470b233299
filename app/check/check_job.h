#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/setup/program_settings.h"
#include "core/base/result.h"
#include "core/sim/finding.h"
#include "core/sim/verdict.h"

namespace app {

struct CheckProgress;
struct CheckRun;

/// The engine that measures clearances: the distance core, or the functional model of the
/// coprocessor.
enum class Engine : uint8_t { exact, coprocessor };

/// "exact" or "coprocessor".
const char* name_of(Engine engine);

/// A check as requested by the user.
struct CheckJob {
    std::string program;
    std::string setup;               // empty: inferred from the program
    std::optional<double> allowance; // replaces that of the set-up
    std::optional<double> mesh_size;
    std::optional<double> memory_limit = {}; // bytes; replaces that of the set-up
    core::Detail detail = core::Detail::deciding_pair;
    bool needs_surface = false; // compute the surface of the remaining stock even without a part
    // Called with the approximate memory of the check in bytes; false: do not start.
    std::function<bool(double)> before_model = {};
    std::function<bool(const CheckProgress&)> after_block = {}; // false: stop here
    // Polled while the program is surveyed, before its first block; true: stop.
    std::function<bool()> is_stopped = {};
    std::string start_line = {}; // "120" or "N210"; empty: from the beginning
    ProgramSettings settings;    // replace those under [program] of the set-up
    Engine engine = Engine::exact;
    unsigned threads = 1; // to use; the result does not depend on it
    // The text of the set-up, in place of that of its file: while it is edited, the file may be
    // older or may not exist. Relative paths are relative to the folder of setup_path().
    std::optional<std::string> setup_text = {};
    core::RuleSeverities rules = {}; // replace those of the set-up, rule by rule
    bool setup_was_found = false;    // it was not named, but is next to the program
};

/// The path of the set-up; for a set-up without a file, the one next to the program, under which it
/// would be saved.
std::string setup_path(const CheckJob& job);

/// Uses the set-up next to the program if the job names none.
void find_setup_next_to(CheckJob& job);

/// Checks a program against its set-up, or against one inferred from the program if `setup` is
/// empty.
///
/// Errors: files that cannot be read or are invalid. An error in the program is not one of them: it
///         ends the run, and the result holds the blocks before it.
core::Result<CheckRun> run_check(const CheckJob& job);

} // namespace app
