#pragma once

#include <string>
#include <string_view>

namespace app {

struct SetupFile;

/// Why a set-up cannot be that of a machine which is watched while it runs; empty if it can. It
/// must be complete, since there is no program from which anything is inferred. `who` watches: "the
/// guard".
std::string why_incomplete(const SetupFile& setup, std::string_view who);

} // namespace app
