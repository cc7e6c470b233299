#include "gcode/digest.h"
#include "gcode/interpreter.h"

namespace gcode {
namespace {

template <typename T>
uint64_t number_of(T value) {
    return static_cast<uint64_t>(static_cast<int64_t>(value));
}

template <typename Id>
void add_id(Digest& digest, const std::optional<Id>& id) {
    digest.add(uint64_t{id.has_value()});
    if (id) digest.add(number_of(core::value_of(*id)));
}

template <typename Values>
void add_all(Digest& digest, const Values& values) {
    for (const auto& value : values) digest.add(value);
}

void add(Digest& digest, const Offsets& offsets) {
    digest.add(number_of(offsets.active));
    add_all(digest, offsets.work.origin);
    digest.add(offsets.work.rotation_deg);
    add_all(digest, offsets.local);
    add_all(digest, offsets.axis);
    add_all(digest, offsets.tool);
    digest.add(uint64_t{offsets.has_frame});
    if (!offsets.has_frame) return;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) digest.add(offsets.frame.linear[column][row]);
        digest.add(offsets.frame.shift[row]);
    }
}

void add(Digest& digest, const CannedCycle& cycle) {
    digest.add(number_of(cycle.code));
    for (const auto& value : {cycle.bottom, cycle.r, cycle.dwell, cycle.peck, cycle.initial_level})
        digest.add(value);
    add_all(digest, cycle.shift);
    digest.add(uint64_t{cycle.incremental});
}

void add_modes(Digest& digest, const ModalState& modal) {
    for (const int mode :
         {int(modal.unit),          int(modal.unit_said),      modal.motion.value_or(-1),
          int(modal.plane),         int(modal.distance),       int(modal.arc_distance),
          int(modal.feed_mode),     int(modal.retract),        int(modal.path),
          int(modal.compensation),  int(modal.leaves_contour), int(modal.diameter_mode),
          int(modal.surface_speed), int(modal.feed_override),  int(modal.speed_override),
          int(modal.adaptive_feed), int(modal.feed_hold),      int(modal.spindle),
          int(modal.mist),          int(modal.flood)})
        digest.add(number_of(mode));
    for (const double value :
         {modal.path_tolerance, modal.naive_tolerance, modal.compensation_radius,
          modal.fastest_speed, modal.speed, modal.length_sign})
        digest.add(value);
}

void add(Digest& digest, const ModalState& modal) {
    add_modes(digest, modal);
    for (const Position* place :
         {&modal.position, &modal.home, &modal.second_home, &modal.suspended_axis})
        add_all(digest, *place);
    digest.add(modal.feed);
    digest.add(uint64_t{modal.cycle.has_value()});
    if (modal.cycle) add(digest, *modal.cycle);
    add_id(digest, modal.selected_tool);
    add_id(digest, modal.tool);
    add_id(digest, modal.length_number);
    add(digest, modal.offsets);
}

void add(Digest& digest, const Place& place) {
    digest.add(number_of(place.source));
    digest.add(number_of(place.line));
}

void add(Digest& digest, const Frame& frame) {
    add(digest, frame.called_from);
    add(digest, frame.begin);
    digest.add(frame.name);
    add_all(digest, frame.locals);
    for (const auto& [name, value] : frame.named) {
        digest.add(name);
        digest.add(value);
    }
    for (const auto& [line, left] : frame.repeats) {
        digest.add(number_of(line));
        digest.add(number_of(left));
    }
    digest.add(number_of(frame.rounds_left));
    digest.add(
        number_of(int(frame.shares_locals) + 2 * int(frame.restores) + 4 * int(frame.modal_macro)));
    digest.add(uint64_t{frame.again.has_value()});
    if (frame.again) add_all(digest, *frame.again);
    digest.add(uint64_t{frame.saved->has_value()});
    if (*frame.saved) add(digest, **frame.saved);
}

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
                         + 512 * int(state.points.said)));
    for (const Frame& frame : state.frames) add(digest, frame);
    for (const ModalMacro& macro : state.modal_macros) {
        digest.add(macro.name);
        add_all(digest, macro.arguments);
        digest.add(number_of(2 * macro.rounds + int(macro.each_block)));
    }
    add_all(digest, state.said);
    digest.add(uint64_t{state.contour.path.has_value()});
    if (state.contour.path) {
        digest.add(state.contour.path->tool.u);
        digest.add(state.contour.path->tool.v);
    }
    digest.add(state.parameters->digest());
    add(digest, *state.tables);
    return digest.value();
}

} // namespace gcode
