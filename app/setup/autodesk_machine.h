#pragma once

#include <string>
#include <vector>

#include <toml++/toml.h>

#include "core/base/result.h"

namespace app {

/// A machine of Autodesk's machine library (Fusion 360, Inventor CAM, HSM).
struct AutodeskMachine {
    toml::table machine;            // as a machine file states it: linear axes
    std::string rotary;             // letters of the rotary axes, which are not among them
    std::vector<std::string> notes; // what is not taken over
};

/// Whether a path is that of such a machine: .machine or .mch.
bool is_autodesk_machine(const std::string& path);

/// Reads the linear axes of a machine: side, travel, home and rapid speed. Where the centres of
/// rotary axes are in the machine, these files do not say in a way that is known, so rotary axes
/// are only named.
///
/// Source: .machine is XML: Autodesk's "autodesk 3ax table head xyz.machine", as in the tests of
/// its
///         readers. .mch is JSON: the script of Autodesk's machine library that reads both ("Build
///         machine library"), and the keys of DMG MORI CMX 50 U.mch. Speeds there are in mm/min.
/// Errors: io; syntax, with file and line, for other files and for values without a known unit.
core::Result<AutodeskMachine> read_autodesk_machine(const std::string& path);

} // namespace app
