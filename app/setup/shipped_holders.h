#pragma once

#include <span>

namespace app {

/// A file that is part of the program.
struct ShippedFile {
    const char* name;
    const char* text;
};

/// The holder libraries of assets/holders, as they were when the program was built.
std::span<const ShippedFile> shipped_holders();

} // namespace app
