#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/motion/event.h"
#include "gcode/exec/interpreter.h"

namespace core {
struct Machine;
struct Setup;
} // namespace core
namespace gcode {
struct Environment;
}

namespace app {

struct PreparedCheck;

/// A block of a recorded program.
struct RecordedBlock {
    core::BlockIndex block{};
    uint32_t line = 0;
    std::string file; // of a subprogram; empty for the main program
    bool is_cycle = false, goes_home = false;
    core::PathCertainty path = core::PathCertainty::known;
};

/// The readings of open premises that a run follows, by their premises. The usual reading counts
/// for all others.
using Choices = std::map<gcode::PremiseId, size_t>;

/// Everything that a program makes the machine do, in order.
struct RecordedMotions {
    Choices choices;                   // with which it was recorded
    std::vector<RecordedBlock> blocks; // with events
    std::vector<core::Event> events;
    std::vector<uint32_t> block_of;      // index in `blocks`, of each event
    std::vector<gcode::OpenPremise> met; // open premises, in order
    std::vector<double> system_reads;    // values of system variables that the program read
    std::optional<core::Error> alarm;    // of the control, which ended the program
};

/// The first block that moves on a path that is not known; null if there is none.
const RecordedBlock* uncertain_block(const RecordedMotions& motions);

/// Runs the control alone.
///
/// Errors: more than five million events; more reads of system variables.
core::Result<RecordedMotions> record_motions(const PreparedCheck& check,
                                             const gcode::Environment& environment,
                                             const Choices& choices = {});

/// The recordings of all readings of the open premises, the assumed one first.
///
/// Errors: those of record_motions; more than 16 readings.
core::Result<std::vector<RecordedMotions>> record_readings(const PreparedCheck& check);

/// The numbers of the entries with which the control compensates the length of a tool.
std::set<core::OffsetNumber> length_numbers(const RecordedMotions& motions,
                                            std::optional<core::ToolNumber> at_start,
                                            core::ToolNumber tool);

/// By how much a deviation of 1 mm displaces the ends of each motion. Kind 0 is not displaced.
struct Shifts {
    std::vector<core::AxisValues> kinds = {core::AxisValues{}};
    struct Ends {
        uint16_t from = 0, to = 0;
    };
    std::vector<Ends> of; // of each event; for other events than motions, both are where it happens

    bool none() const { return kinds.size() == 1; }
};

/// No event is displaced.
Shifts no_shifts(const RecordedMotions& motions);

/// Whether two recordings make the machine do the same.
bool same_motions(const RecordedMotions& a, const RecordedMotions& b);

/// Compares a recording with that of the same program under a deviation of `by` mm. Empty if they
/// differ by more than displacements along linear axes: the program then takes another way, or
/// moves in another manner. Also empty if a path of the other one is not known, or if the program
/// reads a system variable that deviates.
std::optional<Shifts> shifts_between(const RecordedMotions& nominal, const RecordedMotions& other,
                                     double by);

/// Whether two comparisons agree.
bool same_shifts(const Shifts& a, const Shifts& b);

/// Adds a displacement along Z, per mm, to the motions of one tool.
Shifts with_tool_shift(const Shifts& shifts, const RecordedMotions& motions,
                       std::optional<core::ToolNumber> at_start, core::ToolNumber tool, double z);

} // namespace app
