#include "app/setup/control/offset_differences.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "app/setup/control/control_offsets.h"
#include "app/setup/control/used_offsets.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_length.h"
#include "app/setup/stated_setup.h"
#include "app/setup/toml_edit.h"
#include "core/base/units.h"
#include "gcode/language/canonical.h"

namespace app {
namespace {

constexpr double last_digit = 0.001, last_digit_inch = 0.0001; // mm or degrees; inches

/// A value as the control uses it.
struct EffectiveValue {
    double value = 0.0;
    const ControlValue* source = nullptr;
};

/// A value with another one that the control adds to it; empty if the first is not stated.
std::optional<EffectiveValue> in_effect(const std::optional<ControlValue>& value,
                                        const std::optional<ControlValue>& added = {}) {
    if (!value) return std::nullopt;
    return EffectiveValue{value->value + (added ? added->value : 0.0), &*value};
}

OffsetState state_of(const std::optional<double>& setup, const std::optional<double>& control,
                     bool in_inches) {
    if (!setup) return OffsetState::not_in_setup;
    if (!control) return OffsetState::not_on_control;
    const double digit = in_inches ? last_digit_inch * core::mm_per_inch : last_digit;
    constexpr double rounding = 1e-9;
    // Written so that NaN differs.
    return std::abs(*control - *setup) <= 0.5 * digit + rounding ? OffsetState::equal
                                                                 : OffsetState::differs;
}

class Comparison {
public:
    Comparison(const SetupFile& setup, const ControlOffsets& control, const UsedOffsets& used)
        : setup_(setup), control_(control), used_(used) {}

    OffsetComparison result() &&;

private:
    void compare_work_offsets();
    void compare_work_offset(size_t index);
    void compare_shift();
    void compare_lengths();
    void compare_diameters();
    std::optional<double> length_in_setup(core::OffsetNumber number) const;
    std::optional<double> diameter_in_setup(core::OffsetNumber number) const;
    bool guesses_length(core::ToolNumber number) const;
    const ControlToolOffset* tool(core::OffsetNumber number) const;
    ComparedOffset& add(std::string name, bool is_angle, std::optional<double> setup,
                        const std::optional<EffectiveValue>& control);

    const SetupFile& setup_;
    const ControlOffsets& control_;
    const UsedOffsets& used_;
    OffsetComparison found_;
};

ComparedOffset& Comparison::add(std::string name, bool is_angle, std::optional<double> setup,
                                const std::optional<EffectiveValue>& control) {
    ComparedOffset row{.name = std::move(name), .is_angle = is_angle, .setup = setup};
    if (control) {
        row.control = control->value;
        row.file = control->source->file;
        row.line = control->source->line;
    }
    row.state = state_of(row.setup, row.control, control && control->source->in_inches);
    return found_.values.emplace_back(std::move(row));
}

void Comparison::compare_work_offset(size_t index) {
    const auto found = control_.work.find(index);
    const ControlOrigin origin = found == control_.work.end() ? ControlOrigin{} : found->second;
    const gcode::AxisValues stated = setup_.environment.work_offset(index);
    const std::string name = gcode::name_of_offset(index);
    const bool is_stated = states_work_offset(setup_, index);
    for (size_t axis = 0; axis < core::axis_count; ++axis) {
        const auto control = in_effect(origin.axes[axis], control_.external.axes[axis]);
        const bool matters = axis < 3 || stated[axis] != 0.0 || (control && control->value != 0.0);
        if (!matters || (!control && !is_stated)) continue;
        ComparedOffset& row =
            add(fmt::format("{} {}", name, core::axis_letters[axis]), gcode::is_rotary(axis),
                is_stated ? std::optional(stated[axis]) : std::nullopt, control);
        row.work_offset = name;
        row.axis = axis;
    }
    if (origin.rotation_deg && origin.rotation_deg->value != 0.0)
        add(name + " rotation", true, 0.0, in_effect(origin.rotation_deg));
    if (found == control_.work.end() && !is_stated)
        found_.notes.push_back(fmt::format("the program uses {}, which neither the set-up nor a "
                                           "file of the control states",
                                           name));
}

void Comparison::compare_work_offsets() {
    std::set<size_t> indices = used_.work;
    for (const int index : setup_.offsets_set) indices.insert(static_cast<size_t>(index));
    if (control_.work.empty()) {
        if (!indices.empty()) found_.notes.emplace_back("no file states work offsets");
        return;
    }
    for (const size_t index : indices) compare_work_offset(index);
    if (const auto& axes = control_.external.axes;
        std::any_of(axes.begin(), axes.end(), [](const auto& axis) { return axis.has_value(); }))
        found_.notes.emplace_back(
            "the external offset of the control is added to each work offset");
}

/// The set-up cannot state an offset of G92 from before the program, so it is 0 there.
void Comparison::compare_shift() {
    for (size_t axis = 0; axis < core::axis_count; ++axis)
        if (const auto& value = control_.shift.axes[axis]; value && value->value != 0.0)
            add(fmt::format("G92 {}", core::axis_letters[axis]), gcode::is_rotary(axis), 0.0,
                in_effect(value));
}

const ControlToolOffset* Comparison::tool(core::OffsetNumber number) const {
    const auto found = control_.tools.find(number);
    return found == control_.tools.end() ? nullptr : &found->second;
}

/// Whether nobody has stated the length of a tool. A library with its holder and stick-out does.
bool Comparison::guesses_length(core::ToolNumber number) const {
    if (setup_.environment.guessed_lengths.contains(number)) return true;
    if (!setup_.inferred_tools.contains(number)) return false;
    const auto found = setup_.library.find(number);
    return found == setup_.library.end() || found->second.tool.holder.empty()
           || !found->second.tool.stick_out;
}

std::optional<double> Comparison::length_in_setup(core::OffsetNumber number) const {
    const gcode::Environment& environment = setup_.environment;
    if (const auto row = environment.length_offsets.find(number);
        row != environment.length_offsets.end())
        return row->second.length + row->second.wear;
    const core::ToolNumber same{core::value_of(number)};
    const auto found = environment.tool_lengths.find(same);
    if (found == environment.tool_lengths.end() || guesses_length(same)) return std::nullopt;
    return found->second;
}

std::optional<double> Comparison::diameter_in_setup(core::OffsetNumber number) const {
    const gcode::Environment& environment = setup_.environment;
    if (const auto row = environment.length_offsets.find(number);
        row != environment.length_offsets.end() && row->second.diameter != 0.0)
        return row->second.diameter + 2.0 * row->second.radius_wear;
    const core::ToolNumber same{core::value_of(number)};
    const auto found = environment.tool_diameters.find(same);
    const bool is_guess = setup_.inferred_tools.contains(same) && !setup_.library.contains(same);
    if (found == environment.tool_diameters.end() || is_guess) return std::nullopt;
    return found->second;
}

void Comparison::compare_lengths() {
    std::set<core::OffsetNumber> numbers = used_.lengths;
    numbers.insert(setup_.lengths_set.begin(), setup_.lengths_set.end());
    const bool has_lengths = std::any_of(control_.tools.begin(), control_.tools.end(),
                                         [](const auto& entry) { return entry.second.length; });
    if (!has_lengths) {
        if (!numbers.empty()) found_.notes.emplace_back("no file states tool lengths");
        return;
    }
    for (const core::OffsetNumber number : numbers) {
        const ControlToolOffset* entry = tool(number);
        add(fmt::format("H{}", core::value_of(number)), false, length_in_setup(number),
            entry ? in_effect(entry->length, entry->wear) : std::nullopt);
    }
}

/// A file without diameters for the numbers that the program uses may be one of lengths alone.
void Comparison::compare_diameters() {
    std::set<core::OffsetNumber> numbers = used_.diameters;
    for (const core::OffsetNumber number : setup_.lengths_set)
        if (setup_.environment.length_offsets.at(number).diameter != 0.0) numbers.insert(number);
    const bool has_diameters = std::any_of(control_.tools.begin(), control_.tools.end(),
                                           [](const auto& entry) { return entry.second.diameter; });
    if (!has_diameters) {
        if (!numbers.empty()) found_.notes.emplace_back("no file states diameters of tools");
        return;
    }
    for (const core::OffsetNumber number : numbers) {
        const ControlToolOffset* entry = tool(number);
        add(fmt::format("D{}", core::value_of(number)), false, diameter_in_setup(number),
            entry ? in_effect(entry->diameter, entry->diameter_wear) : std::nullopt);
    }
}

OffsetComparison Comparison::result() && {
    found_.unit = setup_.length_unit;
    found_.notes = control_.notes;
    compare_work_offsets();
    compare_shift();
    compare_lengths();
    compare_diameters();
    return std::move(found_);
}

} // namespace

std::string_view name_of(OffsetState state) {
    constexpr std::string_view names[] = {"equal", "differs", "not in the set-up",
                                          "not on the control"};
    return names[static_cast<size_t>(state)];
}

size_t OffsetComparison::differences() const {
    return static_cast<size_t>(
        std::count_if(values.begin(), values.end(), [](const ComparedOffset& value) {
            return value.state != OffsetState::equal;
        }));
}

bool states_work_offset(const SetupFile& setup, size_t index) {
    if (setup.offsets_set.contains(static_cast<int>(index))) return true;
    return !setup.infers_frame && setup.environment.work_offset(index) != gcode::AxisValues{};
}

OffsetComparison differences(const SetupFile& setup, const ControlOffsets& control,
                             const UsedOffsets& used) {
    OffsetComparison compared = Comparison(setup, control, used).result();
    compared.stopped = used.stopped;
    compared.used = used.work;
    return compared;
}

namespace {

/// Whether a row is a value of a work offset that a set-up can take from the control.
bool is_taken(const ComparedOffset& row) {
    return !row.work_offset.empty() && row.control && std::isfinite(*row.control)
           && row.state != OffsetState::equal;
}

/// X, Y and Z of a work offset after the change: those of the control, else of the set-up.
core::Vec3 origin_after(const OffsetComparison& comparison, const std::string& name) {
    core::Vec3 origin(0.0);
    for (const ComparedOffset& row : comparison.values)
        if (row.work_offset == name && row.axis < 3)
            origin[static_cast<int>(row.axis)] =
                is_taken(row) ? *row.control : row.setup.value_or(0.0);
    return origin;
}

} // namespace

core::Result<std::string> with_work_offsets(const std::string& text,
                                            const OffsetComparison& comparison) {
    std::string changed = text;
    for (const ComparedOffset& row : comparison.values) {
        if (!is_taken(row)) continue;
        const TomlPath offset = path_of_offset(changed, row.work_offset);
        if (!toml_has(changed, offset)) {
            FEELER_TRY(changed, with_offset(changed, row.work_offset,
                                            origin_after(comparison, row.work_offset)));
            if (row.axis < 3) continue;
        }
        const std::string axis(1, core::axis_letters[row.axis]);
        FEELER_TRY(changed,
                   toml_with_value(changed, offset / axis,
                                   row.is_angle ? setup_number(*row.control)
                                                : setup_length(*row.control, comparison.unit)));
    }
    return changed;
}

} // namespace app
