#pragma once

#include <string>
#include <vector>

#include "app/session/program_survey.h"
#include "app/session/uncut_plunge.h"

namespace app {

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

} // namespace app
