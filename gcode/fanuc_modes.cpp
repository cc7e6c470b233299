#include "gcode/fanuc_modes.h"

namespace gcode {
namespace {

double work_offset_code(const Offsets& offsets) {
    constexpr size_t fanuc_offsets = 6; // G54 to G59
    return offsets.active < fanuc_offsets ? 54.0 + static_cast<double>(offsets.active) : 54.1;
}

double plane_code(Plane plane) {
    return plane == Plane::xy ? 17.0 : plane == Plane::zx ? 18.0 : 19.0;
}

double feed_code(FeedMode mode) {
    if (mode == FeedMode::inverse_time) return 93.0;
    return mode == FeedMode::per_minute ? 94.0 : 95.0;
}

double length_code(double sign) { return sign == 0.0 ? 49.0 : sign > 0.0 ? 43.0 : 44.0; }

double radius_code(Side side) {
    if (side == Side::none) return 40.0;
    return side == Side::left ? 41.0 : 42.0;
}

double path_code(PathMode mode) { return mode == PathMode::continuous ? 64.0 : 61.0; }

} // namespace

Value fanuc_mode(const InterpreterState& state, int group) {
    const ModalState& modal = state.modal;
    switch (group) {
    case 1:
        return modal.motion ? Value(*modal.motion / 10.0) : Value(0.0);
    case 2:
        return plane_code(modal.plane);
    case 3:
        return modal.distance == DistanceMode::absolute ? 90.0 : 91.0;
    case 5:
        return feed_code(modal.feed_mode);
    case 6:
        return modal.unit == LengthUnit::inch ? 20.0 : 21.0;
    case 7:
        return radius_code(modal.compensation);
    case 8:
        return length_code(modal.length_sign);
    case 9:
        return modal.cycle ? modal.cycle->code / 10.0 : 80.0;
    case 10:
        return modal.retract == RetractMode::initial_level ? 98.0 : 99.0;
    case 12:
        return state.modal_macros.empty() ? 67.0 : 66.0;
    case 13:
        return modal.surface_speed ? 96.0 : 97.0;
    case 14:
        return work_offset_code(modal.offsets);
    case 15:
        return path_code(modal.path);
    default:
        return {};
    }
}

} // namespace gcode
