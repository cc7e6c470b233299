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
#include "core/motion/path.h"
#include "gcode/exec/interpreter.h"
#include "gcode/lower/lowering.h"

namespace app {

/// What is said about a line for Grbl.
struct LineVerdict {
    LiveAnswer answer;               // whether it may be sent; if not, why
    int error = 9;                   // if not: Grbl's number for the sender
    bool moves = false;              // it has a motion
    bool fills_planner = false;      // it gives the planner at least one block
    bool is_plain = false;           // Grbl has no reason to refuse it
    bool stops_at_contact = false;   // a probing motion
    bool changes_offset = false;     // of the work or the tool
    bool asks_anew = false;          // what is known of the control does not hold behind it
    bool asks_first = false;         // it may be sent if the control stands where it is expected
    std::optional<core::Vec3> end{}; // where the machine then stands, if that is known
};

/// What the operator says while nothing moves; takes effect with synchronise.
struct OperatorWord {
    enum class Kind : uint8_t { sets_up, zero_is_set, new_workpiece } kind = Kind::sets_up;
    std::optional<int> tool{}; // that is in the spindle now; with `sets_up`
};

/// Checks the lines of a sender one by one, as Grbl would run them, against fixtures, machine
/// bodies and the stock as it is cut.
///
/// Grbl's coordinates are those of the set-up's machine. Where the set-up states no work offsets,
/// its bodies stand at the zero that the operator has confirmed. Until then, and while a tool is
/// touched off, nobody knows where they are: jogs, probing and motions straight up may then be made
/// without a check, and no others.
class LineCheck {
public:
    struct Options {
        std::optional<int> tool;  // in the spindle; empty: as the set-up states, or its only one
        double tolerance = 0.01;  // how far offsets of the control may differ from the set-up, mm
        bool zero_is_set = false; // without a word of the operator
    };

    /// Errors: as read_setup, and why_incomplete.
    static core::Result<LineCheck> open(const std::string& setup, const Options& options);

    /// Takes over what the control says while it stands still at `position` (machine coordinates,
    /// mm). Lines up to `made_through` were made, and those after it were not, or not to their end:
    /// what they cut stays in the stock. The model of the stock is built when the zero is known; if
    /// that is not possible, the objection says why.
    void synchronise(const GrblFacts& facts, const core::Vec3& position, uint64_t made_through,
                     const std::optional<OperatorWord>& word = {});

    /// Checks a line that Grbl has read (as_grbl_reads): G-code, or $J= with `is_jog`. Those that
    /// may be sent are taken to be run after the ones before, in the order of their numbers.
    ///
    /// The first motions after synchronise may also be such that lose no clearance. A jog may have
    /// been cancelled at any place, also by a button of the machine, so the next one is checked
    /// from wherever it may begin.
    LineVerdict judge(uint64_t number, const std::string& text, bool is_jog);

    /// Where the machine stands behind all lines that may be sent, machine coordinates, mm; empty
    /// if that is not known.
    std::optional<core::Vec3> place_ahead() const;

    /// Follows the cuts of lines up to this number, which have been made; at most `most` of them.
    /// Whether some are left.
    bool follow(uint64_t made_through, size_t most);

    /// Why the operator's word cannot be true; empty if it can.
    std::string why_not(const OperatorWord& word) const;

    /// What the set-up does not state.
    const std::vector<std::string>& assumptions() const { return file_->assumptions; }
    /// Why no motion may be made now; empty if there is no reason.
    std::string objection() const;
    /// Whether the place of the bodies is known.
    bool is_set_up() const { return is_set_up_; }

private:
    struct Permitted {
        uint64_t number = 0;
        std::vector<core::Event> events;
    };

    LineCheck() = default;
    core::Result<void> take_zero(const GrblFacts& facts, bool is_new_workpiece);
    void look_at_setup();
    core::Result<void> build(const GrblFacts& facts);
    bool use_shift(double z);
    void take_modes(const GrblFacts& facts, const core::Vec3& position);
    std::string objection(const gcode::Offsets& offsets,
                          std::optional<core::ToolNumber> called) const;
    LineVerdict judge_unchecked(LineVerdict verdict, const std::vector<core::Event>& events,
                                bool is_jog) const;
    LineVerdict judge_motions(LineVerdict verdict, std::vector<core::Event>& events);
    void note_failure(const core::Result<void>& done);
    std::string tool_note() const;
    LineVerdict judge_jog(LineVerdict verdict, std::vector<core::Event>& events);
    void rewind();
    size_t cuts() const;

    std::string path_, text_;  // of the set-up, as it was read
    bool has_changed_ = false; // since then
    double tolerance_ = 0.01;
    bool takes_offsets_ = false; // the set-up states none
    std::optional<SetupFile> file_;
    std::optional<MotionJudge> judge_; // once the place of the bodies was known
    gcode::Environment environment_;   // of the control
    gcode::InterpreterState control_;
    gcode::Lowering lowering_;
    core::SpindleChange spindle_;                   // when it was asked last
    std::optional<core::SimulatorState> ahead_;     // behind all lines that may be sent
    std::optional<core::SimulatorState> made_;      // behind those that have been made
    std::deque<Permitted> waiting_;                 // what is in `ahead_` and not in `made_`
    std::optional<core::ToolNumber> tool_, called_; // in the spindle; by T
    std::optional<core::AxisRange> jogged_;         // where the machine may be since jogs began, mm
    core::Vec3 step_ = core::Vec3(0.0);             // of the axes, mm; 0: not known
    double arc_error_ = 0.0;                        // how far Grbl's chords are from an arc, mm
    // mm: Z of the control minus that of the bodies, since a tool was changed or the zero was
    // corrected; at the last tool change.
    double shift_ = 0.0, shift_of_tool_ = 0.0;
    bool zero_is_set_ = false;                          // before anybody was asked
    bool is_set_up_ = false, tool_was_changed_ = false; // since the zero was set
    bool has_cut_ = false, may_retreat_ = false, knows_control_ = false;
    bool programs_spindle_ = false; // since the reset, M3 to M5 switch it
    std::string problem_;           // why nothing may move: found when the control was asked
};

} // namespace app
