#pragma once

#include <string>
#include <vector>

#include "app/library/store/result_store.h"

namespace app {

/// The versions of a program as text, in the order given: date, verdict, least margin, cycle time,
/// and changes since the previous version with the same set-up and options.
std::string history_text(const std::string& program, const std::vector<StoredVersion>& versions);

/// The data of history_text as one JSON object, schema 1.
std::string history_json(const std::string& program, const std::vector<StoredVersion>& versions);

} // namespace app
