#pragma once

#include <vector>

#include "app/session/program_survey.h"

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

} // namespace app
