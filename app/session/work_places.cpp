#include "app/session/work_places.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace app {
namespace {

constexpr double between = 500.0; // mm of X from one part to the next, holders and rapids included

std::string name_of_place(size_t offset) {
    if (offset < 6) return fmt::format("G{}", 54 + offset);
    if (offset < gcode::plain_offset_count) return fmt::format("G59.{}", offset - 5);
    return fmt::format("G54.1 P{}", offset - gcode::plain_offset_count + 1);
}

} // namespace

std::optional<size_t> main_place(const ProgramSurvey& seen) {
    std::optional<size_t> main;
    for (const auto& [offset, place] : seen.places)
        if (!main || place.way > seen.places.at(*main).way) main = offset;
    return main;
}

std::vector<std::string> move_apart(gcode::Environment& environment, const ProgramSurvey& seen) {
    const auto main = main_place(seen);
    if (!main || seen.places.size() < 2 || seen.sets_offsets) return {};
    std::vector<std::string> others;
    double edge = seen.places.at(*main).reach.max.x;
    for (const auto& [offset, place] : seen.places) {
        if (offset == *main) continue;
        others.push_back(name_of_place(offset));
        if (offset >= environment.work_offsets.size()) continue; // at machine zero, high above
        const double shift = edge + between - place.reach.min.x;
        environment.work_offsets[offset][0] += shift;
        edge = place.reach.max.x + shift;
    }
    return {fmt::format("the program works at {} and {}: each is taken as a part of its own, apart "
                        "from the others. The stock stands at {}, where most is cut; at {} nothing "
                        "is there, and what is done there is not judged: to check it, give the "
                        "offsets and a stock in a set-up",
                        name_of_place(*main), fmt::join(others, ", "), name_of_place(*main),
                        fmt::join(others, ", "))};
}

} // namespace app
