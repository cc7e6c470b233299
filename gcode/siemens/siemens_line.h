#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/exec/frame.h"
#include "gcode/language/block.h"

namespace gcode {

/// Effect of a Siemens keyword.
enum class SiemensAction : uint8_t {
    note,    // understood; no effect on positions
    warning, // understood, but reported; no effect on positions
    refusal,
    // words with a value: CR=5
    address,
    noted_address,   // the value has no effect on positions
    refused_address, // not supported
    normal_vector,   // A4 to C5: of the surface
    angle_to_path,   // LEAD, TILT, THETA
    orient_spindle,  // SPOS=90
    fixed_point,     // FP= of G75
    tolerance,       // ADIS, ADISPOS and CTOL
    corner_shape,    // DISC
    compressor_on,
    compressor_off,
    // motions and modes
    arc_by_point,     // CIP
    tangent_arc,      // CT
    machine_position, // SUPA
    diameters,        // DIAMON
    radii,            // DIAMOF
    transformation_off,
    transformation,     // TRAORI
    orient_axes,        // ORIAXES
    orient_by_vector,   // ORIVECT, ORIPLANE
    orient_in_machine,  // ORIMKS
    orient_in_work,     // ORIWKS
    other_orientation,  // ORICONCCW and the like
    orient_along_path,  // ORIPATH
    euler_angles,       // ORIEULER
    rpy_angles,         // ORIRPY
    other_angles,       // ORIRPY2, ORIVIRT1
    tool_frame,         // TOROT
    tool_frame_off,     // TOROTOF
    smooth_orientation, // ORISON
    plain_orientation,  // ORISOF
    other_approach,     // KONT
    usual_approach,     // NORM
    bent_rapids,        // RTLIOF
    straight_rapids,    // RTLION
    // frames
    shift,
    add_shift,
    turn,
    add_turn,
    space_turn,     // ROTS
    add_space_turn, // AROTS
    scale,
    add_scale,
    mirror,
    add_mirror,
    // calls in brackets
    message,
    swivel,     // CYCLE800
    smoothing,  // CYCLE832
    drill,      // CYCLE81 to CYCLE89, CYCLE840
    hole_row,   // HOLES1
    hole_circle // HOLES2
};

/// A row of the table of keywords.
struct SiemensKeyword {
    std::string_view name;
    SiemensAction action;
    std::string_view text{}; // of a warning or refusal; the letter of an address

    constexpr bool operator<(const SiemensKeyword& other) const { return name < other.name; }
};

/// All keywords, sorted by name.
std::span<const SiemensKeyword> siemens_keywords();

/// A value in brackets or after a keyword: an expression, a string or nothing.
struct SiemensArgument {
    enum class Kind : uint8_t { nothing, value, text };

    Kind kind = Kind::nothing;
    Expression expression{};
    double plain = 0.0;      // the value, if it is a plain number
    std::string_view text{}; // between the quotation marks
    core::SourceSpan span{};
};

struct SiemensKeywordUse {
    const SiemensKeyword* keyword;
    core::SourceSpan span;
    SiemensArgument value{}; // of a tolerance
};

/// Where a jump searches for its target.
enum class JumpDirection : uint8_t { forward, backward, either, no_alarm, to_start };

/// `GOTOF END`, `IF R1 > 5 GOTOB N100`.
struct SiemensJump {
    SiemensArgument condition; // nothing: unconditional
    JumpDirection direction = JumpDirection::either;
    std::string target; // in capitals
    core::SourceSpan span{};
};

/// A variable of DEF, or a parameter of PROC.
struct SiemensDeclaration {
    VariableType type = VariableType::real;
    std::string name; // lower case
    SiemensArgument initial;
    bool by_reference = false;
    core::SourceSpan span{};
};

/// What a Siemens block contains besides words and assignments.
struct SiemensLine {
    std::string label{}; // `NAME:`, in capitals
    std::vector<SiemensKeywordUse> keywords{};
    std::vector<SiemensJump> jumps{};
    std::vector<SiemensDeclaration> declarations{}; // of DEF and PROC
    std::string name{};                             // of the program that is called or defined
    core::SourceSpan name_span{};
    std::vector<SiemensArgument> arguments{}; // of a call, a cycle, MSG; UNTIL and similar have one
    SiemensArgument repeats{};                // P of a call
    SiemensArgument tool_name{};              // T="..."
    bool is_modal_call = false;               // MCALL
    bool saves_modes = false;                 // SAVE of PROC

    void clear();
};

inline const SiemensLine& siemens_of(const Block& block) {
    return block.language_line.as<SiemensLine>();
}

} // namespace gcode
