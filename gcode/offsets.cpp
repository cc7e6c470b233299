#include "gcode/offsets.h"

namespace gcode {

Position machine_minus_program(const Offsets& offsets) {
    Position total = offsets.axis;
    for (int axis = 0; axis < 3; ++axis) {
        if (!total[axis]) continue;
        *total[axis] += offsets.work[offsets.active][axis] + offsets.local[axis];
        if (axis == 2) *total[axis] += offsets.tool_length;
    }
    return total;
}

Position machine_from_program(const Offsets& offsets, const Position& program) {
    Position machine = machine_minus_program(offsets);
    for (size_t axis = 0; axis < 3; ++axis) {
        if (machine[axis] && program[axis])
            *machine[axis] += *program[axis];
        else
            machine[axis].reset();
    }
    return machine;
}

Position program_from_machine(const Offsets& offsets, const Position& machine) {
    const Position total = machine_minus_program(offsets);
    Position program = machine;
    for (size_t axis = 0; axis < 3; ++axis) {
        if (total[axis] && program[axis])
            *program[axis] -= *total[axis];
        else
            program[axis].reset();
    }
    return program;
}

} // namespace gcode
