#include "gcode/codes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gcode {
namespace {

using enum ModalGroup;

constexpr DialectSet bit(DialectId id) { return static_cast<DialectSet>(1u << unsigned(id)); }

constexpr DialectSet linuxcnc = bit(DialectId::linuxcnc);
constexpr DialectSet fanuc = bit(DialectId::fanuc) | bit(DialectId::haas);
constexpr DialectSet haas = bit(DialectId::haas);
constexpr DialectSet grbl = bit(DialectId::grbl);
constexpr DialectSet mills = linuxcnc | fanuc;
constexpr DialectSet every = mills | grbl;

constexpr std::string_view no_cycle = "this canned cycle is not supported yet";
constexpr std::string_view no_probe = "probing is not supported yet";
constexpr std::string_view no_spline = "splines are not supported yet";
constexpr std::string_view no_rotation =
    "rotated, scaled and polar coordinates are not supported yet";
constexpr std::string_view no_jump =
    "jumps are not supported yet: write the blocks in the order they are run";
constexpr std::string_view no_other_change =
    "this way to change a tool is not supported yet: write M6";
constexpr std::string_view no_pallet =
    "pallets are not supported yet: check the program of each pallet on its own";
constexpr std::string_view no_five_axes = "motion of rotary axes is not supported yet";
constexpr std::string_view no_more_offsets = "extended work offsets are not supported yet";

// Sorted by letter and number. The groups are those of NISTIR 6556, table 4, where it has them.
constexpr Code codes[] = {
    {'G', tenths(0), motion, "XYZ", every, {}},
    {'G', tenths(1), motion, "XYZ", every, {}},
    {'G', tenths(2), motion, "XYZIJKRP", every, {}},
    {'G', tenths(3), motion, "XYZIJKRP", every, {}},
    {'G', tenths(4), action, "PXU", every, {}},
    {'G', tenths(5), motion, "XYZIJPQ", linuxcnc, no_spline},
    {'G', tenths(5, 1), motion, "XYZIJ", linuxcnc, no_spline},
    {'G', tenths(5, 2), motion, "XYZPL", linuxcnc, no_spline},
    {'G', tenths(5, 3), motion, "", linuxcnc, no_spline},
    {'G', tenths(7), diameter, "", linuxcnc, {}},
    {'G', tenths(8), diameter, "", linuxcnc, {}},
    {'G', tenths(8), other, "P", fanuc, {}},
    {'G', tenths(9), exact_stop, "", fanuc, {}},
    {'G', tenths(10), action, "XYZPLRQIJH", every, {}},
    {'G', tenths(11), action, "", fanuc, {}},
    {'G', tenths(12), action, "IJKQDLZ", haas, no_cycle},
    {'G', tenths(13), action, "IJKQDLZ", haas, no_cycle},
    {'G', tenths(15), polar, "", fanuc, {}},
    {'G', tenths(16), polar, "", fanuc, no_rotation},
    {'G', tenths(17), ModalGroup::plane, "", every, {}},
    {'G', tenths(17, 1), ModalGroup::plane, "", linuxcnc, {}},
    {'G', tenths(18), ModalGroup::plane, "", every, {}},
    {'G', tenths(18, 1), ModalGroup::plane, "", linuxcnc, {}},
    {'G', tenths(19), ModalGroup::plane, "", every, {}},
    {'G', tenths(19, 1), ModalGroup::plane, "", linuxcnc, {}},
    {'G', tenths(20), units, "", every, {}},
    {'G', tenths(21), units, "", every, {}},
    {'G', tenths(28), action, "XYZ", every, {}},
    {'G', tenths(28, 1), action, "", linuxcnc | grbl, {}},
    {'G', tenths(30), action, "XYZ", every, {}},
    {'G', tenths(30, 1), action, "", linuxcnc | grbl, {}},
    {'G', tenths(31), motion, "XYZ", fanuc, no_probe},
    {'G', tenths(33), motion, "XYZK", linuxcnc, {}},
    {'G', tenths(33, 1), motion, "XYZK", linuxcnc, {}},
    {'G', tenths(38, 2), motion, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(38, 3), motion, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(38, 4), motion, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(38, 5), motion, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(40), cutter_radius, "", every, {}},
    {'G', tenths(41), cutter_radius, "D", mills, {}},
    {'G', tenths(41, 1), cutter_radius, "DL", linuxcnc, {}},
    {'G', tenths(42), cutter_radius, "D", mills, {}},
    {'G', tenths(42, 1), cutter_radius, "DL", linuxcnc, {}},
    {'G', tenths(43), tool_length, "H", mills, {}},
    {'G', tenths(43, 1), tool_length, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(43, 2), tool_length, "HXYZ", linuxcnc, {}},
    {'G', tenths(43, 4), tool_length, "H", fanuc, no_five_axes},
    {'G', tenths(43, 5), tool_length, "H", fanuc, no_five_axes},
    {'G', tenths(44), tool_length, "H", fanuc, {}},
    {'G', tenths(49), tool_length, "", every, {}},
    {'G', tenths(50), scaling, "", fanuc, {}},
    {'G', tenths(50, 1), mirror, "XYZ", fanuc, no_rotation},
    {'G', tenths(51), scaling, "XYZPIJK", fanuc, no_rotation},
    {'G', tenths(51, 1), mirror, "XYZ", fanuc, no_rotation},
    {'G', tenths(52), action, "XYZ", mills, {}},
    {'G', tenths(53), action, "XYZ", every, {}},
    {'G', tenths(54), work_offset, "", every, {}},
    {'G', tenths(54, 1), work_offset, "P", fanuc, no_more_offsets},
    {'G', tenths(55), work_offset, "", every, {}},
    {'G', tenths(56), work_offset, "", every, {}},
    {'G', tenths(57), work_offset, "", every, {}},
    {'G', tenths(58), work_offset, "", every, {}},
    {'G', tenths(59), work_offset, "", every, {}},
    {'G', tenths(59, 1), work_offset, "", linuxcnc, {}},
    {'G', tenths(59, 2), work_offset, "", linuxcnc, {}},
    {'G', tenths(59, 3), work_offset, "", linuxcnc, {}},
    {'G', tenths(61), path_control, "", every, {}},
    {'G', tenths(61, 1), path_control, "", linuxcnc, {}},
    {'G', tenths(64), path_control, "PQ", mills, {}},
    {'G', tenths(65), macro, "", fanuc, {}},
    {'G', tenths(66), macro, "", fanuc, {}},
    {'G', tenths(66, 1), macro, "", fanuc, {}},
    {'G', tenths(67), macro, "", fanuc, {}},
    {'G', tenths(68), rotation, "XYZR", fanuc, no_rotation},
    {'G', tenths(68, 2), rotation, "XYZIJK", fanuc, no_five_axes},
    {'G', tenths(69), rotation, "", fanuc, {}},
    {'G', tenths(73), cycle, "XYZRQLPK", mills, {}},
    {'G', tenths(74), cycle, "XYZRQLPK", mills, no_cycle},
    {'G', tenths(76), cycle, "XYZRQLPIJK", mills, no_cycle},
    {'G', tenths(80), cycle, "", every, {}},
    {'G', tenths(81), cycle, "XYZRLK", mills, {}},
    {'G', tenths(82), cycle, "XYZRLPK", mills, {}},
    {'G', tenths(83), cycle, "XYZRLQPK", mills, {}},
    {'G', tenths(84), cycle, "XYZRLPQK", mills, no_cycle},
    {'G', tenths(85), cycle, "XYZRLK", mills, {}},
    {'G', tenths(86), cycle, "XYZRLPK", mills, {}},
    {'G', tenths(87), cycle, "XYZRLPIJKQ", mills, no_cycle},
    {'G', tenths(88), cycle, "XYZRLPK", mills, no_cycle},
    {'G', tenths(89), cycle, "XYZRLPK", mills, {}},
    {'G', tenths(90), distance, "", every, {}},
    {'G', tenths(90, 1), arc_distance, "", linuxcnc, {}},
    {'G', tenths(91), distance, "", every, {}},
    {'G', tenths(91, 1), arc_distance, "", linuxcnc | grbl, {}},
    {'G', tenths(92), action, "XYZ", every, {}},
    {'G', tenths(92, 1), action, "", every, {}},
    {'G', tenths(92, 2), action, "", linuxcnc, {}},
    {'G', tenths(92, 3), action, "", linuxcnc, {}},
    {'G', tenths(93), feed_mode, "", every, {}},
    {'G', tenths(94), feed_mode, "", every, {}},
    {'G', tenths(95), feed_mode, "", mills, {}},
    {'G', tenths(96), spindle_mode, "D", mills, {}},
    {'G', tenths(97), spindle_mode, "", mills, {}},
    {'G', tenths(98), retract, "", mills, {}},
    {'G', tenths(99), retract, "", mills, {}},
    {'G', tenths(103), other, "P", haas, {}},
    {'G', tenths(187), other, "PE", haas, {}},
    {'M', tenths(0), stopping, "", every, {}},
    {'M', tenths(1), stopping, "", every, {}},
    {'M', tenths(2), stopping, "", every, {}},
    {'M', tenths(3), spindle, "", every, {}},
    {'M', tenths(4), spindle, "", every, {}},
    {'M', tenths(5), spindle, "", every, {}},
    {'M', tenths(6), tool_change, "", every, {}},
    {'M', tenths(7), coolant, "", every, {}},
    {'M', tenths(8), coolant, "", every, {}},
    {'M', tenths(9), coolant, "", every, {}},
    {'M', tenths(16), tool_change, "", haas, no_other_change},
    {'M', tenths(19), spindle, "RQPD", mills, {}},
    {'M', tenths(30), stopping, "", every, {}},
    {'M', tenths(46), other, "PQ", haas, no_jump},
    {'M', tenths(48), overrides, "", mills, {}},
    {'M', tenths(49), overrides, "", mills, {}},
    {'M', tenths(50), overrides, "P", linuxcnc, {}},
    {'M', tenths(50), other, "P", haas, no_pallet},
    {'M', tenths(51), overrides, "P", linuxcnc, {}},
    {'M', tenths(52), overrides, "P", linuxcnc, {}},
    {'M', tenths(53), overrides, "P", linuxcnc, {}},
    {'M', tenths(60), stopping, "", linuxcnc, {}},
    {'M', tenths(61), tool_change, "Q", linuxcnc, {}},
    {'M', tenths(62), other, "P", linuxcnc, {}},
    {'M', tenths(63), other, "P", linuxcnc, {}},
    {'M', tenths(64), other, "P", linuxcnc, {}},
    {'M', tenths(65), other, "P", linuxcnc, {}},
    {'M', tenths(66), other, "PELQ", linuxcnc, {}},
    {'M', tenths(67), other, "EQ", linuxcnc, {}},
    {'M', tenths(68), other, "EQ", linuxcnc, {}},
    {'M', tenths(70), other, "", linuxcnc, {}},
    {'M', tenths(71), other, "", linuxcnc, {}},
    {'M', tenths(72), other, "", linuxcnc, {}},
    {'M', tenths(73), other, "", linuxcnc, {}},
    {'M', tenths(96), subprogram, "PQ", haas, {}},
    {'M', tenths(97), subprogram, "PL", haas, {}},
    {'M', tenths(98), subprogram, "PLQ", mills, {}},
    {'M', tenths(99), subprogram, "P", mills, {}},
    {'M', tenths(198), subprogram, "PLQ", fanuc, {}},
};

constexpr bool before(const Code& a, const Code& b) {
    return a.letter != b.letter ? a.letter < b.letter : a.tenths < b.tenths;
}
static_assert(std::is_sorted(std::begin(codes), std::end(codes), before));

/// For each letter, where the first row of a code stands in the table by tenths, counted from 1; 0
/// for none.
struct Positions {
    static constexpr int most = 2000;
    std::array<uint8_t, most> g{}, m{};
};

constexpr Positions positions = [] {
    static_assert(std::size(codes) < 256);
    Positions found;
    for (size_t i = std::size(codes); i-- > 0;)
        (codes[i].letter == 'G' ? found.g : found.m)[static_cast<size_t>(codes[i].tenths)] =
            static_cast<uint8_t>(i + 1);
    return found;
}();

} // namespace

const Code* find_code(char letter, double value, DialectId id) {
    const double scaled = value * 10.0;
    if (!(scaled > -0.5 && scaled < Positions::most - 0.5)) return nullptr;
    const auto rounded = static_cast<int>(scaled + 0.5);
    if (std::abs(scaled - rounded) > 1e-6) return nullptr;
    const auto& by_tenths = letter == 'G' ? positions.g : positions.m;
    const uint8_t place = by_tenths[static_cast<size_t>(rounded)];
    if (place == 0) return nullptr;
    // A code that means something else on another control has a row for each, side by side.
    const Code* found = &codes[place - 1];
    for (; found != std::end(codes) && found->letter == letter && found->tenths == rounded; ++found)
        if (found->dialects & bit(id)) return found;
    return nullptr;
}

} // namespace gcode
