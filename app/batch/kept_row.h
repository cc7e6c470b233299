#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/session/input_file.h"

namespace app {

/// A result as it lies in the database, with what its check read.
struct KeptRow {
    int64_t id = 0;
    std::string program, setup, options, version;
    int64_t checked_at = 0; // seconds since 1970
    std::string key, looks, value, seal;
    std::vector<InputFile> inputs;
};

/// The answer of a look as one text: it says whether there was one.
std::string answer_text(const InputFile& input);

/// A digest of looks: the same for the same, whatever their order.
std::string looks_of(std::vector<InputFile> inputs);

/// A digest of key, looks and value: a file that was damaged where SQLite does not see it does not
/// become another result.
std::string seal_of(const KeptRow& row);

/// Whether a row is what somebody kept.
bool is_sound(const KeptRow& row);

} // namespace app
