#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/setup/program_settings.h"
#include "app/setup/setup_edits.h"
#include "core/base/result.h"
#include "core/sim/finding.h"
#include "core/sim/verdict.h"

namespace app {

struct CheckRun;

/// What measures clearances: the distance core, or the functional model of the coprocessor.
enum class Engine : uint8_t { exact, coprocessor };

/// "exact" or "coprocessor".
const char* name_of(Engine engine);

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
