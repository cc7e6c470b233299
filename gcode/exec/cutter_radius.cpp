#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "gcode/contour/contour.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/readings.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// G codes by their values, such as 59.3.
template <size_t count>
constexpr std::array<CodeNumber, count> g_codes(const double (&values)[count]) {
    std::array<CodeNumber, count> codes{};
    for (size_t i = 0; i < count; ++i)
        codes[i] = code_of('G', static_cast<int>(10.0 * values[i] + 0.5));
    return codes;
}

// Codes that LinuxCNC refuses between G41 and G40, besides cycles; probed with its interpreter.
constexpr auto rs274_g = g_codes(
    {5,  5.1, 5.2, 5.3, 28, 28.1, 30, 30.1, 33,   33.1, 38.2, 38.3, 38.4, 38.5, 43, 43.1, 43.2, 49,
     52, 53,  54,  55,  56, 57,   58, 59,   59.1, 59.2, 59.3, 61,   64,   71,   72, 92,   98});
constexpr CodeNumber rs274_m[] = {m_code(6),  m_code(48), m_code(49), m_code(50), m_code(51),
                                  m_code(52), m_code(53), m_code(62), m_code(63), m_code(64),
                                  m_code(65), m_code(66), m_code(67), m_code(68)};

// Codes by which the tool leaves the contour on Fanuc controls, besides cycles: reference points,
// machine coordinates, offsets (B-63944EN-2, 6.6, "Notes on cutter compensation"), cycles of Haas
// that act in their block only, and G74 and G75, which are positions of the machine on Siemens
// controls.
constexpr auto fanuc_g = g_codes({27, 28, 29, 30, 52,  53, 54, 54.1, 55, 56, 57, 58,
                                  59, 92, 74, 75, 154, 12, 13, 150,  70, 71, 72});
constexpr CodeNumber fanuc_m[] = {m_code(6)};

bool is_among(std::span<const CodeNumber> codes, CodeNumber code) {
    return std::find(codes.begin(), codes.end(), code) != codes.end();
}

bool changes_plane(const Execution& execution, const CodeWord& entry) {
    constexpr CodeNumber planes[] = {g_code(17),    g_code(18),    g_code(19),
                                     g_code(17, 1), g_code(18, 1), g_code(19, 1)};
    const Contour& contour = *execution.state.contour; // the modal state already has the new plane
    const Plane plane = contour.path ? contour.plane : execution.modal().plane;
    return entry.code->group == ModalGroup::plane
           && planes[static_cast<size_t>(plane)] != entry.code->number;
}

bool breaks_contour(const Execution& execution, const CodeWord& entry) {
    const CodeNumber code = entry.code->number;
    if (code == g_code(10)) {
        const Word* kind = execution.statement.word('L');
        return kind && (kind->value == 2.0 || kind->value == 20.0);
    }
    if (entry.code->is_cycle() || changes_plane(execution, entry)) return true;
    return execution.dialect.contour_codes == ContourCodes::rs274
               ? is_among(rs274_g, code) || is_among(rs274_m, code)
               : is_among(fanuc_g, code) || is_among(fanuc_m, code);
}

/// G41.1 and G42.1, which state the diameter in D.
bool states_diameter(const CodeWord& entry) {
    return entry.code->number == g_code(41, 1) || entry.code->number == g_code(42, 1);
}

/// Reports codes that would move the tool off the contour.
core::Result<void> check_contour(Execution& execution) {
    const char* const on = execution.modal().compensation == Side::left ? "G41" : "G42";
    for (const CodeWord& entry : execution.statement.codes()) {
        const bool skips = entry.code->number == g_code(31);
        if (!skips && !breaks_contour(execution, entry)) continue;
        if (skips || execution.dialect.contour_breaks_are_errors || changes_plane(execution, entry))
            return core::fail(
                ErrorCode::syntax,
                fmt::format(
                    "{} is not allowed between {} and G40: cancel cutter radius compensation first",
                    written(*entry.word), on),
                entry.word->span);
        execution.warn(entry.word->span,
                       fmt::format("{} between {} and G40: the tool leaves the contour for this "
                                   "block and returns to it with the next move in the plane",
                                   written(*entry.word), on));
        execution.state.contour.write().pauses = true;
        return {};
    }
    return {};
}

/// The number of the offset: from the D word, else from an earlier D, else that of the tool.
core::Result<int> radius_number(Execution& execution) {
    const Word* word = execution.statement.word('D');
    ModalState& modal = execution.modal();
    int number = 0;
    if (word) {
        FEELER_TRY(number, whole_number(*word));
    }
    if (execution.dialect.radius_number_stays) {
        if (word) modal.radius_number = number;
        return modal.radius_number;
    }
    if (number == 0 && modal.tool) number = value_of(*modal.tool);
    modal.radius_number = number;
    return number;
}

/// The orientation of a turning tool: from the L word with G41.1, else from the tool table. 0 means
/// a mill.
core::Result<int> turning_orientation(Execution& execution, const CodeWord& entry) {
    const Word* word = execution.statement.word('L');
    int orientation = 0;
    if (states_diameter(entry)) {
        if (word) {
            FEELER_TRY(orientation, whole_number(*word, 0, 9));
        }
    } else {
        FEELER_TRY(const int number, radius_number(execution));
        const auto& entries = execution.state.tables->lengths;
        const auto found = entries.find(core::OffsetNumber(number));
        if (found != entries.end()) orientation = found->second.orientation;
    }
    const bool turns = orientation != 0 && orientation != 9;
    if (!turns || execution.modal().plane == Plane::zx) return orientation;
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("{}: this is a turning tool (orientation {}), which can only be "
                                  "compensated in the G18 plane",
                                  written(*entry.word), orientation),
                      word ? word->span : entry.word->span);
}

/// The scale factor of G51 in the plane. It scales the contour but not the tool.
core::Result<double> stretch_of_plane(const Execution& execution, const CodeWord& entry) {
    const auto& scaling = execution.modal().transforms.scaling;
    if (!scaling) return 1.0;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const double first = std::abs(scaling->factors[static_cast<int>(axes.first)]);
    if (first == std::abs(scaling->factors[static_cast<int>(axes.second)])) return first;
    return core::fail(ErrorCode::unsupported,
                      fmt::format("{}: cutter radius compensation is not supported where G51 "
                                  "scales the two axes differently: use the same factor for both",
                                  written(*entry.word)),
                      entry.word->span);
}

} // namespace

core::Result<double> offset_diameter(Execution& execution, const CodeWord& entry) {
    const Word* word = execution.statement.word('D');
    if (states_diameter(entry)) {
        if (!word)
            return core::fail(
                ErrorCode::missing_value,
                fmt::format("{} needs a D word, the diameter of the tool", written(*entry.word)),
                entry.word->span);
        return length_of(execution, *word);
    }
    FEELER_TRY(const int number, radius_number(execution));
    if (number == 0) {
        if (execution.dialect.radius_number_stays && !word)
            execution.warn(entry.word->span,
                           fmt::format("{}: no D word programmed yet, so the radius is 0 and the "
                                       "tool centre runs on the contour",
                                       written(*entry.word)));
        return 0.0;
    }
    // Many shops use D31 for tool 1, so only the number of another tool is reported.
    const ModalState& modal = execution.modal();
    const bool is_another = modal.tool && number != value_of(*modal.tool)
                            && execution.environment.tool_diameters.count(core::ToolNumber(number));
    if (is_another)
        execution.result.warnings.push_back(
            {Severity::warning, entry.word->span,
             fmt::format("{}: D{} is not the offset of T{}, the tool in the spindle",
                         written(*entry.word), number, value_of(*modal.tool)),
             core::rule_id("offset-not-tool"), fmt::format("Use D{}.", value_of(*modal.tool))});
    if (const auto diameter = diameter_under(*execution.state.tables, number)) return *diameter;
    execution.warn(
        entry.word->span,
        fmt::format(
            "{}: diameter D{} is unknown and assumed to be 0: the tool centre runs on the contour",
            written(*entry.word), number));
    return 0.0;
}

namespace {

/// Whether G41, G42 or G40 of this block shifts the tool at right angles to the contour before the
/// next move. Without the parameter for it they wait for that move.
bool asks_for_upright_shift(Execution& execution, bool is_on, bool ends) {
    if (execution.dialect.contour_style != ContourStyle::fanuc || is_on != ends) return false;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const Statement& statement = execution.statement;
    if (statement.word(axis_letters[axes.first]) || statement.word(axis_letters[axes.second]))
        return false;
    return answer_to(execution.state, execution.environment, ControlQuestion::entry_is_upright,
                     execution.block.line);
}

/// How the tool comes to the contour and leaves it, which depends on the parameters of the control.
void choose_entry(Execution& execution, bool is_upright) {
    if (execution.dialect.contour_style != ContourStyle::fanuc) return;
    const bool extends = answer_to(execution.state, execution.environment,
                                   ControlQuestion::entry_has_corner, execution.block.line);
    const auto stated = execution.environment.control.number(ControlQuestion::contour_look_ahead);
    const auto look_ahead = static_cast<size_t>(stated.value_or(3.0));
    const Contour& now = *execution.state.contour;
    if (now.extends_ends == extends && now.enters_upright == is_upright
        && now.look_ahead == look_ahead)
        return;
    Contour& contour = execution.state.contour.write();
    contour.look_ahead = look_ahead;
    contour.extends_ends = extends;
    contour.enters_upright = is_upright;
}

} // namespace

core::Result<void> set_cutter_radius(Execution& execution) {
    ModalState& modal = execution.modal();
    const ContourStyle style = execution.dialect.contour_style;
    if (execution.state.contour->pauses || execution.state.contour->style != style) {
        Contour& contour = execution.state.contour.write();
        contour.pauses = false;
        contour.style = style;
    }
    const CodeWord* entry = execution.statement.of(ModalGroup::cutter_radius);
    const bool ends = entry && entry->code->number == g_code(40);
    if (modal.compensation != Side::none && !ends) {
        if (entry && execution.dialect.contour_breaks_are_errors)
            return core::fail(
                ErrorCode::syntax,
                fmt::format(
                    "{}: cutter radius compensation is already on; cancel it with G40 first",
                    written(*entry->word)),
                entry->word->span);
        if (auto checked = check_contour(execution); !checked) return checked;
    }
    if (!entry) return {};
    const bool is_on = modal.compensation != Side::none;
    const bool is_upright = asks_for_upright_shift(execution, is_on, ends);
    if (ends) {
        const bool shifts =
            is_upright && execution.state.contour->path && execution.state.contour->path->entered;
        modal.leaves_contour |=
            execution.state.contour->path && execution.state.contour->path->entered;
        modal.compensation = Side::none;
        modal.compensation_radius = 0.0;
        if (!shifts) return {};
        // The programmed position stays: the tool moves onto it.
        if (modal.motion == MotionCode::rapid || !modal.feed)
            execution.traverse(modal.position);
        else
            execution.feed(modal.position, *modal.feed);
        return {};
    }
    const bool third =
        modal.plane == Plane::yz && execution.dialect.contour_codes == ContourCodes::fanuc;
    if (modal.plane != Plane::xy && modal.plane != Plane::zx && !third)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{}: cutter radius compensation works in the G17 and G18 planes only",
                        written(*entry->word)),
            entry->word->span);
    FEELER_TRY(const int orientation, turning_orientation(execution, *entry));
    FEELER_TRY(const double diameter, offset_diameter(execution, *entry));
    const bool left = whole_of(entry->code->number) == 41;
    modal.compensation = left ? Side::left : Side::right;
    FEELER_TRY(const double stretch, stretch_of_plane(execution, *entry));
    modal.compensation_radius = diameter / 2.0 / stretch;
    modal.turning_orientation = orientation;
    choose_entry(execution, is_upright);
    return {};
}

core::Result<void> ask_for_corner(Execution& execution) {
    const Word* word = execution.statement.corner;
    if (!word) return {};
    const double size = length_of(execution, *word);
    if (size < 0.0)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}: the size of a corner must not be negative", written(*word)),
            word->span);
    const auto& commands = execution.result.commands;
    const bool feeds = !commands.empty() && !execution.modal().cycle
                       && (std::holds_alternative<StraightFeed>(commands.back())
                           || std::holds_alternative<ArcFeed>(commands.back()));
    if (!feeds)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{}: a corner must be programmed in a block with G1, G2 or G3",
                        written(*word)),
            word->span);
    if (size == 0.0) return {};
    const PlaneAxes axes = axes_of(execution.modal().plane);
    if (auto checked = check_arc_in_frame(execution, axes); !checked) return checked;
    execution.state.contour.write().corners.asked =
        CornerWord{.kind = word->letter == 'r' ? CornerKind::rounding : CornerKind::chamfer,
                   .size = size,
                   .where = word->span,
                   .written = written(*word)};
    return {};
}

} // namespace gcode
