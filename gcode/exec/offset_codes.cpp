#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/fanuc_parameters.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// The work offset of a P word: 1 is G54, 0 the active one.
core::Result<size_t> work_offset_index(const Execution& execution, const CodeWord& entry) {
    const Word* word = execution.statement.word('P');
    if (!word)
        return core::fail(ErrorCode::missing_value,
                          "G10 needs a P word, the number of the work offset", entry.word->span);
    const bool extended = execution.dialect.has_extended_offsets;
    if (extended && execution.statement.word('L')->value == 20.0) {
        FEELER_TRY(const int number, whole_number(*word, 1, extended_offset_count));
        return plain_offset_count + static_cast<size_t>(number - 1);
    }
    FEELER_TRY(const int number, whole_number(*word, 0, extended ? 6 : plain_offset_count));
    return number > 0 ? static_cast<size_t>(number - 1) : execution.modal().offsets.active;
}

/// Writes the axis words of G10 L2 to an origin or shift. With G91 some controls add them.
void write_values(const Execution& execution, AxisValues& values) {
    const bool adds = execution.dialect.offset_writes_follow_g91
                      && execution.modal().distance == DistanceMode::incremental;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[axis]))
            values[axis] = (adds ? values[axis] : 0.0) + axis_value(execution, axis, *word);
}

/// G10 L2: the origin and its rotation.
void write_origin(const Execution& execution, WorkOffset& offset) {
    write_values(execution, offset.origin);
    if (const Word* word = execution.statement.word('R')) offset.rotation_deg = word->value;
}

/// The axes of which a block makes the offset unknown.
using LostAxes = std::array<bool, axis_count>;

/// Whether the program gives an axis its offset at a contact that it has probed.
bool is_measured(const ModalState& modal, size_t axis) {
    return modal.has_probed && (!modal.position[axis] || modal.spread[axis] != 0.0);
}

/// Whether the offset of an axis stays because the set-up states the one that is measured.
bool stays_as_stated(const Execution& execution, size_t axis) {
    return execution.environment.measured_offsets_are_stated
           && is_measured(execution.modal(), axis);
}

/// Reports an offset that is set at a contact.
void report_measured(Execution& execution, const core::SourceSpan where, size_t axis) {
    if (!is_measured(execution.modal(), axis)) return;
    std::set<std::string>& reported = execution.state.readings.write().reported;
    if (!reported.insert(fmt::format("the offset of {}", axis_letters[axis])).second) return;
    execution.result.warnings.push_back(
        {Severity::warning, where,
         fmt::format("The offset of {} is set where the probe made contact, which only the machine "
                     "knows",
                     axis_letters[axis]),
         core::rule_id("unknown-value"),
         "If the set-up has the offset that the machine measures, state measured_offsets = \"as "
         "stated\" under [program]."});
}

/// G10 L20: the origin for which the current position has the given coordinates. Where that
/// position is not known, the origin stays and the axis is lost.
core::Result<LostAxes> write_origin_here(const Execution& execution, WorkOffset& offset) {
    const ModalState& modal = execution.modal();
    Offsets there = counted_offsets(modal.offsets);
    const Position machine = machine_from_program(there, modal.position);
    if (const Word* word = execution.statement.word('R'))
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{}: G10 L20 does not rotate an offset: use L2", written(*word)),
            word->span);
    there.work = offset;
    Position read = program_from_machine(there, machine);
    LostAxes lost{};
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word || stays_as_stated(execution, axis)) continue;
        lost[axis] = !read[axis];
        if (lost[axis]) continue;
        read[axis] = axis_value(execution, axis, *word);
    }
    // The origin moves by the difference between the machine position and where these coordinates
    // would be.
    const Position meant = machine_from_program(there, read);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (meant[axis] && machine[axis]) offset.origin[axis] += *machine[axis] - *meant[axis];
    return lost;
}

/// Checks whether this control allows R to rotate a work offset.
core::Result<void> check_turn(const Execution& execution) {
    const Word* word = execution.statement.word('R');
    if (!word || execution.dialect.work_offsets_turn) return {};
    return core::fail(
        ErrorCode::unsupported,
        fmt::format("{}: this control cannot rotate work offsets; use G68", written(*word)),
        word->span);
}

/// The effective offset: the one in the table plus Fanuc's external one.
WorkOffset in_effect(const Tables& tables, size_t index) {
    WorkOffset offset = work_offset(tables, index);
    for (size_t axis = 0; axis < axis_count; ++axis) offset.origin[axis] += tables.external[axis];
    return offset;
}

/// The work offset selected by a code: G54 to G59.3; G54.1 P, G54 P; Haas's G154 P and G110 to
/// G129.
///
/// Source: Fanuc 30i user's manual B-63944EN, 7.2.6 "Adding workpiece coordinate systems"; Haas
///         mill operator's manual 96-8000, G110 to G129 and G154.
core::Result<size_t> selected_offset(const Execution& execution, const CodeWord& entry) {
    const CodeNumber code = entry.code->number;
    const Word* word = execution.statement.word('P');
    if (code >= g_code(110) && code <= g_code(129))
        return plain_offset_count + static_cast<size_t>(whole_of(code) - 110);
    const bool is_numbered = code == g_code(54, 1) || code == g_code(154);
    if (is_numbered && !word)
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{} needs a P word, the number of the work offset", written(*entry.word)),
            entry.word->span);
    const auto wants_p = [](const CodeWord& other) { return other.code->uses('P'); };
    const std::span<const CodeWord> codes = execution.statement.codes();
    const bool is_free = std::none_of(codes.begin(), codes.end(), wants_p);
    const bool is_g54_p =
        execution.dialect.has_extended_offsets && code == g_code(54) && word && is_free;
    if (is_numbered || is_g54_p) {
        const int most = code == g_code(154) ? 99 : static_cast<int>(extended_offset_count);
        FEELER_TRY(const int number, whole_number(*word, 1, most));
        return plain_offset_count + static_cast<size_t>(number - 1);
    }
    return static_cast<size_t>(whole_of(code) - 54 + tenth_of(code));
}

core::Result<LostAxes> write_work_offset(Execution& execution, const CodeWord& entry,
                                         const Word& kind) {
    const Word* number = execution.statement.word('P');
    const bool extended = execution.dialect.has_extended_offsets;
    LostAxes lost{};
    if (extended && kind.value == 2.0 && number && number->value == 0.0) {
        if (auto done = write_external_offset(execution); !done)
            return tl::unexpected(std::move(done).error());
        return lost;
    }
    FEELER_TRY(const size_t index, work_offset_index(execution, entry));
    WorkOffset offset = work_offset(*execution.state.tables, index);
    if (kind.value == 2.0 || extended) {
        write_origin(execution, offset);
    } else {
        FEELER_TRY(lost, write_origin_here(execution, offset));
    }
    writable_work_offset(execution.state.tables.write(), index) = offset;
    return lost;
}

void use(Execution& execution, const Offsets& offsets, bool is_told = true) {
    change_offsets(execution, offsets);
    execution.emit(SetOffset{offsets, is_told});
}

/// The position of these axes gets the given coordinates, as after G92 at an unknown position.
void lose_offsets(Execution& execution, const LostAxes& lost) {
    ModalState& modal = execution.modal();
    Offsets offsets = modal.offsets;
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (!lost[axis]) continue;
        offsets.axis[axis].reset();
        report_measured(execution, execution.statement.word(axis_letters[axis])->span, axis);
    }
    if (offsets == modal.offsets) return;
    modal.suspended_axis = offsets.axis;
    use(execution, offsets, false);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[axis]); word && lost[axis])
            modal.position[axis] = axis_value(execution, axis, *word);
}

/// After G10, LinuxCNC recomputes its position ignoring G92 or G52. If the rotation of the offset
/// has changed, that position is wrong.
///
/// Source: rs274 2.9, probed.
void use_written_offset(Execution& execution, const CodeWord& entry) {
    ModalState& modal = execution.modal();
    const auto written = work_offset_index(execution, entry);
    const bool is_told = written && *written == modal.offsets.active;
    const Offsets before = modal.offsets;
    Offsets offsets = before;
    offsets.work = in_effect(*execution.state.tables, offsets.active);
    const bool turned = before.work.rotation_deg != offsets.work.rotation_deg;
    const bool shifted = before.axis[0] != 0.0 || before.axis[1] != 0.0;
    if (!execution.dialect.offset_writes_miss_axis_offset || !turned || !shifted)
        return use(execution, offsets, is_told);
    Offsets plain_before = counted_offsets(before), plain = counted_offsets(offsets);
    plain_before.axis = plain.axis = zero_position;
    modal.position =
        program_from_machine(plain, machine_from_program(plain_before, modal.position));
    modal.offsets = offsets;
    execution.emit(SetOffset{offsets, is_told});
    execution.warn(
        entry.word->span,
        "G10 rotates the work offset while G92 or G52 is on: the control loses its position, and "
        "the next move also moves axes it does not name; program G92.1 first");
}

} // namespace

void change_offsets(Execution& execution, const Offsets& offsets) {
    change_offsets(execution.modal(), offsets);
}

void use_work_offset(Execution& execution, size_t index) {
    Offsets offsets = execution.modal().offsets;
    offsets.active = index;
    offsets.work = in_effect(*execution.state.tables, index);
    if (offsets != execution.modal().offsets) use(execution, offsets);
}

core::Result<void> select_offset(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::work_offset);
    if (!entry) return {};
    Offsets offsets = execution.modal().offsets;
    FEELER_TRY(offsets.active, selected_offset(execution, *entry));
    const bool is_same = offsets.active == execution.modal().offsets.active;
    const bool stays = execution.dialect.same_offset_stays && is_same;
    if (!stays) offsets.work = in_effect(*execution.state.tables, offsets.active);
    use(execution, offsets, !is_same);
    return {};
}

core::Result<void> write_offset(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    const Word* kind = execution.statement.word('L');
    const bool is_older = !kind && execution.dialect.has_older_tool_entries;
    if (is_older && execution.statement.word('P') && execution.statement.word('R')
        && !execution.statement.has_axis_word())
        return write_single_entry(execution);
    if (!kind)
        return core::fail(ErrorCode::missing_value,
                          is_older ? "G10 needs L2 or L20 for a work offset, or P and R for a tool "
                                     "offset"
                                   : "G10 needs L2 or L20",
                          entry.word->span);
    if (kind->value == 0.0 && execution.dialect.tool_entries_by_axes) {
        execution.warn(
            kind->span,
            "G10 L0 reloads the tool table of the control, which is assumed to be unchanged",
            Severity::note);
        return {};
    }
    const bool is_tool = kind->value == 1.0 || kind->value == 10.0 || kind->value == 11.0;
    if (is_tool && execution.dialect.tool_entries_by_axes)
        return write_tool_entry(execution, static_cast<int>(kind->value));
    if (execution.dialect.has_extended_offsets) {
        const bool is_wear = kind->value == 1.0 && execution.dialect.has_older_tool_entries;
        if (is_wear || (kind->value >= 10.0 && kind->value <= 13.0)) {
            FEELER_TRY(const int table, whole_number(*kind));
            return write_fanuc_entry(execution, is_wear ? 11 : table);
        }
        if (kind->value == 3.0 || kind->value == 50.0 || kind->value == 52.0) {
            skip_data(execution, *kind);
            return {};
        }
    }
    if (kind->value != 2.0 && kind->value != 20.0)
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("{}: this form of G10 is not supported yet; L2 and L20 write work offsets",
                        written(*kind)),
            kind->span);
    if (auto checked = check_turn(execution); !checked) return checked;
    FEELER_TRY(const LostAxes lost, write_work_offset(execution, entry, *kind));
    use_written_offset(execution, entry);
    lose_offsets(execution, lost);
    return {};
}

namespace {

/// Checks that G92 or G52 names an axis.
core::Result<void> need_an_axis(const Execution& execution) {
    if (execution.statement.has_axis_word() || !execution.dialect.local_offset_is_axis_offset)
        return {};
    const Word& word = *execution.statement.of(ModalGroup::action)->word;
    return core::fail(ErrorCode::missing_value,
                      fmt::format("{} needs an axis word{}", written(word),
                                  word.value == 92.0 ? "; use G92.1 to clear all axes" : ""),
                      word.span);
}

} // namespace

core::Result<void> set_local_offset(Execution& execution) {
    if (auto checked = need_an_axis(execution); !checked) return checked;
    if (answer_to(execution.state, execution.environment, ControlQuestion::local_is_work,
                  execution.block.line)) {
        const Word& word = *execution.statement.of(ModalGroup::action)->word;
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: with setting 33 = YASNAC this is a work offset of its "
                                      "own, which is not supported: use G54 to G59",
                                      written(word)),
                          word.span);
    }
    Offsets offsets = execution.modal().offsets;
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word) continue;
        const double value = axis_value(execution, axis, *word);
        if (execution.dialect.local_offset_is_axis_offset)
            offsets.axis[axis] = value;
        else
            offsets.local[axis] = value;
    }
    if (execution.dialect.local_offset_is_axis_offset) {
        execution.modal().suspended_axis = offsets.axis;
        execution.modal().axis_offset_on = true;
    }
    use(execution, offsets);
    return {};
}

namespace {

/// G92 cancels G52 along the axes that it names: what G52 shifts is from now on part of G92.
///
/// Source: Fanuc B-63944EN, 7.2.4, local coordinate system; Haas mill operator's manual 96-8000,
///         G92.
void take_over_local_offset(const Execution& execution, Offsets& offsets) {
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (!execution.statement.word(axis_letters[axis])) continue;
        if (offsets.axis[axis]) *offsets.axis[axis] += offsets.local[axis];
        offsets.local[axis] = 0.0;
    }
}

} // namespace

core::Result<void> set_axis_offset(Execution& execution) {
    ModalState& modal = execution.modal();
    Offsets offsets = modal.offsets;
    if (offsets.has_frame)
        return core::fail(ErrorCode::invalid_value,
                          "G92 cannot be used while scaling, mirroring or rotation is on: cancel "
                          "it with G50, G50.1 or G69 first",
                          execution.statement.of(ModalGroup::action)->word->span);
    const Code& action = *execution.statement.of(ModalGroup::action)->code;
    const CodeNumber code = action.number;
    modal.axis_offset_on = code == g_code(92) || code == g_code(92, 3);
    switch (code) {
    case g_code(92, 1):
        // On Fanuc, axis words choose the axes. They are zero, and nothing moves.
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (!action.uses_axes() || !execution.statement.has_axis_word()
                || execution.statement.word(axis_letters[axis]))
                offsets.axis[axis] = modal.suspended_axis[axis] = 0.0;
        modal.axis_offset_on = offsets.axis != zero_position;
        break;
    case g_code(92, 2):
        offsets.axis = zero_position; // the offset of G92 stays stored for G92.3
        break;
    case g_code(92, 3):
        offsets.axis = modal.suspended_axis;
        break;
    default:
        if (auto checked = need_an_axis(execution); !checked) return checked;
        take_over_local_offset(execution, offsets);
        for (size_t axis = 0; axis < axis_count; ++axis) {
            const Word* word = execution.statement.word(axis_letters[axis]);
            if (!word || stays_as_stated(execution, axis)) continue;
            report_measured(execution, word->span, axis);
            const std::optional<double> position = modal.position[axis];
            const double wanted = axis_value(execution, axis, *word);
            // The machine does not move; its position gets the given coordinate. From an unknown
            // position only that coordinate is known, not the offset.
            if (position && offsets.axis[axis])
                *offsets.axis[axis] += *position - wanted;
            else
                offsets.axis[axis].reset();
        }
        modal.suspended_axis = offsets.axis;
        change_offsets(execution, offsets);
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (const Word* word = execution.statement.word(axis_letters[axis]);
                word && !stays_as_stated(execution, axis))
                modal.position[axis] = axis_value(execution, axis, *word);
        execution.emit(SetOffset{offsets, true});
        return {};
    }
    use(execution, offsets);
    return {};
}

namespace {

using core::OffsetNumber;

/// Adds with G91, replaces with G90.
void write(const Execution& execution, double value, double& position) {
    const bool adds = execution.dialect.offset_writes_follow_g91
                      && execution.modal().distance == DistanceMode::incremental;
    position = (adds ? position : 0.0) + value;
}

/// An offset that is written while it is in use takes effect at once or at the next G43 or H.
void apply_offset_in_use(Execution& execution, int index, const Word& value) {
    if (execution.modal().length_sign == 0.0
        || execution.modal().length_number != OffsetNumber(index))
        return;
    constexpr ControlQuestion question = ControlQuestion::length_is_reloaded;
    if (answer_to(execution.state, execution.environment, question, execution.block.line))
        reload_length(execution);
    const ControlSettings& control = execution.environment.control;
    const bool is_known = control.answer(question) || control.reports_premises;
    if (is_known && find_parameter(question, execution.environment.dialect)) return;
    execution.warn(value.span,
                   fmt::format("H{} is in use: the new length is assumed to take effect at the "
                               "next G43 or H, which depends on a parameter of the control",
                               index));
}

} // namespace

core::Result<void> write_fanuc_entry(Execution& execution, int kind) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    const Word* number = execution.statement.word('P');
    const Word* value = execution.statement.word('R');
    if (!number || !value)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("G10 L{} needs {}", kind,
                                      number ? "an R word, the value" : "a P word, the number"),
                          entry.word->span);
    FEELER_TRY(const int index, whole_number(*number, 1, 999));
    const bool is_length = kind <= 11;
    const auto memory = static_cast<OffsetMemory>(
        is_length ? number_for(execution.state, execution.environment,
                               ControlQuestion::offset_memory, execution.block.line)
                  : 0.0);
    const bool is_shared = memory != OffsetMemory::separate;
    const double sizes =
        !is_length || is_shared
            ? size_factor(execution.state, execution.environment, execution.block.line)
            : 1.0;
    forget_offset_as_set(execution.state, index);
    Tables& tables = execution.state.tables.write();
    const bool known = tables.lengths.count(OffsetNumber(index)) != 0;
    const double length = known ? 0.0 : length_under(tables, index).value_or(0.0);
    LengthOffset& offset = tables.lengths[OffsetNumber(index)];
    if (!known) offset.length = length;
    const double written_value = length_of(execution, *value);
    switch (kind) {
    case 10:
        write(execution, written_value, offset.length);
        if (is_shared) offset.diameter = sizes * offset.length;
        break;
    case 11:
        if (memory == OffsetMemory::one_value) {
            write(execution, written_value, offset.length);
            offset.diameter = sizes * offset.length;
            offset.wear = offset.radius_wear = 0.0;
            break;
        }
        write(execution, written_value, offset.wear);
        if (is_shared) offset.radius_wear = 0.5 * sizes * offset.wear;
        break;
    case 12:
        write(execution, sizes * written_value, offset.diameter);
        break;
    default:
        write(execution, 0.5 * sizes * written_value, offset.radius_wear);
        break;
    }
    if (is_length) apply_offset_in_use(execution, index, *value);
    return {};
}

core::Result<void> write_single_entry(Execution& execution) {
    const Word& number = *execution.statement.word('P');
    const Word& value = *execution.statement.word('R');
    FEELER_TRY(const int index, whole_number(number, 1, 999));
    Tables& tables = execution.state.tables.write();
    const auto known = tables.lengths.find(OffsetNumber(index));
    const LengthOffset old = known == tables.lengths.end() ? LengthOffset{} : known->second;
    const double sizes = size_factor(execution.state, execution.environment, execution.block.line);
    if (old.length != 0.0 && old.diameter != 0.0 && old.diameter != sizes * old.length)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: G10 without L writes the one value of an offset number, "
                                      "but offset {} has a length and a diameter: use L10 to L13",
                                      written(number), index),
                          number.span);
    LengthOffset entry = old;
    entry.length = length_under(tables, index).value_or(0.0);
    write(execution, length_of(execution, value), entry.length);
    entry.wear = entry.radius_wear = 0.0;
    entry.diameter = sizes * entry.length;
    tables.lengths[OffsetNumber(index)] = entry;
    execution.warn(execution.statement.of(ModalGroup::action)->word->span,
                   fmt::format("G10 without L: offset {} is taken as one value, used as a length "
                               "under H and as a {} under D (tool offset memory A)",
                               index, sizes == 2.0 ? "radius" : "diameter"),
                   Severity::note);
    apply_offset_in_use(execution, index, value);
    return {};
}

core::Result<void> write_external_offset(Execution& execution) {
    AxisValues& external = execution.state.tables.write().external;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[axis]))
            write(execution, axis_value(execution, axis, *word), external[axis]);
    return {};
}

void skip_data(Execution& execution, const Word& kind) {
    if (kind.value == 3.0) {
        execution.warn(kind.span,
                       fmt::format("G10 {}: tool life data are not modelled; the blocks up to G11 "
                                   "have no effect",
                                   written(kind)));
        return;
    }
    execution.result.warnings.push_back(
        {Severity::warning, kind.span,
         fmt::format("G10 {} changes parameters of the control up to G11; they are not changed "
                     "here, and what depends on them is not proven clear",
                     written(kind)),
         core::rule_id("undecided"),
         "Check with a set-up that states the control as these blocks leave it, without them."});
}

} // namespace gcode
