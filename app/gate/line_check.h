#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/gate/grbl_protocol.h"
#include "app/guard/motion_judge.h"
#include "app/setup/setup_file.h"
#include "core/base/result.h"
#include "gcode/exec/interpreter.h"
#include "gcode/lower/lowering.h"

namespace app {

/// What is said about a line for Grbl.
struct LineVerdict {
    LiveAnswer answer;          // whether it may be sent; if not, why
    int error = 9;              // if not: Grbl's number for the sender
    bool moves = false;         // it has a motion
    bool fills_planner = false; // it gives the planner at least one block
    bool is_plain = true; // motions and modes alone; any other line waits until all are answered
    bool changes_offsets = false;  // perhaps
    bool stops_at_contact = false; // a probing motion: where it ends is not known
};

/// Checks the lines of a sender one by one, as Grbl would run them, against fixtures, machine
/// bodies and the stock as it is cut.
///
/// Grbl's coordinates are those of the set-up's machine. A set-up that states no work offsets takes
/// them from the control: its bodies stand relative to the program's zero.
class LineCheck {
public:
    /// `tool`: in the spindle; empty: the one that the set-up states, or its only one.
    /// `tolerance`: how far offsets of the control may differ from the set-up, mm.
    ///
    /// Errors: as read_setup, and why_incomplete.
    static core::Result<LineCheck> open(const std::string& setup, std::optional<int> tool,
                                        double tolerance);

    /// Takes over what the control says while it stands still at `position` (machine coordinates,
    /// mm). Lines up to `made_through` were made, and those after it were not, or not to their end:
    /// what they cut stays in the stock. The first call builds the model of the stock.
    ///
    /// Errors: why the stock cannot be modelled, or the set-up cannot be read any more.
    core::Result<void> synchronise(const GrblFacts& facts, const core::Vec3& position,
                                   uint64_t made_through);

    /// Checks a line that Grbl has read (as_grbl_reads): G-code, or $J= with `is_jog`. Those that
    /// may be sent are taken to be run after the ones before, in the order of their numbers.
    ///
    /// The first motions after synchronise may also be such that lose no clearance.
    LineVerdict judge(uint64_t number, const std::string& text, bool is_jog);

    /// Follows the cuts of lines up to this number, which have been made; at most `most` of them.
    /// Whether some are left.
    bool follow(uint64_t made_through, size_t most);

    /// The operator has put a tool into the spindle, and nothing moves: the work offset in Z may
    /// then change with its length.
    ///
    /// Errors: a tool that the set-up does not describe.
    core::Result<void> change_tool(int number);
    /// A new workpiece is in its place.
    void renew_stock();

    std::optional<core::ToolNumber> tool() const { return tool_; }
    /// Why no motion may be made now; empty if there is no reason.
    std::string objection() const;

private:
    struct Permitted {
        uint64_t number = 0;
        std::vector<core::Event> events;
    };

    LineCheck() = default;
    core::Result<void> place(const GrblFacts& facts, const core::Vec3& position);
    void take_modes(const GrblFacts& facts, const core::Vec3& position);
    std::string objection(const gcode::Offsets& offsets) const;
    LineVerdict judge_motions(LineVerdict verdict, std::vector<core::Event> events);
    void rewind();
    size_t cuts() const;

    std::string path_, text_; // of the set-up
    double tolerance_ = 0.01;
    bool takes_offsets_ = false; // from the control
    std::optional<SetupFile> file_;
    std::optional<MotionJudge> judge_;
    gcode::Environment environment_; // of the control
    gcode::InterpreterState control_;
    gcode::Lowering lowering_;
    std::optional<core::SimulatorState> ahead_;     // behind all lines that may be sent
    std::optional<core::SimulatorState> made_;      // behind those that have been made
    std::deque<Permitted> waiting_;                 // what is in `ahead_` and not in `made_`
    std::optional<core::ToolNumber> tool_, called_; // in the spindle; by T
    core::Vec3 step_ = core::Vec3(0.0);             // of the axes, mm; 0: not known
    double shift_ = 0.0; // mm: Z of the control minus that of the set-up, since a tool change
    std::optional<size_t> cuts_before_tool_; // at the last tool change
    bool has_cut_ = false, may_retreat_ = false;
    std::string problem_; // why nothing may move: found when the control was asked
};

} // namespace app
