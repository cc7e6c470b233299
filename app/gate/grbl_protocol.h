#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/vec.h"

namespace app {

/// What a line that is sent to Grbl is for.
enum class GrblLine : uint8_t {
    empty,   // nothing but blanks and comments
    code,    // G-code
    jog,     // $J=
    home,    // $H
    unlock,  // $X
    request, // asks for something or switches a mode; moves nothing: $, $$, $#, $G, $I, $N, $C,
             // $SLP
    other,   // settings and all other commands: $100=250, $N0=, $RST=, [ESP...]
};

/// A line as Grbl's protocol.c reads it: in capitals, without blanks, comments, control characters
/// and `/`.
std::string as_grbl_reads(std::string_view line);
/// `text`: as_grbl_reads has made it.
GrblLine kind_of(std::string_view text);

/// Whether a byte acts at once, wherever it stands, and is no part of a line; those that Grbl 1.1
/// knows, and feed hold and stop of grblHAL.
bool acts_at_once(char byte);
/// Whether a byte is neither a part of a line nor known; Grbl drops it.
bool is_dropped(char byte);

constexpr char soft_reset = 0x18, status_request = '?', feed_hold = '!', cycle_start = '~';
constexpr char other_hold = static_cast<char>(0x82), stop = 0x19; // of grblHAL
constexpr char safety_door = static_cast<char>(0x84), jog_cancel = static_cast<char>(0x85);

/// A status report: <Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:...>
struct GrblStatus {
    std::string state;                // "Idle", "Run", "Hold", without what follows a colon
    std::optional<core::Vec3> mpos;   // as reported: mm, or inches if $13 says so
    std::optional<core::Vec3> wpos{}; // instead of the above
};
std::optional<GrblStatus> read_status(std::string_view line);

/// What a controller says about itself in answer to $I, $$, $N, $# and $G. Lengths in mm.
struct GrblFacts {
    std::array<core::Vec3, 6> offsets{}; // G54 to G59
    core::Vec3 home = core::Vec3(0.0), second_home = core::Vec3(0.0), axis_offset = core::Vec3(0.0);
    double length_offset = 0.0;
    std::string modes;                     // "G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0"
    std::string stored_line;               // a start-up line that moves something ($N)
    std::optional<size_t> planner, buffer; // blocks, and bytes; empty if not stated
    core::Vec3 step = core::Vec3(0.0);     // mm; 0: not stated
    double arc_tolerance = 0.002;          // mm; 0 if it is less than the controller shows
    bool reports_inches = false;           // $13
    bool is_reset = false;                 // it was reset since it was asked before
    bool is_dry = false;                   // what it did since then was in check mode
    bool is_lost = false;                  // nobody knows where the machine is
    bool ended_homing = false;             // because a homing was not finished
    bool was_homed = false;                // for the first time since it was started
    unsigned seen = 0;                     // one bit for each of G54 to G59, G92, G28, G30, TLO
    bool has_offsets() const { return seen == 0x3ff; }
    core::Vec3 scaled(core::Vec3 reported) const; // to mm

    /// The work offset in use, 0 for G54; empty if the modes do not say it.
    std::optional<size_t> active() const;
    /// A mode that Grbl 1.1 does not have; empty if there is none.
    std::string unknown_mode() const;
    /// Where the program's zero is, in machine coordinates; without the length offset.
    core::Vec3 zero() const { return offsets[active().value_or(0)] + axis_offset; }

    /// Takes in one line of an answer.
    void take(std::string_view line);
};

/// The number of Grbl's error that a message of the interpreter names, such as "(error 31)"; 20, a
/// line that is not supported, if it names none.
int grbl_error_in(std::string_view message);

/// A push message to the sender, whose text has no brackets.
std::string grbl_message(std::string text);

} // namespace app
