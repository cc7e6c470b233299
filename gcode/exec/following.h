#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "gcode/language/block.h"

namespace gcode {

struct Environment;
struct Execution;
struct ModalState;
struct ToolDirection;

/// Whether the position of an axis is not 0; a rotary axis at full turns counts as at 0.
bool is_away_from_zero(size_t axis, double value);

/// What a code does to a transformation in which the linear axes follow the rotary ones.
enum class FollowingSwitch : uint8_t { on, off, perhaps };

/// Records a code that switches such a transformation of the control, which is not modelled:
/// TRAORI, M128, FUNCTION TCPM; `perhaps` for an M code that nobody has described.
void switch_following(Execution& execution, core::SourceSpan where, std::string_view code,
                      FollowingSwitch to);

/// Switches tool centre point control on or off as G43.4 does: the tip stays where it is relative
/// to the work when a rotary axis turns, and moves straight relative to it. Rotary axes turn
/// evenly.
///
/// False, and nothing changes, if the rotary axes of the machine are not described, or if the
/// length of the tool does not count along Z.
bool switch_tip_control(Execution& execution, bool on);

/// M428 or M429 of a LinuxCNC machine with described rotary axes, whose ini file is not given.
bool is_switch_of_samples(const Execution& execution, const Word& word);

/// Switches to another of the kinematics of a LinuxCNC machine, by number. The machine stays where
/// it is.
///
/// Errors: invalid_value if the environment's kinematics have no such number.
core::Result<void> switch_kinematics(Execution& execution, core::SourceSpan where,
                                     std::string_view code, double number);

/// The kinematics with which a LinuxCNC machine starts.
void begin_kinematics(ModalState& modal, const Environment& environment);

/// Records that a code moved X, Y and Z to places that are not known, with the finding `why`.
void lose_positions(Execution& execution, core::SourceSpan where, std::string why,
                    std::string cure);

/// A code in whose place LinuxCNC runs a subprogram that is not followed: where the machine is
/// after it, and in which kinematics, is not known.
void lose_remapped(Execution& execution, const Word& word);

/// Whether a rotary axis is away from 0, or its position is unknown.
bool is_work_turned(const ModalState& modal);

/// Notes that a block programs the direction of the tool on a machine without described axes.
void point_undescribed(ModalState& modal, const ToolDirection& tool);

/// Marks the motions of a block that the machine may make differently: while the linear axes may
/// follow rotary axes that are away from 0, and afterwards until X, Y and Z are programmed again.
/// The first such block gets a finding. Call after a block was executed, with the modes before it.
///
/// With all rotary axes at 0 the tool is along Z and the work is level, so such a transformation
/// changes nothing and the motions are certain.
void mark_uncertain_motions(Execution& execution, const ModalState& before);

/// Marks the motions of a block whose rotary axis turns another way than from its position straight
/// to the programmed one: the end is the same, the way there is not checked. The first such block
/// gets a finding, which names `code`.
void check_turn(Execution& execution, const ModalState& before, size_t axis, Addressing way,
                std::string_view code);

/// Whether the next motion is uncertain even if it moves no rotary axis.
bool is_uncertain(const ModalState& modal);

} // namespace gcode
