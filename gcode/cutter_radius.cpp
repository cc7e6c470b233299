#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {
namespace {

using core::ErrorCode;

// What LinuxCNC refuses between G41 and G40, in tenths; probed with its interpreter.
constexpr int refused_g[] = {50,  51,  52,  53,  280, 281, 300, 301, 330, 331, 382, 383,
                             384, 385, 430, 431, 432, 490, 520, 530, 540, 550, 560, 570,
                             580, 590, 591, 592, 593, 610, 640, 710, 720, 730, 740, 760,
                             810, 820, 830, 840, 850, 860, 870, 880, 890, 920, 980};
constexpr int refused_m[] = {60, 480, 490, 500, 510, 520, 530, 620, 630, 640, 650, 660, 670, 680};

bool breaks_contour(const Execution& execution, const CodeWord& entry) {
    const int code = entry.code->tenths;
    if (entry.code->letter == 'M')
        return std::find(std::begin(refused_m), std::end(refused_m), code) != std::end(refused_m);
    if (code == tenths(10)) {
        const Word* kind = execution.statement.word('L');
        return kind && (kind->value == 2.0 || kind->value == 20.0);
    }
    if (entry.code->group == ModalGroup::plane) {
        constexpr int planes[] = {170, 180, 190, 171, 181, 191};
        return planes[static_cast<size_t>(execution.modal().plane)] != code;
    }
    return std::find(std::begin(refused_g), std::end(refused_g), code) != std::end(refused_g);
}

/// While the tool runs beside the contour, some codes would take it away from there.
core::Result<void> check_contour(Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes()) {
        if (!breaks_contour(execution, entry)) continue;
        if (execution.dialect.contour_breaks_are_errors)
            return core::fail(
                ErrorCode::syntax,
                fmt::format("{} is not possible between {} and G40: switch cutter "
                            "radius compensation off before",
                            written(*entry.word),
                            execution.modal().compensation == Side::left ? "G41" : "G42"),
                entry.word->span);
        execution.warn(entry.word->span,
                       fmt::format("{} stands between G41 or G42 and G40: cutter radius "
                                   "compensation is taken as switched off here",
                                   written(*entry.word)));
        execution.modal().compensation = Side::none;
        execution.modal().compensation_radius = 0.0;
        return {};
    }
    return {};
}

/// The diameter that a D word means: an entry's, the block's own under G41.1, else the tool's.
core::Result<double> diameter_of(Execution& execution, const CodeWord& entry) {
    const Word* word = execution.statement.word('D');
    if (entry.code->tenths % 10 == 1) {
        if (!word)
            return core::fail(
                ErrorCode::missing_value,
                fmt::format("{} needs the tool's diameter as D", written(*entry.word)),
                entry.word->span);
        return length_of(execution, *word);
    }
    int number = 0;
    if (word) {
        FEELER_TRY(number, whole_number(*word));
    }
    const ModalState& modal = execution.modal();
    if (number == 0 && modal.tool) number = value_of(*modal.tool);
    if (number == 0) return 0.0;
    // D31 for tool 1 is a habit of many shops: only the number of another tool is a mistake.
    const bool is_another = modal.tool && number != value_of(*modal.tool)
                            && execution.environment.tool_diameters.count(core::ToolNumber(number));
    if (is_another)
        execution.result.warnings.push_back(
            {Severity::warning, entry.word->span,
             fmt::format("{}: D{} is not the offset of the tool in the spindle, T{}",
                         written(*entry.word), number, value_of(*modal.tool)),
             "offset-not-tool", fmt::format("Write D{}.", value_of(*modal.tool))});
    if (const auto diameter = diameter_under(*execution.state.tables, number)) return *diameter;
    execution.warn(entry.word->span,
                   fmt::format("{}: nothing is known about the diameter D{}, taken as 0: the tool "
                               "runs on the contour itself",
                               written(*entry.word), number));
    return 0.0;
}

/// How much G51 scales the contour, which leaves the tool as it is.
core::Result<double> stretch_of_plane(const Execution& execution, const CodeWord& entry) {
    const auto& scaling = execution.modal().transforms.scaling;
    if (!scaling) return 1.0;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const double first = std::abs(scaling->factors[static_cast<int>(axes.first)]);
    if (first == std::abs(scaling->factors[static_cast<int>(axes.second)])) return first;
    return core::fail(ErrorCode::unsupported,
                      fmt::format("{}: cutter radius compensation of a contour that G51 scales "
                                  "unequally is not supported: scale both axes alike",
                                  written(*entry.word)),
                      entry.word->span);
}

} // namespace

core::Result<void> set_cutter_radius(Execution& execution) {
    ModalState& modal = execution.modal();
    const CodeWord* entry = execution.statement.of(ModalGroup::cutter_radius);
    const bool ends = entry && entry->code->tenths == tenths(40);
    if (modal.compensation != Side::none && !ends) {
        if (entry && execution.dialect.contour_breaks_are_errors)
            return core::fail(ErrorCode::syntax,
                              fmt::format("{}: cutter radius compensation is on already; switch it "
                                          "off with G40 before",
                                          written(*entry->word)),
                              entry->word->span);
        if (auto checked = check_contour(execution); !checked) return checked;
    }
    if (!entry) return {};
    if (ends) {
        modal.leaves_contour |=
            execution.state.contour.path && execution.state.contour.path->entered;
        modal.compensation = Side::none;
        modal.compensation_radius = 0.0;
        return {};
    }
    if (modal.plane != Plane::xy && modal.plane != Plane::zx)
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: cutter radius compensation works in the planes of G17 "
                                      "and G18",
                                      written(*entry->word)),
                          entry->word->span);
    if (const Word* word = execution.statement.word('L'); word && word->value != 0.0)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: the orientation of turning tools is not supported yet",
                                      written(*word)),
                          word->span);
    FEELER_TRY(const double diameter, diameter_of(execution, *entry));
    const bool left = entry->code->tenths / 10 == 41;
    modal.compensation = left ? Side::left : Side::right;
    FEELER_TRY(const double stretch, stretch_of_plane(execution, *entry));
    modal.compensation_radius = diameter / 2.0 / stretch;
    return {};
}

} // namespace gcode
