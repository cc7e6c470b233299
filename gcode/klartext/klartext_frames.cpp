#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "core/base/units.h"
#include "gcode/klartext/klartext.h"

namespace gcode {
namespace {

using Kind = Transforms::Kind;

/// Appends a transformation to the active ones, or removes it.
void keep_order(Transforms& transforms, Kind kind, bool is_on) {
    auto& order = transforms.order;
    const auto found = std::find(order.begin(), order.end(), kind);
    if (is_on && found == order.end()) *std::find(order.begin(), order.end(), Kind::none) = kind;
    if (is_on || found == order.end()) return;
    std::rotate(found, found + 1, order.end());
    order.back() = Kind::none;
}

core::Mat3 turned(double angle_deg, const PlaneAxes& axes) {
    const double angle = core::radians_of(angle_deg);
    const auto first = static_cast<int>(axes.first), second = static_cast<int>(axes.second);
    core::Mat3 linear(1.0);
    linear[first][first] = linear[second][second] = core::cos(angle);
    linear[first][second] = core::sin(angle); // by columns
    linear[second][first] = -core::sin(angle);
    return linear;
}

core::Mat3 linear_of(const Transforms& transforms, Kind kind, const PlaneAxes& axes) {
    if (kind == Kind::turn) return turned(transforms.turn_deg, axes);
    if (kind == Kind::tilt) return transforms.plane;
    core::Mat3 linear(1.0);
    for (int axis = 0; axis < 3; ++axis) {
        if (kind == Kind::scale) linear[axis][axis] = transforms.scale;
        if (kind == Kind::mirror && transforms.mirrored[static_cast<size_t>(axis)])
            linear[axis][axis] = -1.0;
    }
    return linear;
}

/// Activates the transformations. A shift alone is the local offset and needs no frame.
void use_transforms(Execution& execution) {
    const Transforms& transforms = klartext_of(execution.state).transforms;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    Offsets offsets = execution.modal().offsets;
    ProgramFrame frame;
    bool shift_alone = true;
    for (const Kind kind : transforms.order) {
        if (kind == Kind::none) break;
        if (kind == Kind::shift) {
            const AxisValues& by = transforms.shift;
            frame.shift += frame.linear * core::Vec3(by[0], by[1], by[2]);
            continue;
        }
        shift_alone = false;
        frame.linear = frame.linear * linear_of(transforms, kind, axes);
    }
    const auto tilt = std::find(transforms.order.begin(), transforms.order.end(), Kind::tilt);
    offsets.tilted_plane = tilt != transforms.order.end();
    frame.tilts_tool = offsets.tilted_plane && transforms.plane[2] != core::Vec3(0.0, 0.0, 1.0);
    offsets.local = transforms.shift;
    offsets.has_frame = !shift_alone;
    offsets.frame = shift_alone ? ProgramFrame{} : frame;
    if (!shift_alone) offsets.local[0] = offsets.local[1] = offsets.local[2] = 0.0;
    change_offsets(execution, offsets);
    execution.emit(SetOffset{offsets});
}

void shift(Execution& execution, Transforms& transforms) {
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word) continue;
        const double value = axis_value(execution, axis, *word);
        const bool incremental = word->addressing == Addressing::incremental;
        transforms.shift[axis] = incremental ? transforms.shift[axis] + value : value;
    }
    const bool is_on = std::any_of(transforms.shift.begin(), transforms.shift.end(),
                                   [](double value) { return value != 0.0; });
    keep_order(transforms, Kind::shift, is_on);
}

void mirror(Execution& execution, Transforms& transforms) {
    bool is_on = false;
    for (size_t axis = 0; axis < 3; ++axis) {
        transforms.mirrored[axis] = execution.statement.word(axis_letters[axis]) != nullptr;
        is_on |= transforms.mirrored[axis];
    }
    keep_order(transforms, Kind::mirror, is_on);
}

void turn(Execution& execution, Transforms& transforms) {
    const Word* word = execution.statement.word('R');
    if (!word) return;
    const bool incremental = word->addressing == Addressing::incremental;
    transforms.turn_deg = incremental ? transforms.turn_deg + word->value : word->value;
    keep_order(transforms, Kind::turn, transforms.turn_deg != 0.0);
}

core::Result<void> scale(Execution& execution, Transforms& transforms) {
    const Word* word = execution.statement.word('P');
    if (!word) return {};
    if (!(word->value > 0.0))
        return refuse_statement(execution, "the scaling factor must be greater than 0");
    transforms.scale = word->value;
    keep_order(transforms, Kind::scale, transforms.scale != 1.0);
    return {};
}

/// The transformation of a cycle: 7, 8, 10, 11.
Kind kind_of(int cycle) {
    return cycle == 7    ? Kind::shift
           : cycle == 8  ? Kind::mirror
           : cycle == 10 ? Kind::turn
                         : Kind::scale;
}

/// Cycle 19, by spatial angles. Without angles, or with zeros, it is off.
core::Result<void> tilt(Execution& execution) {
    if (klartext_of(execution.block).part == 0) return {};
    core::Vec3 angles(0.0);
    bool is_on = false;
    for (int axis = 0; axis < 3; ++axis)
        if (const Word* word = execution.statement.word("ABC"[axis])) {
            angles[axis] = word->value;
            is_on |= word->value != 0.0;
        }
    if (is_on)
        execution.warn(klartext_of(execution.block).span,
                       "CYCL DEF 19: the angles are taken for spatial angles; a machine can be "
                       "configured to take them for positions of its rotary axes",
                       Severity::note);
    if (auto done =
            use_plane(execution, is_on ? std::optional(spatial_rotation(angles)) : std::nullopt);
        !done)
        return done;
    if (!execution.modal().offsets.machine) return {};
    if (auto positions = calculate_plane(execution); !positions)
        return tl::unexpected(std::move(positions).error());
    return {};
}

} // namespace

core::Result<void> use_plane(Execution& execution, const std::optional<core::Mat3>& axes) {
    Transforms transforms = klartext_of(execution.state).transforms;
    const auto& order = transforms.order;
    const auto known = std::find(order.begin(), order.end(), Kind::tilt);
    if (known != order.end() && known + 1 != order.end() && *(known + 1) != Kind::none)
        return refuse_statement(execution,
                                "changing a tilted plane while a datum shift, a mirror image, a "
                                "rotation or a scaling that came after it is on is not supported "
                                "yet: cancel it first");
    transforms.plane = axes.value_or(core::Mat3(1.0));
    keep_order(transforms, Kind::tilt, axes.has_value());
    if (transforms == klartext_of(execution.state).transforms) return {};
    writable_klartext(execution.state).transforms = transforms;
    use_transforms(execution);
    return {};
}

/// The first line of such a cycle names it; for mirror images it also cancels the previous one.
core::Result<void> change_coordinates(Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    if (command.number == 19) return tilt(execution);
    if (command.part == 0) return {};
    Transforms transforms = klartext_of(execution.state).transforms;
    switch (command.number) {
    case 7:
        shift(execution, transforms);
        break;
    case 8:
        mirror(execution, transforms);
        break;
    case 10:
        turn(execution, transforms);
        break;
    default:
        if (auto done = scale(execution, transforms); !done) return done;
        break;
    }
    const Transforms& before = klartext_of(execution.state).transforms;
    if (transforms == before) return {};
    const auto tilt = std::find(before.order.begin(), before.order.end(), Kind::tilt);
    if (tilt != before.order.end()
        && std::find(before.order.begin(), tilt, kind_of(command.number)) != tilt)
        return refuse_statement(execution, "changing a transformation that came before the tilted "
                                           "plane is not supported yet: program PLANE RESET before "
                                           "it");
    writable_klartext(execution.state).transforms = transforms;
    use_transforms(execution);
    return {};
}

} // namespace gcode
