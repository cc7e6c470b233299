#pragma once

#include <string>
#include <vector>

#include "app/setup/inference/program_survey.h"
#include "gcode/text/source.h"

namespace gcode {
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

/// The work offset whose coordinates hold most of what a program feeds; empty where it feeds
/// nothing.
std::optional<size_t> main_place(const ProgramSurvey& seen);

/// Moves the work offsets of a bare set-up apart that a program uses beside its main one, as parts
/// that are clamped side by side, unless the program writes them itself.
///
/// Result: what is assumed, empty where nothing was moved.
std::vector<std::string> move_apart(gcode::Environment& environment, const ProgramSurvey& seen);

} // namespace app
