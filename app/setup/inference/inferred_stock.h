#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/setup/inference/program_survey.h"
#include "core/base/vec.h"

namespace gcode {
enum class LengthUnit : uint8_t;
struct Environment;
struct Program;
} // namespace gcode

namespace app {

/// A rapid straight down to a point where no feed has cut before: there can be no material there.
struct UncutPlunge {
    core::Vec3 tip = core::Vec3(0.0); // end point, machine frame
    double radius = 0.0;              // of the tool
    uint32_t line = 0;
};

/// The uncut plunges that end inside a box, in program order. Cuts are recorded in a height grid
/// over the box, so a plunge very close to a cut may be missed.
std::vector<UncutPlunge> uncut_plunges(const gcode::Program& program,
                                       const gcode::Environment& environment,
                                       const SurveyTools& tools, const core::Aabb& box);

/// The raw stock that a program was probably written for, machine frame, and the reasons.
struct InferredStock {
    core::Aabb box;
    std::string why;      // one sentence, with lengths in mm
    std::string why_inch; // the same in inches
};

/// The box that the tools reach on cutting moves, plus a margin; a small cube if nothing is cut.
///
/// A plunge by rapid shows where the material ends; `plunges` are those that would end in the box.
/// Each moves only one side inwards, the one that moves least, and in each axis the box shrinks by
/// a fifth at most; a plunge too far inside stays in the material. A top above zero is lowered to
/// the end of a plunge. Coordinates in the text are relative to `frame`, the frame of the stock.
InferredStock guessed_stock(const ProgramSurvey& seen, const core::Vec3& frame, double margin);
InferredStock guessed_stock(const ProgramSurvey& seen, const core::Vec3& frame, double margin,
                            const std::vector<UncutPlunge>& plunges);

/// "X 0.000 to 10.000, Y ..." in a unit.
std::string box_text(const core::Aabb& box, gcode::LengthUnit unit);

/// A box away from all motions, for programs that are not known to cut.
core::Aabb unreachable_box();

/// The raw stock that a program states, in program coordinates, mm.
struct DeclaredStock {
    core::Aabb box;
    std::string source; // "BLK FORM in line 3", for the end of a sentence
};

/// The stock stated by Klartext's BLK FORM 0.1 and 0.2, Siemens' WORKPIECE with a box, or the
/// header of Vectric's programs; empty if there is none or it is not a body. The last one counts.
///
/// `reach`: what the program cuts, in program coordinates. If a header gives only a size, it shows
/// whether program zero is at a corner or in the middle.
std::optional<DeclaredStock> declared_stock(const gcode::Program& program, gcode::LengthUnit unit,
                                            const std::optional<core::Aabb>& reach = {});

} // namespace app
