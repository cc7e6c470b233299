#include "gcode/language/codes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gcode {
namespace {

using enum ModalGroup;

constexpr DialectSet bit(DialectId id) { return static_cast<DialectSet>(1u << unsigned(id)); }

// Of the dialects that have codes of their own; others share the codes of one of these.
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

constexpr std::string_view no_cylinder =
    "cylindrical interpolation is not supported yet: program the rotary axis itself";
constexpr std::string_view no_polar_turning =
    "polar coordinate interpolation with a rotary axis is not supported yet: program X, Y and the "
    "rotary axis themselves";
constexpr std::string_view no_length_measurement =
    "the tool moves until a probe answers, and only the control knows where: measure tools in a "
    "program of their own, or begin the block with / and skip it";
constexpr std::string_view no_changing_radius =
    "compensation along I, J and K is not supported yet: program the path of the tool centre";
constexpr std::string_view no_five_axis_length =
    "compensation of the tool length along a tilted tool is not supported yet: use G43.4 or G234, "
    "or program the positions of the axes";
constexpr std::string_view no_five_axis_cycle =
    "cycles along a tilted tool are not supported yet: program the holes with G0 and G1";

constexpr std::string_view no_slanted_axis = "grinding with a slanted axis is not supported";
constexpr std::string_view no_changing_pitch = "threads with variable pitch are not supported yet";
constexpr std::string_view no_axis_offset =
    "the programmable offset of single axes is not supported yet: use ATRANS";
constexpr std::string_view no_point_between =
    "a fixed-point approach through an intermediate point is not supported yet: program a move, "
    "then G75";
constexpr std::string_view no_path_time =
    "a feed given as travel time is not supported yet: use G94";

constexpr std::string_view no_transitions =
    "the transitions that it inserts between contour elements are not supported: use RND";

constexpr std::string_view no_builders_code =
    "the effect of this code depends on the machine builder and is not known";

constexpr std::string_view no_five_axes = "moves of rotary axes are not supported yet";

constexpr std::string_view no_last_preset =
    "the preset that was set last is not known: activate it with CYCL DEF 247";
constexpr std::string_view no_machine_point = "the machine builder's datum is unknown: use M91";

constexpr std::string_view no_turn_feed =
    "feed per revolution is not supported yet: program F in mm/min";

constexpr std::string_view no_retreat =
    "a retract along the tool axis is not supported yet: program it as L with M91";

// Sorted by letter and number. The groups are those of NISTIR 6556, table 4, where it has them.
// Codes of the group `other` with a remark switch accessories: they move no axis and set nothing
// that a later block depends on.
constexpr Code codes[] = {
    {g_code(0), motion, "XYZ", every | siemens, {}},
    {g_code(1), motion, "XYZ", every | siemens, {}},
    {g_code(2), motion, "XYZIJKRP", mills | siemens, {}},
    {g_code(2), motion, "XYZIJKR", grbl, {}},
    {g_code(3), motion, "XYZIJKRP", mills | siemens, {}},
    {g_code(3), motion, "XYZIJKR", grbl, {}},
    {g_code(4), action, "PXU", every | siemens, {}},
    {g_code(5), motion, "XYZIJPQ", linuxcnc, {}},
    {g_code(5), other, "PR", fanuc, {}},
    {g_code(5), other, "", siemens, no_slanted_axis},
    {g_code(5, 1), motion, "XYZIJ", linuxcnc, {}},
    {g_code(5, 1), other, "XYZPQRL", fanuc, {}},
    {g_code(5, 2), motion, "XYZPL", linuxcnc, {}},
    {g_code(5, 3), motion, "XYZ", linuxcnc, {}},
    {g_code(7), diameter, "", linuxcnc, {}},
    {g_code(7), motion, "", siemens, no_slanted_axis},
    {g_code(7, 1), other, "", fanuc & ~haas, no_cylinder},
    {g_code(8), diameter, "", linuxcnc, {}},
    {g_code(8), other, "P", fanuc, {}},
    {g_code(9), exact_stop, "", fanuc, {}},
    {g_code(9), exact_stop, "", siemens, {}},
    {g_code(10), action, "XYZPLRQIJH", mills, {}},
    {g_code(10), action, "XYZPLR", grbl, {}},
    {g_code(11), action, "", fanuc, {}},
    {g_code(12), action, "XYZIJKQDL", haas, {}},
    {g_code(12, 1), other, "", fanuc & ~haas, no_polar_turning},
    {g_code(13), action, "XYZIJKQDL", haas, {}},
    {g_code(13, 1), other, "", fanuc & ~haas, {}},
    {g_code(15), polar, "", fanuc, {}},
    {g_code(16), polar, "", fanuc, {}},
    {g_code(17), ModalGroup::plane, "", every | klartext | siemens, {}},
    {g_code(17, 1), ModalGroup::plane, "", linuxcnc, {}},
    {g_code(18), ModalGroup::plane, "", every | klartext | siemens, {}},
    {g_code(18, 1), ModalGroup::plane, "", linuxcnc, {}},
    {g_code(19), ModalGroup::plane, "", every | klartext | siemens, {}},
    {g_code(19, 1), ModalGroup::plane, "", linuxcnc, {}},
    {g_code(20), units, "", every | klartext, {}},
    {g_code(21), units, "", every | klartext, {}},
    {g_code(22), action, "XYZIJK", fanuc & ~haas, {}},
    {g_code(23), other, "", fanuc & ~haas, {}},
    {g_code(25), other, "", fanuc & ~haas, {}},
    {g_code(25), action, "XYZ", siemens, {}},
    {g_code(26), other, "PQRI", fanuc & ~haas, {}},
    {g_code(26), action, "XYZ", siemens, {}},
    {g_code(27), action, "XYZ", fanuc, {}},
    {g_code(28), action, "XYZ", every, {}},
    {g_code(28, 1), action, "", linuxcnc | grbl, {}},
    {g_code(29), action, "XYZ", fanuc, {}},
    {g_code(30), action, "XYZ", every, {}},
    {g_code(30, 1), action, "", linuxcnc | grbl, {}},
    {g_code(31), action, "XYZPQ", fanuc, {}},
    {g_code(33), motion, "XYZK", linuxcnc | siemens, {}},
    {g_code(33, 1), motion, "XYZK", linuxcnc, {}},
    {g_code(34), motion, "XYZIJK", siemens, no_changing_pitch},
    {g_code(35), motion, "XYZIJK", siemens, no_changing_pitch},
    {g_code(35), motion, "XYZIJK", fanuc & ~haas, no_changing_pitch},
    {g_code(35), action, "XYZD", haas, {}},
    {g_code(36), action, "XYZIJK", haas, {}},
    {g_code(36), action, "XYZ", fanuc & ~haas, no_length_measurement},
    {g_code(37), action, "XYZH", fanuc, no_length_measurement},
    {g_code(38, 2), motion, "XYZ", linuxcnc | grbl, {}},
    {g_code(38, 3), motion, "XYZ", linuxcnc | grbl, {}},
    {g_code(38, 4), motion, "XYZ", linuxcnc | grbl, {}},
    {g_code(38, 5), motion, "XYZ", linuxcnc | grbl, {}},
    {g_code(40), cutter_radius, "", every | siemens, {}},
    {g_code(40, 1), other, "", fanuc & ~haas, {}},
    {g_code(41), cutter_radius, "D", mills | siemens, {}},
    {g_code(41, 1), cutter_radius, "DL", linuxcnc, {}},
    {g_code(42), cutter_radius, "D", mills | siemens, {}},
    {g_code(42, 1), cutter_radius, "DL", linuxcnc, {}},
    {g_code(43), tool_length, "H", mills, {}},
    {g_code(43, 1), tool_length, "XYZ", linuxcnc | grbl, {}},
    {g_code(43, 2), tool_length, "HXYZ", linuxcnc, {}},
    {g_code(43, 4), tool_length, "HPQR", fanuc, {}},
    {g_code(43, 5), tool_length, "HIJKQ", fanuc, {}},
    {g_code(44), tool_length, "H", fanuc, {}},
    {g_code(47), action, "XYZPEIJR", haas, no_engraving},
    {g_code(49), tool_length, "", mills, {}},
    {g_code(49), tool_length, "XYZ", grbl, {}}, // takes them, and moves nothing
    {g_code(50), scaling, "", fanuc, {}},
    {g_code(50, 1), mirror, "XYZ", fanuc, {}},
    {g_code(51), scaling, "XYZPIJK", fanuc, {}},
    {g_code(51, 1), mirror, "XYZ", fanuc, {}},
    {g_code(52), action, "XYZ", mills, {}},
    {g_code(53), action, "XYZ", every | klartext | siemens, {}},
    {g_code(53, 1), other, "PR", fanuc, {}},
    {g_code(53, 6), other, "HPR", fanuc, {}},
    {g_code(54), work_offset, "", every | siemens, {}},
    {g_code(54, 1), work_offset, "P", fanuc, {}},
    {g_code(54, 4), other, "P", fanuc & ~haas, {}},
    {g_code(55), work_offset, "", every | siemens, {}},
    {g_code(56), work_offset, "", every | siemens, {}},
    {g_code(57), work_offset, "", every | siemens, {}},
    {g_code(58), work_offset, "", every, {}},
    {g_code(58), action, "XYZ", siemens, no_axis_offset},
    {g_code(59), work_offset, "", every, {}},
    {g_code(59), action, "XYZ", siemens, no_axis_offset},
    {g_code(59, 1), work_offset, "", linuxcnc, {}},
    {g_code(59, 2), work_offset, "", linuxcnc, {}},
    {g_code(59, 3), work_offset, "", linuxcnc, {}},
    {g_code(60), action, "XYZ", fanuc, {}},
    {g_code(60), path_control, "", siemens, {}},
    {g_code(61), path_control, "", every, {}},
    {g_code(61, 1), path_control, "", mills, {}},
    {g_code(62), path_control, "", fanuc, {}},
    {g_code(62), other, "", siemens, {}},
    {g_code(63), path_control, "", fanuc, {}},
    {g_code(63), motion, "XYZ", siemens, {}},
    {g_code(64), path_control, "PQ", mills | siemens, {}},
    {g_code(65), macro, "", fanuc, {}},
    {g_code(66), macro, "", fanuc, {}},
    {g_code(66, 1), macro, "", fanuc, {}},
    {g_code(67), macro, "", fanuc, {}},
    {g_code(68), rotation, "XYZRIJK", fanuc, {}},
    {g_code(68, 2), rotation, "XYZIJKPQR", fanuc, {}},
    {g_code(68, 3), rotation, "XYZR", fanuc, {}},
    {g_code(68, 4), rotation, "XYZIJKPQR", fanuc, {}},
    {g_code(69), rotation, "", fanuc, {}},
    {g_code(70), motion, "XYZQDEP", linuxcnc, {}},
    {g_code(70), action, "XYZIJL", haas, {}},
    {g_code(70), units, "", siemens, {}},
    {g_code(71), motion, "XYZQDIR", linuxcnc, {}},
    {g_code(71), action, "XYZIJKL", haas, {}},
    {g_code(71), units, "", siemens, {}},
    {g_code(71, 1), motion, "XYZQDIR", linuxcnc, {}},
    {g_code(71, 2), motion, "XYZQDIR", linuxcnc, {}},
    {g_code(72), motion, "XYZQDIR", linuxcnc, {}},
    {g_code(72), action, "XYZIJL", haas, {}},
    {g_code(72, 1), motion, "XYZQDIR", linuxcnc, {}},
    {g_code(72, 2), motion, "XYZQDIR", linuxcnc, {}},
    {g_code(73), cycle, "XYZRQL", linuxcnc, {}},
    {g_code(73), cycle, "XYZRQLPK", fanuc & ~haas, {}},
    {g_code(73), cycle, "XYZRQLPIJK", haas, {}},
    {g_code(74), cycle, "XYZRLP", linuxcnc, {}},
    {g_code(74), cycle, "XYZRQLPKJ", fanuc, {}},
    {g_code(74), action, "XYZ", siemens, {}},
    {g_code(75), action, "XYZ", siemens, {}},
    {g_code(76), cycle, "XYZRQLPIJKHE", linuxcnc, {}},
    {g_code(76), cycle, "XYZRQLPIJK", fanuc, {}},
    {g_code(77), cycle, "XYZRQLPIJ", haas, {}},
    {g_code(80), cycle, "", every, {}},
    {g_code(81), cycle, "XYZRL", linuxcnc, {}},
    {g_code(81), cycle, "XYZRLK", fanuc, {}},
    {g_code(82), cycle, "XYZRLP", linuxcnc, {}},
    {g_code(82), cycle, "XYZRLPK", fanuc, {}},
    {g_code(83), cycle, "XYZRLQ", linuxcnc, {}},
    {g_code(83), cycle, "XYZRLQPK", fanuc & ~haas, {}},
    {g_code(83), cycle, "XYZRLQPIJK", haas, {}},
    {g_code(84), cycle, "XYZRLP", linuxcnc, {}},
    {g_code(84), cycle, "XYZRLPQKJ", fanuc, {}},
    {g_code(85), cycle, "XYZRL", linuxcnc, {}},
    {g_code(85), cycle, "XYZRLK", fanuc, {}},
    {g_code(86), cycle, "XYZRLP", linuxcnc, {}},
    {g_code(86), cycle, "XYZRLPK", fanuc, {}},
    {g_code(87), cycle, "XYZRLIJK", linuxcnc, {}},
    {g_code(87), cycle, "XYZRLPIJKQ", fanuc, {}},
    {g_code(88), cycle, "XYZRLP", linuxcnc, {}},
    {g_code(88), cycle, "XYZRLPK", fanuc, {}},
    {g_code(89), cycle, "XYZRLP", linuxcnc, {}},
    {g_code(89), cycle, "XYZRLPK", fanuc, {}},
    {g_code(90), distance, "", every | siemens, {}},
    {g_code(90, 1), arc_distance, "", linuxcnc, {}},
    {g_code(91), distance, "", every | siemens, {}},
    {g_code(91, 1), arc_distance, "", linuxcnc | grbl, {}},
    {g_code(92), action, "XYZ", every, {}},
    {g_code(92, 1), action, "", linuxcnc | grbl, {}},
    {g_code(92, 1), action, "XYZ", fanuc, {}},
    {g_code(92, 2), action, "", linuxcnc, {}},
    {g_code(92, 3), action, "", linuxcnc, {}},
    {g_code(93), feed_mode, "", every | siemens, {}},
    {g_code(94), feed_mode, "", every | siemens, {}},
    {g_code(95), feed_mode, "", mills | siemens, {}},
    {g_code(96), spindle_mode, "D", mills | siemens, {}},
    {g_code(97), spindle_mode, "", mills | siemens, {}},
    {g_code(98), retract, "", mills, {}},
    {g_code(99), retract, "", mills, {}},
    {g_code(100), mirror, "XYZ", haas, {}},
    {g_code(101), mirror, "XYZ", haas, {}},
    {g_code(103), other, "P", haas, {}},
    {g_code(107), other, "XYZQR", fanuc, no_cylinder},
    {g_code(110), work_offset, "", haas, {}},
    {g_code(110), action, "XYZ", siemens, {}},
    {g_code(111), work_offset, "", haas, {}},
    {g_code(111), action, "XYZ", siemens, {}},
    {g_code(112), work_offset, "", haas, {}},
    {g_code(112), action, "XYZ", siemens, {}},
    {g_code(113), work_offset, "", haas, {}},
    {g_code(114), work_offset, "", haas, {}},
    {g_code(115), work_offset, "", haas, {}},
    {g_code(116), work_offset, "", haas, {}},
    {g_code(117), work_offset, "", haas, {}},
    {g_code(118), work_offset, "", haas, {}},
    {g_code(119), work_offset, "", haas, {}},
    {g_code(120), work_offset, "", haas, {}},
    {g_code(121), work_offset, "", haas, {}},
    {g_code(122), work_offset, "", haas, {}},
    {g_code(123), work_offset, "", haas, {}},
    {g_code(124), work_offset, "", haas, {}},
    {g_code(125), work_offset, "", haas, {}},
    {g_code(126), work_offset, "", haas, {}},
    {g_code(127), work_offset, "", haas, {}},
    {g_code(128), work_offset, "", haas, {}},
    {g_code(129), work_offset, "", haas, {}},
    {g_code(136), action, "XYZIJK", haas, {}},
    {g_code(140), other, "", siemens, {}, g_code(143)},
    {g_code(141), cutter_radius, "DIJK", haas, no_changing_radius},
    {g_code(143), tool_length, "H", haas, no_five_axis_length},
    {g_code(147), motion, "XYZ", siemens, no_smooth_approach},
    {g_code(148), motion, "XYZ", siemens, no_smooth_approach},
    {g_code(150), action, "XYZPIJKQRDS", haas, no_pocket},
    {g_code(153), action, "XYZ", siemens, {}},
    {g_code(153), action, "XYZ", haas, no_five_axis_cycle},
    {g_code(154), work_offset, "P", haas, {}},
    {g_code(155), action, "XYZ", haas, no_five_axis_cycle},
    {g_code(161), action, "XYZ", haas, no_five_axis_cycle, g_code(169)},
    {g_code(174), action, "XYZ", haas, {}},
    {g_code(184), action, "XYZ", haas, {}},
    {g_code(187), path_control, "PE", haas, {}},
    {g_code(234), tool_length, "H", haas, {}},
    {g_code(247), motion, "XYZ", siemens, no_smooth_approach},
    {g_code(248), motion, "XYZ", siemens, no_smooth_approach},
    {g_code(253), other, "", haas, {}},
    {g_code(254), rotation, "", haas, {}},
    {g_code(255), rotation, "", haas, {}},
    {g_code(268), rotation, "XYZIJKQ", haas, {}},
    {g_code(269), rotation, "", haas, {}},
    {g_code(290), other, "", both_siemens, {}},
    {g_code(291), other, "", both_siemens, {}},
    {g_code(331), motion, "XYZIJK", siemens, {}},
    {g_code(332), motion, "XYZIJK", siemens, {}},
    {g_code(340), other, "", siemens, {}, g_code(341)},
    {g_code(347), motion, "XYZ", siemens, no_smooth_approach},
    {g_code(348), motion, "XYZ", siemens, no_smooth_approach},
    {g_code(450), other, "", siemens, {}, g_code(451)},
    {g_code(460), other, "", siemens, {}, g_code(462)},
    {g_code(500), work_offset, "", siemens, {}},
    {g_code(505), work_offset, "", siemens, {}, g_code(599)},
    {g_code(601), other, "", siemens, {}, g_code(603)},
    {g_code(621), other, "", siemens, {}},
    {g_code(641), path_control, "", siemens, {}, g_code(645)},
    {g_code(700), units, "", siemens, {}},
    {g_code(710), units, "", siemens, {}},
    {g_code(751), action, "XYZ", siemens, no_point_between},
    {g_code(810), other, "", siemens, no_builders_code, g_code(819)},
    {g_code(931), feed_mode, "", siemens, no_path_time},
    {g_code(942), feed_mode, "", siemens, {}},
    {g_code(952), feed_mode, "", siemens, {}},
    {g_code(961), spindle_mode, "", siemens, {}},
    {g_code(962), spindle_mode, "", siemens, {}},
    {g_code(971), spindle_mode, "", siemens, {}},
    {g_code(972), spindle_mode, "", siemens, {}},
    {g_code(973), spindle_mode, "", siemens, {}},
    {m_code(0), stopping, "", every | klartext | siemens, {}},
    {m_code(1), stopping, "", every | klartext | siemens, {}},
    {m_code(2), stopping, "", every | klartext | siemens, {}},
    {m_code(3), spindle, "", every | klartext | siemens, {}},
    {m_code(4), spindle, "", every | klartext | siemens, {}},
    {m_code(5), spindle, "", every | klartext | siemens, {}},
    {m_code(6), tool_change, "", every | klartext | siemens, {}},
    {m_code(7), coolant, "", every | klartext | siemens, {}},
    {m_code(8), coolant, "", every | klartext | siemens, {}},
    {m_code(9), coolant, "", every | klartext | siemens, {}},
    {m_code(10), other, "", haas, {}, m_code(13)}, // brakes of rotary axes
    {m_code(16), tool_change, "", haas, no_other_change},
    {m_code(17), subprogram, "", siemens, {}},
    {m_code(19), spindle, "RQPD", mills | siemens, {}},
    {m_code(29), other, "", bit(DialectId::fanuc) | bit(DialectId::siemens_iso), {}},
    {m_code(30), stopping, "", every | klartext | siemens, {}},
    {m_code(31), other, "", haas, {}, m_code(33)}, // chip conveyor
    {m_code(34), other, "", haas, {}, m_code(35)}, // coolant spigot
    {m_code(40), other, "", siemens, {}, m_code(45)},
    {m_code(41), other, "", haas, {}, m_code(42)}, // spindle gear
    {m_code(46), other, "PQ", haas, no_jump},
    {m_code(48), overrides, "", mills, {}},
    {m_code(49), overrides, "", mills, {}},
    {m_code(50), overrides, "P", linuxcnc, {}},
    {m_code(50), other, "P", haas, no_pallet},
    {m_code(51), overrides, "P", linuxcnc, {}},
    {m_code(52), overrides, "P", linuxcnc, {}},
    {m_code(53), overrides, "P", linuxcnc, {}},
    {m_code(56), other, "P", grbl, {}}, // parking
    {m_code(59), other, "P", haas, {}}, // output on
    {m_code(60), stopping, "", linuxcnc, {}},
    {m_code(61), tool_change, "Q", linuxcnc, {}},
    {m_code(62), other, "P", linuxcnc, {}},
    {m_code(63), other, "P", linuxcnc, {}},
    {m_code(64), other, "P", linuxcnc, {}},
    {m_code(65), other, "P", linuxcnc, {}},
    {m_code(66), other, "PELQ", linuxcnc, {}},
    {m_code(67), other, "EQ", linuxcnc, {}},
    {m_code(68), other, "EQ", linuxcnc, {}},
    {m_code(69), other, "P", haas, {}}, // output off
    {m_code(70), other, "", linuxcnc, {}},
    {m_code(70), other, "", siemens, {}},
    {m_code(71), other, "", linuxcnc, {}},
    {m_code(72), other, "", linuxcnc, {}},
    {m_code(73), other, "", linuxcnc, {}},
    {m_code(73), other, "", haas, {}, m_code(74)}, // tabs of the control
    {m_code(75), other, "", haas, {}, m_code(79)}, // probing: reference point, skip signal; display
    {m_code(80), other, "", haas, {}, m_code(81)}, // door
    {m_code(83), other, "", haas, {}, m_code(84)}, // air
    {m_code(88), other, "", haas, {}, m_code(89)}, // coolant through the spindle
    {m_code(90), other, "", klartext, {}},
    {m_code(92), other, "", klartext, no_machine_point},
    {m_code(94), other, "", klartext, {}},
    {m_code(95), other, "", haas, {}}, // sleep
    {m_code(96), subprogram, "PQ", haas, {}},
    {m_code(97), subprogram, "PL", haas, {}},
    {m_code(98), subprogram, "PLQ", mills, {}},
    {m_code(99), subprogram, "P", mills, {}},
    {m_code(101), other, "", klartext, {}},
    {m_code(102), other, "", klartext, {}},
    {m_code(103), other, "", klartext, {}},
    {m_code(104), other, "", klartext, no_last_preset},
    {m_code(107), other, "", klartext, {}},
    {m_code(108), other, "", klartext, {}},
    {m_code(109), other, "", klartext, {}},
    {m_code(109), other, "P", haas, {}}, // interactive input
    {m_code(110), other, "", klartext, {}},
    {m_code(111), other, "", klartext, {}},
    {m_code(112), other, "", klartext, no_transitions},
    {m_code(113), other, "", klartext, {}},
    {m_code(114), other, "", klartext, no_five_axes},
    {m_code(115), other, "", klartext, no_five_axes},
    {m_code(116), other, "", klartext, {}},
    {m_code(117), other, "", klartext, {}},
    {m_code(118), other, "", klartext, {}},
    {m_code(120), other, "", klartext, {}},
    {m_code(124), other, "", klartext, {}},
    {m_code(126), other, "", klartext, {}},
    {m_code(127), other, "", klartext, {}},
    {m_code(128), other, "", klartext, {}},
    {m_code(129), other, "", klartext, {}},
    {m_code(130), other, "", klartext, no_five_axes},
    {m_code(130), other, "", haas, {}, m_code(131)}, // media display
    {m_code(134), other, "", klartext, {}},
    {m_code(135), other, "", klartext, {}},
    {m_code(136), other, "", klartext, no_turn_feed},
    {m_code(137), other, "", klartext, {}},
    {m_code(138), other, "", klartext, {}},
    {m_code(138), other, "PE", haas, {}, m_code(139)}, // variation of the spindle speed
    {m_code(140), other, "", klartext, no_retreat},
    {m_code(141), other, "", klartext, {}},
    {m_code(143), other, "", klartext, {}},
    {m_code(144), other, "", klartext, no_five_axes},
    {m_code(145), other, "", klartext, {}},
    {m_code(148), other, "", klartext, {}},
    {m_code(149), other, "", klartext, {}},
    {m_code(158), other, "", haas, {}, m_code(162)}, // mist condenser, minimum quantity lubrication
    {m_code(180), other, "", haas, {}, m_code(181)}, // window
    {m_code(198), subprogram, "PLQ", fanuc, {}},
};

constexpr bool before(const Code& a, const Code& b) { return a.number < b.number; }
static_assert(std::is_sorted(std::begin(codes), std::end(codes), before));

/// For each number, the index of its first row in the table, counted from 1; 0: unknown code.
constexpr std::array positions = [] {
    std::array<uint16_t, 2 * tenths_end> found{};
    for (size_t i = std::size(codes); i-- > 0;)
        for (int code = int(codes[i].number); code <= int(codes[i].last_number()); code += 10)
            found[static_cast<size_t>(code)] = static_cast<uint16_t>(i + 1);
    return found;
}();

} // namespace

const Code* find_code(CodeNumber number, DialectId id) {
    const uint16_t position = positions[static_cast<size_t>(number)];
    if (position == 0) return nullptr;
    const DialectSet wanted = bit(dialect(id).codes);
    // A code that has different meanings on different controls has adjacent rows, one for each.
    const Code* found = &codes[position - 1];
    for (; found != std::end(codes) && found->number <= number; ++found)
        if ((found->dialects & wanted) && number <= found->last_number()) return found;
    return nullptr;
}

bool has_lathe_codes(DialectId id) {
    const Code* code = find_code(g_code(7), id);
    return code && code->group == ModalGroup::diameter;
}

const Code* find_code(char letter, double value, DialectId id) {
    const double scaled = value * 10.0;
    if (!(scaled > -0.5 && scaled < tenths_end - 0.5)) return nullptr;
    const auto rounded = static_cast<int>(scaled + 0.5);
    if (std::abs(scaled - rounded) > 1e-6) return nullptr;
    return find_code(code_of(letter, rounded), id);
}

} // namespace gcode
