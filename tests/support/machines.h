#pragma once

#include "core/motion/machine.h"

namespace test_support {

inline core::MachineAxis axis(core::Vec3 direction, core::Side side, core::LinkId carrier,
                              core::Vec3 point = core::Vec3(0.0)) {
    core::MachineAxis made{.direction = direction};
    made.side = side;
    made.carrier = carrier;
    made.point = point;
    return made;
}

/// X, Y and Z move the tool; A tilts a trunnion that carries the table C.
inline core::Machine trunnion(const core::Vec3& a_point, const core::Vec3& c_point) {
    core::Machine machine;
    machine.axes[3] = axis({1, 0, 0}, core::Side::table, core::LinkId::base, a_point);
    machine.axes[5] = axis({0, 0, 1}, core::Side::table, core::link_of(3), c_point);
    machine.table = core::link_of(5);
    return machine;
}

/// X moves the table that carries C; Y and Z move a head that B swivels about `b_point`.
inline core::Machine head_and_table(const core::Vec3& b_point, const core::Vec3& c_point) {
    core::Machine machine;
    machine.axes[0] = axis({1, 0, 0}, core::Side::table, core::LinkId::base);
    machine.axes[1].carrier = core::LinkId::base;
    machine.axes[4] = axis({0, 1, 0}, core::Side::tool, core::link_of(2), b_point);
    machine.axes[5] = axis({0, 0, 1}, core::Side::table, core::link_of(0), c_point);
    machine.spindle = core::link_of(4);
    machine.table = core::link_of(5);
    return machine;
}

/// C swivels a fork on the Z slide, and B the spindle in it.
inline core::Machine fork_head(const core::Vec3& pivot) {
    core::Machine machine;
    machine.axes[5] = axis({0, 0, 1}, core::Side::tool, core::link_of(2), pivot);
    machine.axes[4] = axis({0, 1, 0}, core::Side::tool, core::link_of(5), pivot);
    machine.spindle = core::link_of(4);
    return machine;
}

} // namespace test_support
