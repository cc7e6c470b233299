#include "gcode/language/codes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gcode {
namespace {

using enum ModalGroup;

constexpr DialectSet bit(DialectId id) { return static_cast<DialectSet>(1u << unsigned(id)); }

constexpr DialectSet linuxcnc = bit(DialectId::linuxcnc);
constexpr DialectSet fanuc =
    bit(DialectId::fanuc) | bit(DialectId::haas) | bit(DialectId::siemens_iso);
constexpr DialectSet haas = bit(DialectId::haas);
constexpr DialectSet grbl = bit(DialectId::grbl);
constexpr DialectSet klartext = bit(DialectId::heidenhain);
constexpr DialectSet siemens = bit(DialectId::siemens);
constexpr DialectSet both_siemens = siemens | bit(DialectId::siemens_iso);
constexpr DialectSet mills = linuxcnc | fanuc;
constexpr DialectSet every = mills | grbl;

constexpr std::string_view no_jump =
    "jumps are not supported yet: program the blocks in the order in which they run";
constexpr std::string_view no_other_change =
    "this form of tool change is not supported yet: use M6";
constexpr std::string_view no_pallet =
    "pallets are not supported yet: check the program of each pallet separately";
constexpr std::string_view no_pocket =
    "the path of the control inside the pocket is not published and cannot be checked: program the "
    "passes with G1, G2 and G3";
constexpr std::string_view no_engraving =
    "the strokes of the engraving font are not published and cannot be checked: program the "
    "letters with G1, G2 and G3";

constexpr std::string_view no_slanted_axis = "grinding with a slanted axis is not supported";
constexpr std::string_view no_changing_pitch = "threads with variable pitch are not supported yet";
constexpr std::string_view no_axis_offset =
    "the programmable offset of single axes is not supported yet: use ATRANS";
constexpr std::string_view no_smooth_approach =
    "smooth approach and retract are not supported yet: program the moves with G1 and G2 or G3";
constexpr std::string_view no_point_between =
    "a fixed-point approach through an intermediate point is not supported yet: program a move, "
    "then G75";
constexpr std::string_view no_path_time =
    "a feed given as travel time is not supported yet: use G94";

constexpr std::string_view no_five_axes = "moves of rotary axes are not supported yet";

constexpr std::string_view no_machine_point = "the machine builder's datum is unknown: use M91";

constexpr std::string_view no_turn_feed =
    "feed per revolution is not supported yet: program F in mm/min";

constexpr std::string_view no_retreat =
    "a retract along the tool axis is not supported yet: program it as L with M91";

// Sorted by letter and number. The groups are those of NISTIR 6556, table 4, where it has them.
constexpr Code codes[] = {
    {'G', tenths(0), motion, "XYZ", every | siemens, {}},
    {'G', tenths(1), motion, "XYZ", every | siemens, {}},
    {'G', tenths(2), motion, "XYZIJKRP", every | siemens, {}},
    {'G', tenths(3), motion, "XYZIJKRP", every | siemens, {}},
    {'G', tenths(4), action, "PXU", every | siemens, {}},
    {'G', tenths(5), motion, "XYZIJPQ", linuxcnc, {}},
    {'G', tenths(5), other, "PR", fanuc, {}},
    {'G', tenths(5), other, "", siemens, no_slanted_axis},
    {'G', tenths(5, 1), motion, "XYZIJ", linuxcnc, {}},
    {'G', tenths(5, 1), other, "XYZPQRL", fanuc, {}},
    {'G', tenths(5, 2), motion, "XYZPL", linuxcnc, {}},
    {'G', tenths(5, 3), motion, "XYZ", linuxcnc, {}},
    {'G', tenths(7), diameter, "", linuxcnc, {}},
    {'G', tenths(7), motion, "", siemens, no_slanted_axis},
    {'G', tenths(8), diameter, "", linuxcnc, {}},
    {'G', tenths(8), other, "P", fanuc, {}},
    {'G', tenths(9), exact_stop, "", fanuc, {}},
    {'G', tenths(9), exact_stop, "", siemens, {}},
    {'G', tenths(10), action, "XYZPLRQIJH", every, {}},
    {'G', tenths(11), action, "", fanuc, {}},
    {'G', tenths(12), action, "XYZIJKQDL", haas, {}},
    {'G', tenths(13), action, "XYZIJKQDL", haas, {}},
    {'G', tenths(13, 1), other, "", fanuc & ~haas, {}},
    {'G', tenths(15), polar, "", fanuc, {}},
    {'G', tenths(16), polar, "", fanuc, {}},
    {'G', tenths(17), ModalGroup::plane, "", every | klartext | siemens, {}},
    {'G', tenths(17, 1), ModalGroup::plane, "", linuxcnc, {}},
    {'G', tenths(18), ModalGroup::plane, "", every | klartext | siemens, {}},
    {'G', tenths(18, 1), ModalGroup::plane, "", linuxcnc, {}},
    {'G', tenths(19), ModalGroup::plane, "", every | klartext | siemens, {}},
    {'G', tenths(19, 1), ModalGroup::plane, "", linuxcnc, {}},
    {'G', tenths(20), units, "", every | klartext, {}},
    {'G', tenths(21), units, "", every | klartext, {}},
    {'G', tenths(23), other, "", fanuc & ~haas, {}},
    {'G', tenths(25), other, "", fanuc & ~haas, {}},
    {'G', tenths(25), action, "XYZ", siemens, {}},
    {'G', tenths(26), other, "PQRI", fanuc & ~haas, {}},
    {'G', tenths(26), action, "XYZ", siemens, {}},
    {'G', tenths(27), action, "XYZ", fanuc, {}},
    {'G', tenths(28), action, "XYZ", every, {}},
    {'G', tenths(28, 1), action, "", linuxcnc | grbl, {}},
    {'G', tenths(29), action, "XYZ", fanuc, {}},
    {'G', tenths(30), action, "XYZ", every, {}},
    {'G', tenths(30, 1), action, "", linuxcnc | grbl, {}},
    {'G', tenths(31), action, "XYZPQ", fanuc, {}},
    {'G', tenths(33), motion, "XYZK", linuxcnc | siemens, {}},
    {'G', tenths(33, 1), motion, "XYZK", linuxcnc, {}},
    {'G', tenths(34), motion, "XYZIJK", siemens, no_changing_pitch},
    {'G', tenths(35), motion, "XYZIJK", siemens, no_changing_pitch},
    {'G', tenths(38, 2), motion, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(38, 3), motion, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(38, 4), motion, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(38, 5), motion, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(40), cutter_radius, "", every | siemens, {}},
    {'G', tenths(40, 1), other, "", fanuc & ~haas, {}},
    {'G', tenths(41), cutter_radius, "D", mills | siemens, {}},
    {'G', tenths(41, 1), cutter_radius, "DL", linuxcnc, {}},
    {'G', tenths(42), cutter_radius, "D", mills | siemens, {}},
    {'G', tenths(42, 1), cutter_radius, "DL", linuxcnc, {}},
    {'G', tenths(43), tool_length, "H", mills, {}},
    {'G', tenths(43, 1), tool_length, "XYZ", linuxcnc | grbl, {}},
    {'G', tenths(43, 2), tool_length, "HXYZ", linuxcnc, {}},
    {'G', tenths(43, 4), tool_length, "HPQR", fanuc, {}},
    {'G', tenths(43, 5), tool_length, "HIJKQ", fanuc, {}},
    {'G', tenths(44), tool_length, "H", fanuc, {}},
    {'G', tenths(47), action, "XYZPEIJR", haas, no_engraving},
    {'G', tenths(49), tool_length, "", every, {}},
    {'G', tenths(50), scaling, "", fanuc, {}},
    {'G', tenths(50, 1), mirror, "XYZ", fanuc, {}},
    {'G', tenths(51), scaling, "XYZPIJK", fanuc, {}},
    {'G', tenths(51, 1), mirror, "XYZ", fanuc, {}},
    {'G', tenths(52), action, "XYZ", mills, {}},
    {'G', tenths(53), action, "XYZ", every | klartext | siemens, {}},
    {'G', tenths(53, 1), other, "PR", fanuc, {}},
    {'G', tenths(54), work_offset, "", every | siemens, {}},
    {'G', tenths(54, 1), work_offset, "P", fanuc, {}},
    {'G', tenths(55), work_offset, "", every | siemens, {}},
    {'G', tenths(56), work_offset, "", every | siemens, {}},
    {'G', tenths(57), work_offset, "", every | siemens, {}},
    {'G', tenths(58), work_offset, "", every, {}},
    {'G', tenths(58), action, "XYZ", siemens, no_axis_offset},
    {'G', tenths(59), work_offset, "", every, {}},
    {'G', tenths(59), action, "XYZ", siemens, no_axis_offset},
    {'G', tenths(59, 1), work_offset, "", linuxcnc, {}},
    {'G', tenths(59, 2), work_offset, "", linuxcnc, {}},
    {'G', tenths(59, 3), work_offset, "", linuxcnc, {}},
    {'G', tenths(60), path_control, "", siemens, {}},
    {'G', tenths(61), path_control, "", every, {}},
    {'G', tenths(61, 1), path_control, "", mills, {}},
    {'G', tenths(62), path_control, "", fanuc, {}},
    {'G', tenths(62), other, "", siemens, {}},
    {'G', tenths(63), path_control, "", fanuc, {}},
    {'G', tenths(63), motion, "XYZ", siemens, {}},
    {'G', tenths(64), path_control, "PQ", mills | siemens, {}},
    {'G', tenths(65), macro, "", fanuc, {}},
    {'G', tenths(66), macro, "", fanuc, {}},
    {'G', tenths(66, 1), macro, "", fanuc, {}},
    {'G', tenths(67), macro, "", fanuc, {}},
    {'G', tenths(68), rotation, "XYZRIJK", fanuc, {}},
    {'G', tenths(68, 2), rotation, "XYZIJKPQR", fanuc, {}},
    {'G', tenths(69), rotation, "", fanuc, {}},
    {'G', tenths(70), motion, "XYZQDEP", linuxcnc, {}},
    {'G', tenths(70), action, "XYZIJL", haas, {}},
    {'G', tenths(70), units, "", siemens, {}},
    {'G', tenths(71), motion, "XYZQDIR", linuxcnc, {}},
    {'G', tenths(71), action, "XYZIJKL", haas, {}},
    {'G', tenths(71), units, "", siemens, {}},
    {'G', tenths(71, 1), motion, "XYZQDIR", linuxcnc, {}},
    {'G', tenths(71, 2), motion, "XYZQDIR", linuxcnc, {}},
    {'G', tenths(72), motion, "XYZQDIR", linuxcnc, {}},
    {'G', tenths(72), action, "XYZIJL", haas, {}},
    {'G', tenths(72, 1), motion, "XYZQDIR", linuxcnc, {}},
    {'G', tenths(72, 2), motion, "XYZQDIR", linuxcnc, {}},
    {'G', tenths(73), cycle, "XYZRQL", linuxcnc, {}},
    {'G', tenths(73), cycle, "XYZRQLPK", fanuc & ~haas, {}},
    {'G', tenths(73), cycle, "XYZRQLPIJK", haas, {}},
    {'G', tenths(74), cycle, "XYZRLP", linuxcnc, {}},
    {'G', tenths(74), cycle, "XYZRQLPKJ", fanuc, {}},
    {'G', tenths(74), action, "XYZ", siemens, {}},
    {'G', tenths(75), action, "XYZ", siemens, {}},
    {'G', tenths(76), cycle, "XYZRQLPIJKHE", linuxcnc, {}},
    {'G', tenths(76), cycle, "XYZRQLPIJK", fanuc, {}},
    {'G', tenths(77), cycle, "XYZRQLPIJ", haas, {}},
    {'G', tenths(80), cycle, "", every, {}},
    {'G', tenths(81), cycle, "XYZRL", linuxcnc, {}},
    {'G', tenths(81), cycle, "XYZRLK", fanuc, {}},
    {'G', tenths(82), cycle, "XYZRLP", linuxcnc, {}},
    {'G', tenths(82), cycle, "XYZRLPK", fanuc, {}},
    {'G', tenths(83), cycle, "XYZRLQ", linuxcnc, {}},
    {'G', tenths(83), cycle, "XYZRLQPK", fanuc & ~haas, {}},
    {'G', tenths(83), cycle, "XYZRLQPIJK", haas, {}},
    {'G', tenths(84), cycle, "XYZRLP", linuxcnc, {}},
    {'G', tenths(84), cycle, "XYZRLPQKJ", fanuc, {}},
    {'G', tenths(85), cycle, "XYZRL", linuxcnc, {}},
    {'G', tenths(85), cycle, "XYZRLK", fanuc, {}},
    {'G', tenths(86), cycle, "XYZRLP", linuxcnc, {}},
    {'G', tenths(86), cycle, "XYZRLPK", fanuc, {}},
    {'G', tenths(87), cycle, "XYZRLIJK", linuxcnc, {}},
    {'G', tenths(87), cycle, "XYZRLPIJKQ", fanuc, {}},
    {'G', tenths(88), cycle, "XYZRLP", linuxcnc, {}},
    {'G', tenths(88), cycle, "XYZRLPK", fanuc, {}},
    {'G', tenths(89), cycle, "XYZRLP", linuxcnc, {}},
    {'G', tenths(89), cycle, "XYZRLPK", fanuc, {}},
    {'G', tenths(90), distance, "", every | siemens, {}},
    {'G', tenths(90, 1), arc_distance, "", linuxcnc, {}},
    {'G', tenths(91), distance, "", every | siemens, {}},
    {'G', tenths(91, 1), arc_distance, "", linuxcnc | grbl, {}},
    {'G', tenths(92), action, "XYZ", every, {}},
    {'G', tenths(92, 1), action, "", every, {}},
    {'G', tenths(92, 2), action, "", linuxcnc, {}},
    {'G', tenths(92, 3), action, "", linuxcnc, {}},
    {'G', tenths(93), feed_mode, "", every | siemens, {}},
    {'G', tenths(94), feed_mode, "", every | siemens, {}},
    {'G', tenths(95), feed_mode, "", mills | siemens, {}},
    {'G', tenths(96), spindle_mode, "D", mills | siemens, {}},
    {'G', tenths(97), spindle_mode, "", mills | siemens, {}},
    {'G', tenths(98), retract, "", mills, {}},
    {'G', tenths(99), retract, "", mills, {}},
    {'G', tenths(100), mirror, "XYZ", haas, {}},
    {'G', tenths(101), mirror, "XYZ", haas, {}},
    {'G', tenths(103), other, "P", haas, {}},
    {'G', tenths(110), work_offset, "", haas, {}},
    {'G', tenths(110), action, "XYZ", siemens, {}},
    {'G', tenths(111), work_offset, "", haas, {}},
    {'G', tenths(111), action, "XYZ", siemens, {}},
    {'G', tenths(112), work_offset, "", haas, {}},
    {'G', tenths(112), action, "XYZ", siemens, {}},
    {'G', tenths(113), work_offset, "", haas, {}},
    {'G', tenths(114), work_offset, "", haas, {}},
    {'G', tenths(115), work_offset, "", haas, {}},
    {'G', tenths(116), work_offset, "", haas, {}},
    {'G', tenths(117), work_offset, "", haas, {}},
    {'G', tenths(118), work_offset, "", haas, {}},
    {'G', tenths(119), work_offset, "", haas, {}},
    {'G', tenths(120), work_offset, "", haas, {}},
    {'G', tenths(121), work_offset, "", haas, {}},
    {'G', tenths(122), work_offset, "", haas, {}},
    {'G', tenths(123), work_offset, "", haas, {}},
    {'G', tenths(124), work_offset, "", haas, {}},
    {'G', tenths(125), work_offset, "", haas, {}},
    {'G', tenths(126), work_offset, "", haas, {}},
    {'G', tenths(127), work_offset, "", haas, {}},
    {'G', tenths(128), work_offset, "", haas, {}},
    {'G', tenths(129), work_offset, "", haas, {}},
    {'G', tenths(140), other, "", siemens, {}, tenths(143)},
    {'G', tenths(147), motion, "XYZ", siemens, no_smooth_approach},
    {'G', tenths(148), motion, "XYZ", siemens, no_smooth_approach},
    {'G', tenths(150), action, "XYZPIJKQRDS", haas, no_pocket},
    {'G', tenths(153), action, "XYZ", siemens, {}},
    {'G', tenths(154), work_offset, "P", haas, {}},
    {'G', tenths(187), other, "PE", haas, {}},
    {'G', tenths(247), motion, "XYZ", siemens, no_smooth_approach},
    {'G', tenths(248), motion, "XYZ", siemens, no_smooth_approach},
    {'G', tenths(290), other, "", both_siemens, {}},
    {'G', tenths(291), other, "", both_siemens, {}},
    {'G', tenths(331), motion, "XYZIJK", siemens, {}},
    {'G', tenths(332), motion, "XYZIJK", siemens, {}},
    {'G', tenths(340), other, "", siemens, {}, tenths(341)},
    {'G', tenths(347), motion, "XYZ", siemens, no_smooth_approach},
    {'G', tenths(348), motion, "XYZ", siemens, no_smooth_approach},
    {'G', tenths(450), other, "", siemens, {}, tenths(451)},
    {'G', tenths(460), other, "", siemens, {}, tenths(462)},
    {'G', tenths(500), work_offset, "", siemens, {}},
    {'G', tenths(505), work_offset, "", siemens, {}, tenths(599)},
    {'G', tenths(601), other, "", siemens, {}, tenths(603)},
    {'G', tenths(621), other, "", siemens, {}},
    {'G', tenths(641), path_control, "", siemens, {}, tenths(645)},
    {'G', tenths(700), units, "", siemens, {}},
    {'G', tenths(710), units, "", siemens, {}},
    {'G', tenths(751), action, "XYZ", siemens, no_point_between},
    {'G', tenths(810), other, "", siemens, {}, tenths(819)},
    {'G', tenths(931), feed_mode, "", siemens, no_path_time},
    {'G', tenths(942), feed_mode, "", siemens, {}},
    {'G', tenths(952), feed_mode, "", siemens, {}},
    {'G', tenths(961), spindle_mode, "", siemens, {}},
    {'G', tenths(962), spindle_mode, "", siemens, {}},
    {'G', tenths(971), spindle_mode, "", siemens, {}},
    {'G', tenths(972), spindle_mode, "", siemens, {}},
    {'G', tenths(973), spindle_mode, "", siemens, {}},
    {'M', tenths(0), stopping, "", every | klartext | siemens, {}},
    {'M', tenths(1), stopping, "", every | klartext | siemens, {}},
    {'M', tenths(2), stopping, "", every | klartext | siemens, {}},
    {'M', tenths(3), spindle, "", every | klartext | siemens, {}},
    {'M', tenths(4), spindle, "", every | klartext | siemens, {}},
    {'M', tenths(5), spindle, "", every | klartext | siemens, {}},
    {'M', tenths(6), tool_change, "", every | klartext | siemens, {}},
    {'M', tenths(7), coolant, "", every | klartext | siemens, {}},
    {'M', tenths(8), coolant, "", every | klartext | siemens, {}},
    {'M', tenths(9), coolant, "", every | klartext | siemens, {}},
    {'M', tenths(16), tool_change, "", haas, no_other_change},
    {'M', tenths(17), subprogram, "", siemens, {}},
    {'M', tenths(19), spindle, "RQPD", mills | siemens, {}},
    {'M', tenths(29), other, "", bit(DialectId::fanuc) | bit(DialectId::siemens_iso), {}},
    {'M', tenths(30), stopping, "", every | klartext | siemens, {}},
    {'M', tenths(40), other, "", siemens, {}, tenths(45)},
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
    {'M', tenths(70), other, "", siemens, {}},
    {'M', tenths(71), other, "", linuxcnc, {}},
    {'M', tenths(72), other, "", linuxcnc, {}},
    {'M', tenths(73), other, "", linuxcnc, {}},
    {'M', tenths(90), other, "", klartext, {}},
    {'M', tenths(92), other, "", klartext, no_machine_point},
    {'M', tenths(94), other, "", klartext, {}},
    {'M', tenths(96), subprogram, "PQ", haas, {}},
    {'M', tenths(97), subprogram, "PL", haas, {}},
    {'M', tenths(98), subprogram, "PLQ", mills, {}},
    {'M', tenths(99), subprogram, "P", mills, {}},
    {'M', tenths(101), other, "", klartext, {}},
    {'M', tenths(102), other, "", klartext, {}},
    {'M', tenths(103), other, "", klartext, {}},
    {'M', tenths(107), other, "", klartext, {}},
    {'M', tenths(108), other, "", klartext, {}},
    {'M', tenths(109), other, "", klartext, {}},
    {'M', tenths(110), other, "", klartext, {}},
    {'M', tenths(111), other, "", klartext, {}},
    {'M', tenths(112), other, "", klartext, {}},
    {'M', tenths(113), other, "", klartext, {}},
    {'M', tenths(114), other, "", klartext, no_five_axes},
    {'M', tenths(115), other, "", klartext, no_five_axes},
    {'M', tenths(116), other, "", klartext, {}},
    {'M', tenths(117), other, "", klartext, {}},
    {'M', tenths(118), other, "", klartext, {}},
    {'M', tenths(120), other, "", klartext, {}},
    {'M', tenths(124), other, "", klartext, {}},
    {'M', tenths(126), other, "", klartext, {}},
    {'M', tenths(127), other, "", klartext, {}},
    {'M', tenths(128), other, "", klartext, {}},
    {'M', tenths(129), other, "", klartext, {}},
    {'M', tenths(130), other, "", klartext, no_five_axes},
    {'M', tenths(134), other, "", klartext, {}},
    {'M', tenths(135), other, "", klartext, {}},
    {'M', tenths(136), other, "", klartext, no_turn_feed},
    {'M', tenths(137), other, "", klartext, {}},
    {'M', tenths(138), other, "", klartext, {}},
    {'M', tenths(140), other, "", klartext, no_retreat},
    {'M', tenths(141), other, "", klartext, {}},
    {'M', tenths(143), other, "", klartext, {}},
    {'M', tenths(144), other, "", klartext, no_five_axes},
    {'M', tenths(145), other, "", klartext, {}},
    {'M', tenths(148), other, "", klartext, {}},
    {'M', tenths(149), other, "", klartext, {}},
    {'M', tenths(198), subprogram, "PLQ", fanuc, {}},
};

constexpr bool before(const Code& a, const Code& b) {
    return a.letter != b.letter ? a.letter < b.letter : a.tenths < b.tenths;
}
static_assert(std::is_sorted(std::begin(codes), std::end(codes), before));

/// For each code in tenths, the index of its first row in the table, counted from 1; 0: unknown
/// code.
struct Positions {
    static constexpr int most = 10000;
    std::array<uint16_t, most> g{}, m{};
};

constexpr Positions positions = [] {
    Positions found;
    for (size_t i = std::size(codes); i-- > 0;)
        for (int code = codes[i].tenths; code <= codes[i].last_tenths(); code += 10)
            (codes[i].letter == 'G' ? found.g : found.m)[static_cast<size_t>(code)] =
                static_cast<uint16_t>(i + 1);
    return found;
}();

} // namespace

const Code* find_code(char letter, double value, DialectId id) {
    const double scaled = value * 10.0;
    if (!(scaled > -0.5 && scaled < Positions::most - 0.5)) return nullptr;
    const auto rounded = static_cast<int>(scaled + 0.5);
    if (std::abs(scaled - rounded) > 1e-6) return nullptr;
    const auto& by_tenths = letter == 'G' ? positions.g : positions.m;
    const uint16_t place = by_tenths[static_cast<size_t>(rounded)];
    if (place == 0) return nullptr;
    // A code that has different meanings on different controls has adjacent rows, one for each.
    const Code* found = &codes[place - 1];
    for (; found != std::end(codes) && found->letter == letter && found->tenths <= rounded; ++found)
        if ((found->dialects & bit(id)) && rounded <= found->last_tenths()) return found;
    return nullptr;
}

} // namespace gcode
