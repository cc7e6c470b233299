#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "gcode/modal_state.h"
#include "gcode/parameters.h"
#include "gcode/shared.h"

namespace gcode {

/// A line of one of the programs that are read; source 0 is the main program.
struct Place {
    uint32_t source = 0;
    uint32_t line = 1;

    auto operator<=>(const Place&) const = default;
};

/// The letters of a macro call that is repeated after every motion (G66).
struct ModalMacro {
    std::string name;
    LocalParameters arguments{};

    bool operator==(const ModalMacro&) const = default;
};

/// One level of calls; the first is the main program.
struct Frame {
    Place called_from;  // the line of the call
    Place begin;        // the first line of what was called
    std::string name{}; // of the subprogram; empty for the main program
    LocalParameters locals{};
    bool shares_locals = false; // M98: #1 to #33 are those of the caller
    NamedValues named{};
    std::map<uint32_t, int64_t> repeats{};     // line of `repeat`: rounds still to go
    int64_t rounds_left = 0;                   // of M98 L
    Shared<std::optional<ModalState>> saved{}; // M70, M73
    bool restores = false;                     // M73: at the return
    bool is_modal_macro = false;               // called by G66

    bool operator==(const Frame&) const = default;
};

} // namespace gcode
