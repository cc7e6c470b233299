#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "gcode/modal_state.h"
#include "gcode/parameters.h"
#include "gcode/shared.h"
#include "gcode/siemens_block.h"

namespace gcode {

/// A line of one of the programs that are read; source 0 is the main program.
struct Place {
    uint32_t source = 0;
    uint32_t line = 1;

    auto operator<=>(const Place&) const = default;
};

/// A macro call that is made again after every motion (G66) or for every block (G66.1).
struct ModalMacro {
    std::string name;
    Place begin;                 // its first line
    LocalParameters arguments{}; // as the last call left them
    int64_t rounds = 1;
    bool each_block = false; // G66.1: every block is its arguments

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
    std::map<std::string, SiemensType, std::less<>> types{}; // of declared names that are no REAL
    std::map<uint32_t, int64_t> repeats{};                   // line of `repeat`: rounds still to go
    int64_t rounds_left = 0;                                 // of M98 L
    std::optional<LocalParameters> again{};    // the locals that another round begins with
    Shared<std::optional<ModalState>> saved{}; // M70, M73
    bool restores = false;                     // M73: at the return
    size_t modal_macro = 0;                    // which one of G66 called it, from 1; 0 for none

    bool operator==(const Frame&) const = default;
};

} // namespace gcode
