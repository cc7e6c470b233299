#include "gcode/language/control.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"

namespace gcode {
namespace {

using enum ControlQuestion;
using enum IfNotStated;

constexpr DialectId fanuc[] = {DialectId::fanuc};
constexpr DialectId haas[] = {DialectId::haas};
constexpr DialectId linuxcnc[] = {DialectId::linuxcnc};
constexpr DialectId rs274[] = {DialectId::linuxcnc, DialectId::grbl};
constexpr DialectId klartext[] = {DialectId::heidenhain};
constexpr DialectId siemens[] = {DialectId::siemens};
constexpr DialectId with_block_delete[] = {DialectId::linuxcnc,   DialectId::fanuc,
                                           DialectId::haas,       DialectId::siemens,
                                           DialectId::heidenhain, DialectId::siemens_iso};

// The first value of each parameter is the one assumed if nothing is stated.

constexpr ParameterValue length_change[] = {
    {1, false, "Z stays until it is programmed"},
    {0, true, "a block with G43, G44, G49 or H and no Z moves Z by the change of the offset"},
};
constexpr ParameterValue decimal_point[] = {
    {1, true, "a number without a decimal point is in mm, inches or degrees"},
    {0, false, "a number without a decimal point counts least increments: 0.001 mm, 0.0001 inch"},
};
constexpr ParameterValue float_default[] = {
    {1, true, "a number without a decimal point is in mm, inches or degrees", "ON"},
    {0, false, "a number without a decimal point counts least increments: 0.001 mm, 0.0001 inch",
     "OFF"},
};
constexpr ParameterValue clears_variables[] = {
    {0, false, "a reset clears #100 to #149"},
    {1, true, "#100 to #149 keep the values of earlier programs"},
};
constexpr ParameterValue clears_locals[] = {
    {0, false, "a reset clears #1 to #33"},
    {1, true, "#1 to #33 keep the values of earlier programs"},
};
constexpr ParameterValue rapids[] = {
    {1, true, "rapids are straight"},
    {0, false, "each axis of a rapid runs at its own speed"},
};
constexpr ParameterValue rapid_modes[] = {
    {1, true, "rapids are straight", "LINEAR"},
    {0, false, "each axis of a rapid runs at its own speed", "NONE"},
};
constexpr ParameterValue block_delete[] = {
    {0, false, "blocks with / are executed"},
    {1, true, "blocks with / are skipped"},
};
constexpr ParameterValue inches[] = {
    {0, false, "lengths are in mm until G20"},
    {1, true, "lengths are in inches until G21"},
};
constexpr ParameterValue dimensioning[] = {
    {0, false, "lengths are in mm until G20", "MM"},
    {1, true, "lengths are in inches until G21", "INCH"},
};
constexpr ParameterValue ini_units[] = {
    {0, false, "lengths are in mm until G20", "mm"},
    {1, true, "lengths are in inches until G21", "inch"},
};
constexpr ParameterValue siemens_units[] = {
    {2, false, "G71 is active at the start"},
    {1, true, "G70 is active at the start"},
};
constexpr ParameterValue distance_modes[] = {
    {0, false, "G90 is active at the start"},
    {1, true, "G91 is active at the start"},
};
constexpr ParameterValue siemens_distance[] = {
    {1, false, "G90 is active at the start"},
    {2, true, "G91 is active at the start"},
};
constexpr ParameterValue motion_modes[] = {
    {0, false, "G0 is active at the start"},
    {1, true, "G1 is active at the start"},
};
constexpr ParameterValue zx_plane[] = {
    {0, 17, "G17 is active at the start"},
    {1, 18, "G18 is active at the start"},
};
constexpr ParameterValue yz_plane[] = {
    {0, false, "G17 or G18 is active at the start"},
    {1, true, "G19 is active at the start"},
};
constexpr ParameterValue siemens_plane[] = {
    {1, 17, "G17 is active at the start"},
    {2, 18, "G18 is active at the start"},
    {3, 19, "G19 is active at the start"},
};
constexpr ParameterValue siemens_work[] = {
    {2, false, "G54 is active at the start"},
    {1, true, "G500 is active at the start"},
};
constexpr ParameterValue clear_state[] = {
    {1, true, "a reset restores the initial G codes"},
    {0, false, "the G codes of the program before stay active"},
};
constexpr ParameterValue restores_codes[] = {
    {1, true, "M30 and reset restore the initial G codes", "ON"},
    {0, false, "the G codes of the program before stay active", "OFF"},
};
constexpr ParameterValue length_of_plane[] = {
    {0, false, "length offsets act along Z"},
    {1, true, "length offsets act along the axis normal to the plane"},
};
constexpr ParameterValue length_of_axis[] = {
    {0, false, "G43 and G44 do not choose the axis by a word in their block"},
    {1, true, "length offsets act along the axis that the block of G43 or G44 names"},
};
constexpr ParameterValue length_reload[] = {
    {0, false, "a length that G10 writes counts from the next G43, G44 or H"},
    {1, true, "a length that G10 writes counts from the next block"},
};
constexpr ParameterValue offset_memories[] = {
    {3, static_cast<double>(OffsetMemory::separate),
     "H and D have values of their own, each with a wear: #2001 and G10 L11 set the wear of H",
     "C"},
    {2, static_cast<double>(OffsetMemory::with_wear),
     "H and D have the same value and wear: #2001 and G10 L11 set the wear", "B"},
    {1, static_cast<double>(OffsetMemory::one_value),
     "H and D have the same value and no wear: #2001 and G10 L11 set the value", "A"},
};
constexpr ParameterValue offset_sizes[] = {
    {0, false, "sizes in the table of tool offsets are diameters", "DIAMETER"},
    {1, true, "sizes in the table of tool offsets are radii", "RADIUS"},
};
constexpr ParameterValue radius_sizes[] = {
    {0, true, "the values under D in the offset memory are radii"},
    {1, false, "the values under D in the offset memory are diameters"},
};
constexpr ParameterValue tool_change_motion[] = {{0, false, "M6 does not move the machine"}};
constexpr ParameterValue entry_types[] = {
    {0, false, "the tool goes straight to the first offset point and straight off the last one"},
    {1, true, "outside corners at the first and the last move are extended as on the contour"},
};
constexpr ParameterValue upright_entry[] = {
    {0, false, "G41, G42 or G40 without a move act with the next move"},
    {1, true, "G41, G42 or G40 without a move shift the tool at right angles to the next move"},
};
constexpr ParameterValue drilling_axis[] = {
    {1, true, "cycles drill along the axis normal to the plane"},
    {0, false, "cycles drill along Z"},
};
constexpr ParameterValue drilling_definition[] = {
    {1, true, "a block that defines a cycle drills, also without X and Y", "ON"},
    {0, false, "a block that defines a cycle drills only with X or Y", "OFF"},
};
constexpr ParameterValue one_mm[] = {{1, 1, "1 mm"}};
constexpr ParameterValue no_lift[] = {{0, 0, "none"}};
constexpr ParameterRange of_lengths{0.0, 1000.0, "mm"};
constexpr ParameterRange of_inches{0.0, 100.0, "inches"};
constexpr ParameterValue fanuc_shift[] = {
    {1, 1, "the tool shifts along +X, the first axis of the plane"},
    {-1, -1, "the tool shifts along -X"},
    {2, 2, "the tool shifts along +Y, the second axis of the plane"},
    {-2, -2, "the tool shifts along -Y"},
};
constexpr ParameterValue haas_shift[] = {
    {1, 1, "the tool shifts along +X, the first axis of the plane", "X+"},
    {-1, -1, "the tool shifts along -X", "X-"},
    {2, 2, "the tool shifts along +Y, the second axis of the plane", "Y+"},
    {-2, -2, "the tool shifts along -Y", "Y-"},
};
constexpr ParameterValue rotation_words[] = {
    {1, true, "under G91, R of G68 is added to the angle before"},
    {0, false, "R of G68 is absolute, also under G91"},
};
constexpr ParameterRange of_angles{-360.0, 360.0, "degrees"};
constexpr ParameterValue scale_steps[] = {
    {1, 0.001, "a factor of G51 without a decimal point counts thousandths"},
    {0, 0.00001, "a factor of G51 without a decimal point counts hundred-thousandths"},
};
constexpr ParameterRange of_factors{0.00001, 10000.0, "times"};
constexpr ParameterValue coordinate_system[] = {
    {1, false, "G52 shifts all work offsets", "FANUC"},
    {2, false, "G52 shifts all work offsets", "HAAS"},
    {3, true, "G52 is a work offset of its own", "YASNAC"},
};
constexpr ParameterValue finer[] = {
    {0, false, "the least increment is 0.001 mm, 0.0001 inch or 0.001 degrees, IS-B"},
    {1, true, "the least increment is 0.0001 mm, 0.00001 inch or 0.0001 degrees, IS-C"},
};
constexpr ParameterValue coarser[] = {
    {0, false, "the least increment is not 0.01 mm"},
    {1, true, "the least increment is 0.01 mm, 0.001 inch or 0.01 degrees, IS-A"},
};
constexpr ParameterValue one_way[] = {
    {0, false, "G60 acts in its block only"},
    {1, true, "G60 stays active until G0, G1, G2 or G3"},
};

constexpr ParameterValue retract_modes[] = {
    {0, false, "G98 is active at the start"},
    {1, true, "G99 is active at the start"},
};
constexpr ParameterValue scaled_z[] = {
    {1, true, "G51 scales Z, too"},
    {0, false, "G51 does not scale Z"},
};
constexpr ParameterValue incremental_blocks[] = {
    {0, false, "G91 stays active until G90", "OFF"},
    {1, true, "G91 acts in its block only", "ON"},
};
constexpr ParameterValue rotation_of_haas[] = {
    {0, false, "R of G68 is absolute, also under G91", "OFF"},
    {1, true, "under G91, R of G68 is added to the angle before", "ON"},
};
constexpr ParameterValue not_mirrored[] = {
    {0, false, "the axis is not mirrored; a mirror image by a setting is not supported", "OFF"},
};
constexpr ParameterValue haas_entry[] = {
    {0, false, "type A; type B is not supported", "A"},
};
constexpr ParameterValue haas_contour[] = {
    {0, false, "as on Fanuc; YASNAC is not supported", "FANUC"},
};
constexpr ParameterValue lone_arcs[] = {
    {1, false, "G2 and G3 without I, J, K and R are an alarm"},
    {0, true, "G2 and G3 without I, J, K and R go straight"},
};
constexpr ParameterValue tools_of_m6[] = {
    {1, false, "M6 takes the tool of the T in its block", "block"},
    {2, true, "M6 takes the tool of an earlier T, and T in its block is for the next M6",
     "waiting"},
};
constexpr ParameterValue roll_over[] = {
    {0, false, "a rotary axis goes straight from angle to angle, also over several turns"},
    {1, true, "positions of a rotary axis count within a turn"},
};
constexpr ParameterValue rotary_directions[] = {
    {0, false, "a rotary axis goes the shorter way to a position"},
    {1, true, "the sign of a position of a rotary axis is the direction in which it turns"},
};
constexpr ParameterValue half_turns[] = {
    {0, false, "half a turn of a rotary axis goes in the positive direction"},
    {1, true, "half a turn of a rotary axis goes in the negative direction"},
};
constexpr ParameterValue meanings_of_m428[] = {
    {1, true, "M428 switches to tool centre point control, and M429 back", "TCP"},
    {0, false, "M428 switches tool centre point control off, and M429 on", "identity"},
};
constexpr ParameterValue signs_of_p1[] = {
    {1, true, "G53.1 P1 tilts in the positive direction, and P2 in the negative one", "positive"},
    {0, false, "G53.1 P1 tilts in the negative direction, and P2 in the positive one", "negative"},
};
constexpr ParameterRange of_blocks{3.0, 8.0, "blocks"};

constexpr std::string_view program_g90 = "Program G90 before the first move.";
// Siemens. Native programs and those in ISO mode run on the same control.
constexpr ParameterValue siemens_length_change[] = {
    {0, false, "Z stays until it is programmed"},
    {1, true, "a block with G43, G44, G49 or H and no Z moves Z by the change of the offset"},
};
constexpr ParameterValue meanings_of_angle_codes[] = {
    {1, true, "ORIEULER and ORIRPY say what A2, B2 and C2 are"},
    {0, false, "MD21100 says what A2, B2 and C2 are"},
};
constexpr ParameterValue kinds_of_angles[] = {
    {1, true, "A2, B2 and C2 are Euler angles"},
    {0, false, "A2, B2 and C2 are RPY angles"},
};
constexpr ParameterValue axes_of_tool_frame[] = {
    {2001, static_cast<double>(ToolFrameAxes::x_in_zx), "X of TOROT stays in the old ZX plane"},
    {2002, static_cast<double>(ToolFrameAxes::y_in_yz), "Y of TOROT stays in the old YZ plane"},
    {2000, static_cast<double>(ToolFrameAxes::between),
     "X of TOROT is as far from the old ZX plane as Y is from the old YZ plane"},
    {0, static_cast<double>(ToolFrameAxes::of_machine),
     "X and Y of TOROT are those of the machine (MD21110 is 0)"},
};
constexpr ParameterValue machine_coordinates[] = {
    {0, true, "G53, G153 and SUPA move the tip of the tool to machine coordinates"},
    {1, false, "G53, G153 and SUPA move the gauge line to machine coordinates"},
};
constexpr ParameterValue length_in_planes[] = {
    {17, true, "the tool length stays along Z in each plane"},
    {0, false, "the tool length is along the axis normal to the plane"},
};
constexpr ParameterValue edge_of_change[] = {
    {1, true, "a tool change without D activates the length of the first cutting edge"},
    {0, false, "after a tool change without D no length is active"},
};
constexpr ParameterValue offset_in_increments[] = {
    {1, true, "incremental words also travel a change of the zero offset"},
    {0, false, "incremental words travel the programmed distance only"},
};
constexpr ParameterValue length_in_increments[] = {
    {1, true, "incremental words also travel a change of the tool length"},
    {0, false, "incremental words travel the programmed distance only"},
};
constexpr ParameterValue tool_change_modes[] = {
    {0, true, "T changes the tool"},
    {1, false, "M6 changes the tool, and T selects the next one"},
};
constexpr ParameterValue outside_corners[] = {
    {1, false, "G450 is active at the start"},
    {2, true, "G451 is active at the start"},
};
constexpr ParameterValue hundred_degrees[] = {{100, 100, "100 degrees"}};
constexpr ParameterRange of_corners{0.0, 180.0, "degrees"};
constexpr ParameterValue turning_groups[] = {
    {0, false, "ORIMKS and ORIWKS choose how the tool turns"},
    {1, true, "ORIAXES and ORIVECT choose how the tool turns"},
};
constexpr ParameterValue turning_of_axes[] = {
    {1, true, "where vectors turn the tool in a plane, positions of rotary axes do so, too",
     "plane"},
    {0, false, "each rotary axis turns evenly to a programmed position", "axes"},
};
constexpr ParameterValue vertical_axes[] = {
    {3, 3, "X of a plane of G68.3 is at right angles to Z"},
    {1, 1, "X of a plane of G68.3 is at right angles to X"},
    {2, 2, "X of a plane of G68.3 is at right angles to Y"},
    {0, 3, "X of a plane of G68.3 is at right angles to the axis of the upright tool, Z"},
};
constexpr ParameterValue motor_of_w[] = {
    {1, true, "the other axes move the tip along the tool by W", "no motor"},
};
constexpr ParameterValue one_degree[] = {
    {1, 1, "1 degree"},
};
constexpr ParameterValue two_degrees[] = {{2, 2, "2 degrees"}};
constexpr ParameterRange of_poles{0.0, 90.0, "degrees"};
constexpr ParameterValue frames_at_traori[] = {
    {1, true, "TRAORI and TRAFOOF keep the work offset"},
    {0, false, "TRAORI and TRAFOOF deselect the work offset, as G500"},
};
constexpr DialectId any_siemens[] = {DialectId::siemens, DialectId::siemens_iso};

constexpr ControlParameter parameters[] = {
    {length_change_moves, fanuc, "5006#6", "parameter 5006#6 (TOS)", length_change, follow_all,
     "Fanuc B-63943EN-1, 12.5.2, tool length compensation shift types"},
    {point_is_implied, fanuc, "3401#0", "parameter 3401#0 (DPI)", decimal_point, follow_all,
     "Fanuc B-63950EN, parameters of programs; B-63944EN, decimal point programming"},
    {point_is_implied, haas, "setting 162", "setting 162 (Default To Float)", float_default,
     follow_all, "Haas, Help with the decimal points; mill operator's manual, settings"},
    {variables_are_kept, fanuc, "6001#6", "parameter 6001#6 (CCV)", clears_variables, follow_all,
     "Fanuc B-63950EN, parameters of custom macros"},
    {locals_are_kept, fanuc, "6001#7", "parameter 6001#7 (CLV)", clears_locals, follow_all,
     "Fanuc B-63950EN, parameters of custom macros"},
    {rapids_are_straight, fanuc, "1401#1", "parameter 1401#1 (LRP)", rapids, follow_all,
     "Fanuc B-63950EN, parameters of feed rates; B-63944EN, positioning (G00)"},
    {rapids_are_straight, haas, "setting 335", "setting 335 (Linear Rapid Mode)", rapid_modes,
     follow_all, "Haas mill operator's manual, NGC, G00 and settings"},
    {point_is_implied, any_siemens, "MD10884", "MD10884 (EXTERN_FLOATINGPOINT_PROG)", decimal_point,
     follow_all, "SINUMERIK ISO Milling 04.07, 1.1.6, decimal point programming"},
    {length_keeps_axis, any_siemens, "SD42940", "SD42940 (TOOL_LENGTH_CONST)", length_in_planes,
     follow_all,
     "SINUMERIK ONE, NC programming 12/2019, 2.8.3; 3.13.3.4, tool length and plane change"},
    {change_selects_edge, any_siemens, "MD20270", "MD20270 (CUTTING_EDGE_DEFAULT)", edge_of_change,
     follow_all, "SINUMERIK 840D sl, Function Manual W1, 11/2006, selection of the cutting edge"},
    {machine_moves_tip, any_siemens, "MD10760", "MD10760 (G53_TOOLCORR)", machine_coordinates,
     follow_all, "SINUMERIK ISO Milling 04.07, 3.1.1, machine coordinates (G53)"},
    {length_change_moves, any_siemens, "MD20382", "MD20382 (TOOL_CORR_MOVE_MODE)",
     siemens_length_change, follow_all, "SINUMERIK ISO Milling 04.07, appendix D, machine data"},
    {increment_has_offset, any_siemens, "SD42440", "SD42440 (FRAME_OFFSET_INCR_PROG)",
     offset_in_increments, follow_all,
     "SINUMERIK 840D sl, Programming Manual Fundamentals, incremental dimensions (G91, IC)"},
    {increment_has_length, any_siemens, "SD42442", "SD42442 (TOOL_OFFSET_INCR_PROG)",
     length_in_increments, follow_all,
     "SINUMERIK 840D sl, Programming Manual Fundamentals, incremental dimensions (G91, IC)"},
    {tool_changes_with_t, siemens, "MD22550", "MD22550 (TOOL_CHANGE_MODE)", tool_change_modes,
     follow_all, "SINUMERIK 840D sl, Programming Manual Fundamentals, tool change without M6"},
    {corners_are_met, siemens, "MD20150[17]", "MD20150[17] (GCODE_RESET_VALUES)", outside_corners,
     follow_all, "Siemens 6FC5398-2EP40-0BA0, 4.3, G group 18"},
    {orientation_by_code, siemens, "MD21104", "MD21104 (ORI_IPO_WITH_G_CODE)", turning_groups,
     follow_all, "SINUMERIK 840D sl, Programming Manual Job Planning, ORIWKS and ORIMKS"},
    {axes_turn_in_plane, siemens, "ORIWKS",
     "how the tool turns to positions of rotary axes under ORIWKS and ORIVECT", turning_of_axes,
     follow_all, "SINUMERIK 840D sl, Programming Manual Job Planning, ORIWKS and ORIMKS"},
    {angles_by_code, siemens, "MD21102", "MD21102 (ORI_DEF_WITH_G_CODE)", meanings_of_angle_codes,
     follow_all,
     "SINUMERIK 840D sl, Programming Manual Job Planning, orientation angles (A2, B2, C2)"},
    {angles_are_euler, siemens, "MD21100", "MD21100 (ORIENTATION_IS_EULER)", kinds_of_angles,
     follow_all,
     "SINUMERIK 840D sl, Programming Manual Job Planning, orientation angles (A2, B2, C2)"},
    {tool_frame_axes, siemens, "SD42980", "SD42980 (TOFRAME_MODE)", axes_of_tool_frame, follow_all,
     "SINUMERIK 840D sl, Function Manual Basic Functions, K2: frame rotation in tool direction"},
    {pole_limit,
     siemens,
     "MD24530",
     "MD24530 (TRAFO5_NON_POLE_LIMIT)",
     two_degrees,
     assume,
     "SINUMERIK 840D sl, Function Manual Transformations, 5-axis transformation: singular "
     "positions",
     {},
     of_poles},
    {frame_survives_traori, siemens, "MD10602", "MD10602 (FRAME_GEOAX_CHANGE_MODE)",
     frames_at_traori, follow_all,
     "SINUMERIK 840D sl, Function Manual Basic Functions, K2: frames and transformations"},
    {corner_limit,
     siemens,
     "MD20210",
     "MD20210 (CUTCOM_CORNER_LIMIT)",
     hundred_degrees,
     assume,
     "SINUMERIK 840D sl, Programming Manual Fundamentals, compensation at outside corners (G451)",
     {},
     of_corners},
    {blocks_are_deleted,
     with_block_delete,
     {},
     "the switch for block delete",
     block_delete,
     follow_all,
     "ISO 6983-1, block delete",
     "State block_delete = false or true under [program] in the set-up."},

    {starts_in_inches, fanuc, "0#2", "parameter 0#2 (INI)", inches, follow_all,
     "Fanuc B-63950EN, parameters of setting"},
    {starts_in_inches, linuxcnc, "LINEAR_UNITS", "LINEAR_UNITS of the ini file", ini_units,
     follow_all, "LinuxCNC 2.9, INI configuration, [TRAJ]"},
    {starts_in_inches, haas, "setting 9", "setting 9 (Dimensioning)", dimensioning, follow_all,
     "Haas mill operator's manual 96-8000, settings"},
    {starts_in_inches, siemens, "MD20150[12]", "MD20150[12] (GCODE_RESET_VALUES)", siemens_units,
     follow_all, "Siemens 6FC5398-2EP40-0BA0, 4.3, G group 13"},
    {starts_incremental, fanuc, "3402#3", "parameter 3402#3 (G91)", distance_modes, follow_all,
     "Fanuc B-63950EN, parameters of programs"},
    {starts_incremental,
     haas,
     {},
     "whether an earlier program left G91",
     distance_modes,
     follow_all,
     "Haas mill operator's manual 96-8000, setting 56",
     program_g90},
    {starts_incremental, siemens, "MD20150[13]", "MD20150[13] (GCODE_RESET_VALUES)",
     siemens_distance, assume, "Siemens 6FC5398-2EP40-0BA0, 4.3, G group 14"},
    {modes_are_initial, fanuc, "3402#6", "parameter 3402#6 (CLR)", clear_state, follow_all,
     "Fanuc B-63950EN, parameters of programs"},
    {modes_are_initial, haas, "setting 56", "setting 56 (M30 Restore Default G)", restores_codes,
     follow_all, "Haas mill operator's manual 96-8000, settings"},
    {starts_with_feed, fanuc, "3402#0", "parameter 3402#0 (G01)", motion_modes, follow_all,
     "Fanuc B-63950EN, parameters of programs"},
    {starts_in_plane, fanuc, "3402#1", "parameter 3402#1 (G18)", zx_plane, follow_all,
     "Fanuc B-63950EN, parameters of programs"},
    {starts_in_yz, fanuc, "3402#2", "parameter 3402#2 (G19)", yz_plane, follow_all,
     "Fanuc B-63950EN, parameters of programs"},
    {starts_in_plane,
     haas,
     {},
     "whether an earlier program left G18",
     zx_plane,
     follow_all,
     "Haas mill operator's manual 96-8000, setting 56",
     "Program G17 before the first arc or cycle."},
    {starts_at_r_level,
     fanuc,
     {},
     "whether an earlier program left G99",
     retract_modes,
     follow_all,
     "Fanuc B-63950EN, parameters of programs",
     "Program G98 or G99 before the first cycle."},
    {starts_at_r_level,
     haas,
     {},
     "whether an earlier program left G99",
     retract_modes,
     follow_all,
     "Haas mill operator's manual 96-8000, setting 56",
     "Program G98 or G99 before the first cycle."},
    {starts_incremental,
     rs274,
     {},
     "whether G91 was left active",
     distance_modes,
     follow_all,
     "LinuxCNC 2.9, G codes; Grbl 1.1, gcode.c: MDI, jogging or a stopped program leaves it",
     program_g90},
    {starts_in_plane,
     rs274,
     {},
     "whether G18 was left active",
     zx_plane,
     follow_all,
     "LinuxCNC 2.9, G codes; Grbl 1.1, gcode.c: MDI or a stopped program leaves it",
     "Program G17 before the first arc or cycle."},
    {starts_at_r_level,
     linuxcnc,
     {},
     "whether G99 was left active",
     retract_modes,
     follow_all,
     "LinuxCNC 2.9, interp_convert.cc: M2 and M30 do not reset it",
     "Program G98 or G99 before the first cycle."},
    {starts_in_plane, siemens, "MD20150[5]", "MD20150[5] (GCODE_RESET_VALUES)", siemens_plane,
     follow_all, "Siemens 6FC5398-2EP40-0BA0, 4.3, G group 6"},
    {starts_without_work, any_siemens, "MD20150[7]", "MD20150[7] (GCODE_RESET_VALUES)",
     siemens_work, follow_all, "Siemens 6FC5398-2EP40-0BA0, 4.3, G group 8"},

    {length_follows_plane, fanuc, "5001#1", "parameter 5001#1 (TLB)", length_of_plane, follow_all,
     "Fanuc B-63943EN-1, 12.5.2, tool length compensation A, B and C"},
    {length_follows_axis, fanuc, "5001#0", "parameter 5001#0 (TLC)", length_of_axis, follow_all,
     "Fanuc B-63943EN-1, 12.5.2, tool length compensation A, B and C"},
    {length_is_reloaded, fanuc, "5001#6", "parameter 5001#6 (EVO)", length_reload, follow_all,
     "Fanuc B-63950EN, parameters of tool compensation"},
    {offset_memory, fanuc, "tool offset memory", "the type of the tool offset memory",
     offset_memories, follow_all,
     "Fanuc B-63944EN, tool compensation values, and system variables of tool compensation"},
    {radii_are_entered, fanuc, "5004#2", "parameter 5004#2 (ODI)", radius_sizes, follow_all,
     "Fanuc B-63950EN, parameters of tool compensation"},
    {radii_are_entered, haas, "setting 40", "setting 40 (Tool Offset Measure)", offset_sizes,
     follow_all, "Haas mill operator's manual 96-8000, settings"},
    {entry_has_corner, fanuc, "5003#0", "parameter 5003#0 (SUP)", entry_types, follow_all,
     "Fanuc B-63944EN-2, 6.6.2, tool movement in start-up, types A and B"},
    {contour_look_ahead,
     fanuc,
     "19625",
     "parameter 19625",
     {},
     go_on,
     "Fanuc B-63950EN, parameters of tool compensation",
     {},
     of_blocks},
    {entry_has_corner, haas, "setting 43", "setting 43 (Cutter Comp Type)", haas_entry, go_on,
     "Haas mill operator's manual 96-8000, settings"},
    {contour_type_is_yasnac, haas, "setting 58", "setting 58 (Cutter Compensation)", haas_contour,
     go_on, "Haas mill operator's manual 96-8000, settings"},
    {entry_is_upright, fanuc, "5003#1", "parameter 5003#1 (SUV)", upright_entry, follow_all,
     "Fanuc B-63950EN, parameters of tool compensation"},

    {drills_normal_to_plane, fanuc, "5101#0", "parameter 5101#0 (FXY)", drilling_axis, follow_all,
     "Fanuc B-63950EN, parameters of canned cycles for drilling"},
    {drills_where_defined, haas, "setting 28", "setting 28 (Can Cycle Act w/o X/Y)",
     drilling_definition, follow_all, "Haas mill operator's manual 96-8000, settings"},
    {peck_retract,
     fanuc,
     "5114",
     "parameter 5114, the retract of G73,",
     one_mm,
     assume,
     "Fanuc B-63950EN, parameters of canned cycles for drilling",
     {},
     of_lengths},
    {peck_clearance,
     fanuc,
     "5115",
     "parameter 5115, the clearance of G83,",
     one_mm,
     assume,
     "Fanuc B-63950EN, parameters of canned cycles for drilling",
     {},
     of_lengths},
    {peck_retract,
     haas,
     "setting 22",
     "setting 22 (Can Cycle Delta Z)",
     one_mm,
     assume,
     "Haas mill operator's manual 96-8000, settings",
     {},
     of_lengths},
    {peck_lift,
     haas,
     "setting 52",
     "setting 52 (G83 Retract Above R)",
     no_lift,
     assume,
     "Haas mill operator's manual 96-8000, G83 and settings",
     {},
     of_lengths},
    {shift_direction, fanuc, "5148", "parameter 5148", fanuc_shift, follow_all,
     "Fanuc B-63950EN, parameters of canned cycles for drilling"},
    {shift_direction, haas, "setting 27", "setting 27 (G76/G77 Shift Dir.)", haas_shift, follow_all,
     "Haas mill operator's manual 96-8000, settings"},

    {rotation_adds, fanuc, "5400#0", "parameter 5400#0 (RIN)", rotation_words, follow_all,
     "Fanuc B-63503EN-1, 11, coordinate system rotation"},
    {rotation_default,
     fanuc,
     "5410",
     "parameter 5410",
     {},
     go_on,
     "Fanuc B-63503EN-1, 11, coordinate system rotation",
     {},
     of_angles},
    {scale_unit, fanuc, "5400#7", "parameter 5400#7 (SCR)", scale_steps, follow_all,
     "Fanuc B-63950EN, parameters of scaling"},
    {scale_default,
     fanuc,
     "5411",
     "parameter 5411",
     {},
     go_on,
     "Fanuc B-63950EN, parameters of scaling",
     {},
     of_factors},
    {vertical_axis, fanuc, "12321", "parameter 12321", vertical_axes, follow_all,
     "Fanuc A-79976E, tilted working plane based on the tool axis direction"},
    {vertical_limit,
     fanuc,
     "12322",
     "parameter 12322",
     one_degree,
     assume,
     "Fanuc A-79976E, tilted working plane based on the tool axis direction",
     {},
     of_poles},
    {p1_is_positive, fanuc, "G53.1 P1", "the direction that P1 and P2 of G53.1 choose", signs_of_p1,
     follow_all, "Fanuc B-64484EN-2, tilted working plane: tool axis direction control"},
    {rotation_adds, haas, "setting 73", "setting 73 (G68 Incremental Angle)", rotation_of_haas,
     follow_all, "Haas mill operator's manual 96-8000, settings"},
    {rotation_default,
     haas,
     "setting 72",
     "setting 72 (Default G68 Rotation)",
     {},
     go_on,
     "Haas mill operator's manual 96-8000, settings",
     {},
     of_angles},
    {scale_default,
     haas,
     "setting 71",
     "setting 71 (Default G51 Scaling)",
     {},
     go_on,
     "Haas mill operator's manual 96-8000, settings",
     {},
     of_factors},
    {scales_z, fanuc, "5401#0", "parameter 5401#0 (SCL) of Z", scaled_z, follow_all,
     "Fanuc B-63950EN, parameters of scaling"},
    {is_mirrored, haas, "setting 45", "setting 45 (Mirror Image X-Axis)", not_mirrored, go_on,
     "Haas mill operator's manual 96-8000, settings"},
    {is_mirrored, haas, "setting 46", "setting 46 (Mirror Image Y-Axis)", not_mirrored, go_on,
     "Haas mill operator's manual 96-8000, settings"},
    {is_mirrored, haas, "setting 47", "setting 47 (Mirror Image Z-Axis)", not_mirrored, go_on,
     "Haas mill operator's manual 96-8000, settings"},
    {is_mirrored, haas, "setting 48", "setting 48 (Mirror Image A-Axis)", not_mirrored, go_on,
     "Haas mill operator's manual 96-8000, settings"},
    {local_is_work, haas, "setting 33", "setting 33 (Coordinate System)", coordinate_system, assume,
     "Haas mill operator's manual 96-8000, settings"},

    {increment_is_finer, fanuc, "1013#1", "parameter 1013#1 (ISC)", finer, assume,
     "Fanuc B-63950EN, parameters of axis control"},
    {increment_is_coarser, fanuc, "1013#0", "parameter 1013#0 (ISA)", coarser, go_on,
     "Fanuc B-63950EN, parameters of axis control"},
    {corner_tolerance,
     haas,
     "setting 85",
     "setting 85 (Maximum Corner Rounding)",
     {},
     go_on,
     "Haas mill operator's manual 96-8000, settings, G187",
     {},
     of_lengths},
    {arc_tolerance,
     fanuc,
     "3410",
     "parameter 3410",
     {},
     go_on,
     "Fanuc B-63950EN, parameters of programs",
     {},
     of_lengths},
    {arc_tolerance,
     linuxcnc,
     "CENTER_ARC_RADIUS_TOLERANCE_MM",
     "CENTER_ARC_RADIUS_TOLERANCE_MM",
     {},
     go_on,
     "LinuxCNC 2.9, INI configuration, [RS274NGC]",
     {},
     of_lengths},
    {arc_tolerance_inch,
     linuxcnc,
     "CENTER_ARC_RADIUS_TOLERANCE_INCH",
     "CENTER_ARC_RADIUS_TOLERANCE_INCH",
     {},
     go_on,
     "LinuxCNC 2.9, INI configuration, [RS274NGC]",
     {},
     of_inches},
    {change_moves,
     linuxcnc,
     {},
     "where M6 moves the machine",
     tool_change_motion,
     assume,
     "LinuxCNC 2.9, INI configuration, [EMCIO]",
     "Give the ini file with --ini, or state TOOL_CHANGE_POSITION under [control]."},
    {incremental_acts_once, haas, "setting 29", "setting 29 (G91 Non-modal)", incremental_blocks,
     follow_all, "Haas mill operator's manual 96-8000, settings"},
    {lone_arc_is_straight, fanuc, "3403#5", "parameter 3403#5 (CIR)", lone_arcs, go_on,
     "Fanuc B-63950EN, parameters of programs"},
    {change_takes_waiting, fanuc, "M6 T", "which tool M6 takes where its block has a T",
     tools_of_m6, follow_all,
     "Fanuc B-63944EN, 10, tool function: the manual of the machine builder"},
    {rotary_rolls_over, fanuc, "1008#0", "parameter 1008#0 (ROA)", roll_over, follow_all,
     "Fanuc B-63950EN, parameters of coordinates; B-63944EN, rotary axis roll-over"},
    {rotary_follows_sign, fanuc, "1008#1", "parameter 1008#1 (RAB)", rotary_directions, follow_all,
     "Fanuc B-63950EN, parameters of coordinates; B-63944EN, rotary axis roll-over"},
    {half_turn_is_negative,
     fanuc,
     {},
     "which way round a rotary axis makes half a turn",
     half_turns,
     follow_all,
     "Fanuc B-63944EN, rotary axis roll-over: the shorter way",
     "Program a position less than half a turn away, or an incremental angle."},
    {m428_follows_tip, linuxcnc, "M428", "what M428 and M429 switch to", meanings_of_m428,
     follow_all, "LinuxCNC 2.9, switchable kinematics; the remaps of its sample machines"},
    {w_has_no_motor, linuxcnc, "5axiskins W", "whether W of 5axiskins has a motor", motor_of_w,
     go_on, "LinuxCNC, src/emc/kinematics/5axiskins.c; the readme of its sample bridgemill"},
    {one_way_is_modal, fanuc, "5431#0", "parameter 5431#0 (MDL)", one_way, assume,
     "Fanuc B-63950EN, parameters of single direction positioning"},
};

/// A position of all of X, Y and Z; other axes are at 0 unless stated.
AxisValues whole(const SettingValue& value) {
    const Position& position = std::get<Position>(value);
    AxisValues values{};
    for (size_t axis = 0; axis < axis_count; ++axis) values[axis] = position[axis].value_or(0.0);
    return values;
}

template <size_t axis>
void set_swivel_retract(Environment& to, const SettingValue& value) {
    to.swivel_retract[axis] = std::get<double>(value);
}

constexpr std::string_view swivel_data =
    "SINUMERIK Operate (IM9), Commissioning Manual 12/2017, 15.7, parameters of tool carriers";

constexpr ControlSetting settings[] = {
    {fanuc, "1240", "first reference point (G28), machine coordinates", SettingKind::position,
     [](Environment& to, const SettingValue& value) { to.home = whole(value); },
     "Fanuc B-63950EN, parameters of coordinates"},
    {fanuc, "1241", "second reference point (G30), machine coordinates", SettingKind::position,
     [](Environment& to, const SettingValue& value) { to.second_home = whole(value); },
     "Fanuc B-63950EN, parameters of coordinates"},
    {fanuc, "1242", "third reference point (G30 P3), machine coordinates", SettingKind::position,
     [](Environment& to, const SettingValue& value) { to.further_homes[0] = whole(value); },
     "Fanuc B-63950EN, parameters of coordinates"},
    {fanuc, "1243", "fourth reference point (G30 P4), machine coordinates", SettingKind::position,
     [](Environment& to, const SettingValue& value) { to.further_homes[1] = whole(value); },
     "Fanuc B-63950EN, parameters of coordinates"},
    {fanuc, "5440", "overrun of G60 for each axis, with the sign of the last approach",
     SettingKind::position,
     [](Environment& to, const SettingValue& value) { to.one_way_approach = whole(value); },
     "Fanuc B-63944EN, 4.2, single direction positioning (G60)"},
    {haas, "second home", "second home position (G30), machine coordinates", SettingKind::position,
     [](Environment& to, const SettingValue& value) { to.second_home = whole(value); },
     "Haas mill operator's manual, NGC, settings 268 to 270"},
    {haas, "setting 35", "G60 offset: the distance past the target before G60 turns back",
     SettingKind::length,
     [](Environment& to, const SettingValue& value) {
         to.one_way_approach.emplace().fill(-std::get<double>(value));
     },
     "Haas mill operator's manual 96-8000, settings, G60"},
    {siemens, "MD30600", "first fixed point (G75), machine coordinates", SettingKind::position,
     [](Environment& to, const SettingValue& value) { to.fixed_point = whole(value); },
     "SINUMERIK 840D sl, Programming Manual Fundamentals, approaching a fixed point (G75)"},
    {siemens, "CYCLE800 X", "where CYCLE800 retracts along X, machine coordinate",
     SettingKind::length, set_swivel_retract<0>, swivel_data},
    {siemens, "CYCLE800 Y", "where CYCLE800 retracts along Y, machine coordinate",
     SettingKind::length, set_swivel_retract<1>, swivel_data},
    {siemens, "CYCLE800 Z", "where CYCLE800 retracts along Z, machine coordinate",
     SettingKind::length, set_swivel_retract<2>, swivel_data},
    {klartext, "datum", "the row of the preset table that is the work offset of the set-up",
     SettingKind::number,
     [](Environment& to, const SettingValue& value) { to.datum = std::get<double>(value); },
     "Heidenhain TNC 640, cycle programming, datum setting (cycle 247)"},
    {linuxcnc, "TOOL_CHANGE_POSITION", "where M6 moves to", SettingKind::position,
     [](Environment& to, const SettingValue& value) {
         to.tool_change.position = std::get<Position>(value);
         to.tool_change.is_stated = true;
     },
     "LinuxCNC 2.9, INI configuration, [EMCIO]"},
    {linuxcnc, "TOOL_CHANGE_AT_G30", "whether M6 moves to the reference point of G30",
     SettingKind::flag,
     [](Environment& to, const SettingValue& value) {
         to.tool_change.goes_to_second_home = std::get<bool>(value);
         to.tool_change.is_stated = true;
     },
     "LinuxCNC 2.9, INI configuration, [EMCIO]"},
    {linuxcnc, "TOOL_CHANGE_QUILL_UP", "whether M6 moves Z to machine zero first",
     SettingKind::flag,
     [](Environment& to, const SettingValue& value) {
         to.tool_change.quill_up = std::get<bool>(value);
         to.tool_change.is_stated = true;
     },
     "LinuxCNC 2.9, INI configuration, [EMCIO]"},
    {linuxcnc, "TOOL_CHANGE_WITH_SPINDLE_ON", "whether M6 leaves the spindle running",
     SettingKind::flag,
     [](Environment& to, const SettingValue& value) {
         to.tool_change.keeps_spindle_running = std::get<bool>(value);
     },
     "LinuxCNC 2.9, INI configuration, [EMCIO]"},
    {linuxcnc, "RS274NGC_STARTUP_CODE", "codes that are executed before the program",
     SettingKind::text,
     [](Environment& to, const SettingValue& value) {
         to.startup_code = std::get<std::string>(value);
     },
     "LinuxCNC 2.9, INI configuration, [RS274NGC]"},
    {linuxcnc, "WRAPPED_ROTARY", "letters of the rotary axes with WRAPPED_ROTARY = 1",
     SettingKind::text,
     [](Environment& to, const SettingValue& value) {
         to.wrapped_axes = std::get<std::string>(value);
     },
     "LinuxCNC 2.9, INI configuration, [AXIS]"},
    {linuxcnc, "ORIENT_OFFSET", "angle added to R of M19: moves no axis", SettingKind::number,
     [](Environment&, const SettingValue&) {}, "LinuxCNC 2.9, INI configuration, [RS274NGC]"},
};

constexpr ControlPreset::Value fanuc_as_delivered[] = {{"5006#6", 0}, {"6001#6", 0}, {"6001#7", 0}};

// Values that makers deliver differently, or that builders change as a rule, are not in a preset.
constexpr ControlPreset presets[] = {
    {"fanuc-0i-mf", DialectId::fanuc, "Fanuc 0i-MF, parameters as delivered", fanuc_as_delivered},
    {"fanuc-30i", DialectId::fanuc, "Fanuc 30i, 31i and 32i, parameters as delivered",
     fanuc_as_delivered},
    {"haas-ngc", DialectId::haas, "Haas Next Generation Control", {}},
    {"linuxcnc-2.9", DialectId::linuxcnc, "LinuxCNC 2.9", {}},
    {"sinumerik-840d-sl", DialectId::siemens, "SINUMERIK 840D sl", {}},
    {"tnc-640", DialectId::heidenhain, "Heidenhain TNC 640", {}},
    {"grbl-1.1", DialectId::grbl, "Grbl 1.1", {}},
};

template <typename Row>
bool has_dialect(const Row& row, DialectId dialect) {
    return std::find(row.dialects.begin(), row.dialects.end(), dialect) != row.dialects.end();
}

template <typename Row>
const Row* find_row(std::span<const Row> rows, std::string_view key, DialectId dialect) {
    for (const Row& row : rows)
        if (!key.empty() && row.key == key && has_dialect(row, dialect)) return &row;
    return nullptr;
}

} // namespace

std::optional<double> ControlParameter::answer_of(double number) const {
    for (const ParameterValue& value : values)
        if (value.number == number) return value.answer;
    return range.contains(number) ? std::optional(number) : std::nullopt;
}

std::string ControlParameter::choices() const {
    if (range.lowest < range.highest)
        return fmt::format("a number from {:g} to {:g} ({})", range.lowest, range.highest,
                           range.unit);
    std::string text;
    for (const ParameterValue& value : values) {
        if (!text.empty()) text += &value == &values.back() ? " or " : ", ";
        text += value.word.empty() ? fmt::format("{:g}", value.number)
                                   : fmt::format("\"{}\"", value.word);
    }
    return text;
}

std::span<const ControlParameter> control_parameters() { return parameters; }

const ControlParameter* find_parameter(ControlQuestion question, DialectId dialect) {
    for (const ControlParameter& parameter : parameters)
        if (parameter.question == question && has_dialect(parameter, dialect)) return &parameter;
    return nullptr;
}

const ControlParameter* find_parameter(std::string_view key, DialectId dialect) {
    return find_row<ControlParameter>(parameters, key, dialect);
}

std::span<const ControlSetting> control_settings() { return settings; }

const ControlSetting* find_setting(std::string_view key, DialectId dialect) {
    return find_row<ControlSetting>(settings, key, dialect);
}

std::span<const ControlPreset> control_presets() { return presets; }

const ControlPreset* find_preset(std::string_view name) {
    const auto* found = std::find_if(std::begin(presets), std::end(presets),
                                     [&](const auto& preset) { return preset.name == name; });
    return found == std::end(presets) ? nullptr : found;
}

} // namespace gcode
