#include "gcode/exec/state_digest.h"

#include "gcode/contour/contour.h"
#include "gcode/contour/spline.h"
#include "gcode/exec/interpreter.h"

namespace gcode {
namespace {

template <typename Id>
void add_id(Digest& digest, const std::optional<Id>& id) {
    digest.add(uint64_t{id.has_value()});
    if (id) digest.add(number_of(core::value_of(*id)));
}

void add(Digest& digest, const Offsets& offsets) {
    digest.add(number_of(offsets.active));
    add_all(digest, offsets.work.origin);
    digest.add(offsets.work.rotation_deg);
    add_all(digest, offsets.local);
    add_all(digest, offsets.axis);
    add_all(digest, offsets.tool);
    digest.add(uint64_t{offsets.tilted_plane});
    digest.add(uint64_t{offsets.follows_tip});
    digest.add(uint64_t{offsets.has_world});
    digest.add(uint64_t{offsets.has_frame});
    if (!offsets.has_frame) return;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) digest.add(offsets.frame.linear[column][row]);
        digest.add(offsets.frame.shift[row]);
    }
    digest.add(uint64_t{offsets.frame.tilts_tool});
}

void add(Digest& digest, const core::Vec3& vector) {
    for (int axis = 0; axis < 3; ++axis) digest.add(vector[axis]);
}

void add(Digest& digest, const ProgramTransforms& transforms) {
    digest.add(uint64_t{transforms.scaling.has_value()});
    if (transforms.scaling) {
        add(digest, transforms.scaling->factors);
        add(digest, transforms.scaling->centre);
    }
    for (const bool axis : transforms.mirror.axes) digest.add(uint64_t{axis});
    add(digest, transforms.mirror.position);
    digest.add(uint64_t{transforms.rotation.has_value()});
    if (const auto& rotation = transforms.rotation) {
        digest.add(number_of(2 * rotation->normal + int(rotation->is_reversed)));
        add(digest, rotation->centre);
        digest.add(rotation->degrees);
    }
    digest.add(uint64_t{transforms.tilt.has_value()});
    if (const auto& tilt = transforms.tilt) {
        for (int column = 0; column < 3; ++column) add(digest, tilt->axes[column]);
        add(digest, tilt->origin);
        digest.add(uint64_t{tilt->follows_table});
    }
    digest.add(uint64_t{transforms.begun_plane.has_value()});
    if (const auto& begun = transforms.begun_plane) {
        digest.add(number_of(4 * begun->next + 2 * int(begun->adds) + int(begun->by_points)));
        for (const core::Vec3& point : begun->points) add(digest, point);
    }
    digest.add(uint64_t{transforms.follows_vectors});
    digest.add(uint64_t{transforms.polar.has_value()});
    if (const auto& polar = transforms.polar) {
        add_all(digest, polar->origin);
        digest.add(polar->radius);
        digest.add(polar->angle_deg);
    }
    digest.add(uint64_t{transforms.before_rotation.has_value()});
    if (transforms.before_rotation) add_all(digest, *transforms.before_rotation);
}

void add(Digest& digest, const CannedCycle& cycle) {
    digest.add(number_of(int(cycle.code)));
    for (const auto& value : {cycle.bottom, cycle.r, cycle.dwell, cycle.peck, cycle.initial_level})
        digest.add(value);
    add_all(digest, cycle.shift);
    digest.add(uint64_t{cycle.r_is_incremental});
    digest.add(uint64_t{cycle.bottom_is_incremental});
}

void add(Digest& digest, const SplineState& spline) {
    digest.add(number_of(spline.gathering.order));
    for (const ControlPoint& point : spline.gathering.points)
        for (const double value : {point.at.x, point.at.y, point.weight}) digest.add(value);
    digest.add(spline.next_tangent.x);
    digest.add(spline.next_tangent.y);
}

void add_modes(Digest& digest, const ModalState& modal) {
    for (const int mode : {int(modal.unit),
                           int(modal.unit_said),
                           modal.motion ? int(*modal.motion) : -1,
                           int(modal.motion_cancelled),
                           int(modal.plane),
                           int(modal.distance),
                           int(modal.arc_distance),
                           int(modal.feed_mode),
                           int(modal.retract),
                           int(modal.path),
                           int(modal.compensation),
                           int(modal.leaves_contour),
                           int(modal.diameter_mode),
                           int(modal.surface_speed),
                           int(modal.feed_override),
                           int(modal.speed_override),
                           int(modal.adaptive_feed),
                           int(modal.feed_hold),
                           int(modal.spindle),
                           int(modal.mist),
                           int(modal.flood),
                           modal.turning_orientation})
        digest.add(number_of(mode));
    for (const double value :
         {modal.path_tolerance, modal.naive_tolerance, modal.compensation_radius,
          modal.fastest_speed, modal.speed, modal.length_sign, modal.cycle_dwell})
        digest.add(value);
    const CornerTolerances& corners = modal.corner_tolerances;
    digest.add(uint64_t{corners.rapids_keep_speed});
    for (const auto& value : {corners.distance, corners.rapid_tolerance, corners.rapid_distance})
        digest.add(value);
    digest.add(uint64_t{corners.between_kinds});
    digest.add(uint64_t{corners.blends});
}

void add(Digest& digest, const ModalState& modal) {
    add_modes(digest, modal);
    for (const Position* position :
         {&modal.position, &modal.home, &modal.second_home, &modal.suspended_axis})
        add_all(digest, *position);
    add_all(digest, modal.spread);
    digest.add(number_of(int(modal.axis_offset_on) + 2 * int(modal.has_probed)));
    digest.add(number_of(int(modal.distance_said) + 2 * int(modal.work_said)
                         + 4 * int(modal.retract_said) + 8 * int(modal.incremental_stays)
                         + 16 * int(modal.plane_said)));
    add_all(digest, modal.offset_travel);
    add_all(digest, modal.length_travel);
    digest.add(modal.feed);
    digest.add(number_of(int(modal.feed_unit)));
    digest.add(uint64_t{modal.cycle.has_value()});
    if (modal.cycle) add(digest, *modal.cycle);
    add_id(digest, modal.selected_tool);
    add_id(digest, modal.tool);
    add_id(digest, modal.length_number);
    add_id(digest, modal.length_left);
    digest.add(number_of(modal.radius_number));
    add(digest, modal.offsets);
    add(digest, modal.transforms);
    digest.add(uint64_t{modal.way_home.has_value()});
    if (modal.way_home) add_all(digest, *modal.way_home);
    add_all(digest, modal.direction);
    digest.add(number_of(int(modal.following.may_be_on) + 2 * modal.following.unknown_axes
                         + 1024 * int(modal.following.rotary_unknown)
                         + 8192 * int(modal.following.is_pointed)
                         + 2048 * int(modal.following.awaits_sync)
                         + 4096 * int(modal.turns_in_plane) + 16 * modal.doubt));
    digest.add(number_of(modal.kinematics));
}

void add(Digest& digest, const UnknownValues& unknown) {
    for (const auto& [name, value] : unknown) {
        digest.add(name);
        digest.add(value.identity);
    }
}

void add(Digest& digest, const ProgramLine& position) {
    digest.add(number_of(position.source));
    digest.add(number_of(position.line));
}

} // namespace

void add(Digest& digest, const Frame& frame) {
    add(digest, frame.called_from);
    add(digest, frame.begin);
    digest.add(frame.name);
    add_all(digest, frame.locals);
    digest.add(frame.unpredictable_locals);
    for (const std::string& name : frame.unpredictable_names) digest.add(name);
    add(digest, frame.unknown);
    for (const auto& [name, value] : frame.named) {
        digest.add(name);
        digest.add(value);
    }
    for (const auto& [name, type] : frame.types) {
        digest.add(name);
        digest.add(number_of(int(type)));
    }
    for (const auto& [line, left] : frame.repeats) {
        digest.add(number_of(line));
        digest.add(number_of(left));
    }
    for (const RepeatedLines& lines : frame.repeated) digest.add(number_of(lines.statement));
    for (const uint32_t line : frame.known_subs) digest.add(number_of(line));
    digest.add(number_of(frame.rounds_left));
    digest.add(
        number_of(int(frame.shares_locals) + 2 * int(frame.restores) + 4 * int(frame.modal_macro)));
    digest.add(uint64_t{frame.again.has_value()});
    if (frame.again) {
        add_all(digest, frame.again->values);
        digest.add(frame.again->unpredictable);
        add(digest, frame.again->unknown);
    }
    digest.add(uint64_t{frame.saved->has_value()});
    if (*frame.saved) add(digest, **frame.saved);
    if (frame.saved_language) frame.saved_language->add_to(digest);
}

namespace {

void add(Digest& digest, const Tables& tables) {
    for (const WorkOffset& offset : tables.work) {
        add_all(digest, offset.origin);
        digest.add(offset.rotation_deg);
    }
    add_all(digest, tables.external);
    for (const auto& [number, entry] : tables.lengths) {
        digest.add(number_of(core::value_of(number)));
        for (const double value : {entry.length, entry.wear, entry.diameter, entry.radius_wear,
                                   entry.front_deg, entry.back_deg, double(entry.orientation)})
            digest.add(value);
        add_all(digest, entry.shift);
    }
}

} // namespace

uint64_t digest_of(const InterpreterState& state) {
    Digest digest;
    add(digest, state.modal);
    add(digest, state.next);
    digest.add(number_of(int(state.tape_open) + 2 * int(state.said_unit) + 4 * int(state.said_home)
                         + 8 * int(state.ending) + 64 * int(state.said_time)
                         + 128 * int(state.points.present) + 256 * int(state.points.missing)
                         + 512 * int(state.points.said) + 1024 * int(state.is_iso_mode)
                         + 2048 * int(state.after_end)));
    for (const Frame& frame : state.frames) add(digest, frame);
    for (const ModalMacro& macro : state.modal_macros) {
        digest.add(macro.name);
        add_all(digest, macro.arguments);
        digest.add(macro.unpredictable);
        add(digest, macro.unknown);
        digest.add(number_of(2 * macro.rounds + int(macro.each_block)));
    }
    digest.add(uint64_t{state.contour->path.has_value()});
    if (state.contour->path) {
        digest.add(state.contour->path->tool.u);
        digest.add(state.contour->path->tool.v);
    }
    add_all(digest, state.said);
    digest.add(state.parameters->digest());
    add(digest, *state.tables);
    add(digest, *state.spline);
    if (const LanguageState* own = state.language.get()) own->add_to(digest);
    for (const NamedTool& tool : state.named_tools) digest.add(tool.name);
    digest.add(uint64_t{state.points.counts_steps});
    add(digest, *state.readings->unknown);
    for (const OpenPremise& premise : state.readings->met) {
        if (!premise.id.question) continue;
        digest.add(number_of(static_cast<int>(*premise.id.question)));
        digest.add(uint64_t{premise.id.occurrence});
        digest.add(uint64_t{premise.taken});
    }
    return digest.value();
}

} // namespace gcode
