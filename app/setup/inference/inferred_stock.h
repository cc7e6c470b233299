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

/// A rapid straight down to where no feed has cut before: nothing can have stood there.
struct UncutPlunge {
    core::Vec3 tip = core::Vec3(0.0); // at its end, machine frame
    double radius = 0.0;              // of the tool
    uint32_t line = 0;
};

/// Those that end inside a box, in the order in which they are run. What is cut is kept in a grid
/// of heights over the box, so a plunge close beside a cut may be missed.
std::vector<UncutPlunge> uncut_plunges(const gcode::Program& program,
                                       const gcode::Environment& environment,
                                       const SurveyTools& tools, const core::Aabb& box);

/// The raw material that a program was probably written for, machine frame, and why.
struct GuessedStock {
    core::Aabb box;
    std::string why; // one sentence
};

/// What the tools reach on cutting moves, with a margin around; a small cube where nothing is cut.
///
/// Where the program goes down beside its cuts by rapid, the material is taken to end: `plunges`
/// are those that would end in the box. A side goes back by a fifth at most, and only the one that
/// has to go back least; a plunge that is too far inside stays in the material. A top above zero
/// goes down to where a plunge ends.
/// The words count from `frame`, where the stock's frame stands.
GuessedStock guessed_stock(const ProgramSurvey& seen, const core::Vec3& frame, double margin);
GuessedStock guessed_stock(const ProgramSurvey& seen, const core::Vec3& frame, double margin,
                           const std::vector<UncutPlunge>& plunges);

/// "X 0.000 to 10.000, Y ...".
std::string box_text(const core::Aabb& box);

/// A box out of the way of all motions, for programs of which nothing is known that they cut.
core::Aabb stock_out_of_the_way();

/// The raw material that a program states, in the coordinates of its zero, mm.
struct StatedStock {
    core::Aabb box;
    std::string source; // "BLK FORM in line 3", as it ends a sentence
};

/// What Klartext's BLK FORM 0.1 and 0.2, Siemens' WORKPIECE with a box or the header of Vectric's
/// programs say; empty without them, and where they describe no body. The last one counts.
///
/// `reach` is what the program cuts, in its coordinates: it tells where the zero lies that a header
/// with a size alone leaves open, at a corner or in the middle.
std::optional<StatedStock> stated_stock(const gcode::Program& program, gcode::LengthUnit unit,
                                        const std::optional<core::Aabb>& reach = {});

} // namespace app
