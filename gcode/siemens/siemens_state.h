#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gcode/exec/interpreter.h"

namespace gcode {

/// A drilling cycle with its parameters named as in the SINUMERIK manuals, in mm, mm/min and s;
/// program coordinates along the tool axis.
struct SiemensDrilling {
    int number = 0;           // 81 to 89, 840
    double retract = 0.0;     // RTP
    double reference = 0.0;   // RFP
    double safety = 0.0;      // SDIS, above the reference plane
    double bottom = 0.0;      // DP, or RFP minus DPR
    double dwell_below = 0.0; // DTB
    // CYCLE83
    double first_depth = 0.0; // FDEP, or RFP minus FDPR
    double degression = 0.0;  // DAM; negative: a factor
    double dwell_above = 0.0; // DTS
    double feed_factor = 1.0; // FRF
    bool clears_chips = false;
    double least_peck = 0.0;  // MDEP
    double break_back = 1.0;  // VRT
    double dwell_final = 0.0; // DTD
    double near =
        0.0; // DIS1: distance above the last depth at which a rapid ends; 0: from the depth
    // CYCLE84, CYCLE840
    double pitch = 0.0; // negative: left-hand thread
    double speed_in = 0.0, speed_out = 0.0;
    int direction_after = 5; // SDAC
    // CYCLE85
    double feed_in = 0.0, feed_out = 0.0;
    // CYCLE86 to CYCLE88
    int direction = 3;             // SDIR
    std::array<double, 3> aside{}; // RPA, RPO, RPAP

    bool operator==(const SiemensDrilling&) const = default;
};

/// Which word changes the tool, MD22550.
enum class SiemensToolChange : uint8_t { not_known_yet, with_t, with_m6 };

/// What A2, B2 and C2 are, as a code of the program says.
enum class SiemensAngles : uint8_t { not_said, euler, rpy, other };

/// The state of a native Siemens control between two blocks besides the modes.
struct SiemensState {
    std::array<double, 2> pole{};               // G110 to G112; program coordinates in the plane
    std::optional<double> radius, angle_deg;    // the last RP and AP
    std::optional<SiemensDrilling> modal_cycle; // MCALL
    std::optional<Frame> modal_call;            // MCALL of a program
    ProgramFrame frame;                         // TRANS, ROT, SCALE, MIRROR
    ProgramFrame swivel;                        // CYCLE800, before `frame`
    bool swivels = false;                       // the plane of CYCLE800 is on
    std::string swivel_data;                    // their name in the first CYCLE800 with one
    int edge = 1;                               // D; 0: none
    bool edge_is_assumed = false;               // selected by a tool change without D
    bool length_follows_plane = false;          // SD42940 is 0
    bool length_axis_is_settled = false;        // by SD42940, or by the program
    SiemensToolChange tool_change = SiemensToolChange::not_known_yet;
    bool feeds_in_inches = false; // G700
    int corner_code = 0;          // G450, G451; 0: not programmed, and not asked yet
    double corner_shape = 0.0;    // DISC
    int path_code = 0;            // G60, G64, G641 to G645; 0: that of the machine
    double feed_rounding = 0.0, rapid_rounding = 0.0; // ADIS and ADISPOS, mm
    double contour_tolerance = 0.0;                   // CTOL and CYCLE832, mm; 0: of the machine
    bool turns_by_axes = false;                       // ORIAXES
    bool turns_in_machine = false;                    // ORIMKS
    bool turns_otherwise = false;                     // ORICONCCW and the like
    bool smooths_turning = false;                     // ORISON
    bool turns_along_path = false;                    // ORIPATH
    bool turns_to_path = false;                       // LEAD or TILT has been programmed
    SiemensAngles angles{};                           // ORIEULER, ORIRPY
    bool turns_with_tool = false;                     // `swivel` is that of TOROT
    bool said_turning = false, said_rotary_offset = false, said_path = false; // reported
    bool compresses = false; // COMPON, COMPCURV, COMPCAD: joins short moves

    bool operator==(const SiemensState&) const = default;
};

void add(Digest& digest, const SiemensState& state);

inline const SiemensState& siemens_of(const InterpreterState& state) {
    return state.language.as<SiemensState>();
}
inline SiemensState& writable_siemens(InterpreterState& state) {
    return state.language.write<SiemensState>();
}

} // namespace gcode
