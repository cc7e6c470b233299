#pragma once

#include <string>
#include <vector>

#include "app/library/store/result_store.h"

namespace app {

/// A program's versions for a person, in the order given: when, verdict, nearest place, time, and
/// what became other since the version before with the same set-up and options.
std::string history_text(const std::string& program, const std::vector<StoredVersion>& versions);

/// The same as one JSON object, schema 1.
std::string history_json(const std::string& program, const std::vector<StoredVersion>& versions);

} // namespace app
