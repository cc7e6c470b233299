#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/session/input_file.h"

namespace app {

/// Asks the disk again what a check asked it. Every file is read once, so what it says is as old as
/// its first question. Several threads may ask.
class InputAnswers {
public:
    /// Whether the disk would answer a check as it did then. What could not be read is never the
    /// same.
    bool is_same(const InputFile& input);

    /// The SHA-256 of a file; empty when it cannot be read.
    std::string content_of(const std::string& path);

    /// From here on all is asked anew. Nobody may be asking.
    void forget();

private:
    std::optional<std::string> name_in_any_case(const InputFile& input);
    const std::vector<std::string>& names_of(const std::string& folder);

    std::mutex mutex_;
    std::map<std::string, std::string> contents_;
    std::map<std::string, std::vector<std::string>> names_; // of folders
};

} // namespace app
