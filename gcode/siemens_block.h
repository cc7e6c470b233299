#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "gcode/expression.h"

namespace gcode {

/// What a keyword of native Siemens asks for.
enum class SiemensAction : uint8_t {
    note,    // understood; no effect on positions
    warning, // likewise, but a person should know
    refusal,
    // words with a value: CR=5
    address,
    noted_address,   // whose value has no effect on positions
    refused_address, // not carried out
    // motions and modes
    arc_by_point,  // CIP
    tangent_arc,   // CT
    machine_place, // SUPA
    diameters,     // DIAMON
    radii,         // DIAMOF
    transformation_off,
    transformation, // TRAORI
    // frames
    shift,
    add_shift,
    turn,
    add_turn,
    scale,
    add_scale,
    mirror,
    add_mirror,
    // calls in brackets
    message,
    swivel,     // CYCLE800
    drill,      // CYCLE81 to CYCLE89, CYCLE840
    hole_row,   // HOLES1
    hole_circle // HOLES2
};

/// A row of the one table of keywords.
struct SiemensKeyword {
    std::string_view name;
    SiemensAction action;
    std::string_view text{}; // of a warning or refusal; of an address its letter

    constexpr bool operator<(const SiemensKeyword& other) const { return name < other.name; }
};

/// The keyword of a name in capitals; null when it is none.
const SiemensKeyword* siemens_keyword(std::string_view name);

struct SiemensKeywordUse {
    const SiemensKeyword* keyword;
    core::SourceSpan span;
};

/// A value in brackets or behind a keyword: an expression, a text, or nothing at all.
struct SiemensArgument {
    enum class Kind : uint8_t { nothing, value, text };

    Kind kind = Kind::nothing;
    Expression expression{};
    double plain = 0.0;      // the value when it is a plain number
    std::string_view text{}; // what stands between the quotation marks
    core::SourceSpan span{};
};

/// How a jump looks for its target.
enum class JumpWay : uint8_t { forward, backward, either, quietly, to_start };

/// `GOTOF END`, `IF R1 > 5 GOTOB N100`.
struct SiemensJump {
    SiemensArgument condition; // nothing: always
    JumpWay way = JumpWay::either;
    std::string target; // in capitals
    core::SourceSpan span{};
};

enum class SiemensType : uint8_t { real, whole, truth, text };

/// A variable of DEF, or a parameter of PROC.
struct SiemensDeclaration {
    SiemensType type = SiemensType::real;
    std::string name; // lower case
    SiemensArgument initial;
    bool by_reference = false;
    core::SourceSpan span{};
};

/// What a block of native Siemens says beside its words and assignments.
struct SiemensBlock {
    std::string label{}; // `NAME:`, in capitals
    std::vector<SiemensKeywordUse> keywords{};
    std::vector<SiemensJump> jumps{};
    std::vector<SiemensDeclaration> declarations{}; // of DEF and PROC
    std::string name{};                             // of the program that is called or begins
    core::SourceSpan name_span{};
    std::vector<SiemensArgument> arguments{}; // of a call, a cycle, MSG; of UNTIL and the like one
    SiemensArgument repeats{};                // P of a call
    SiemensArgument tool_name{};              // T="..."
    bool is_modal_call = false;               // MCALL
    bool saves_modes = false;                 // SAVE of PROC

    void clear();
};

} // namespace gcode
