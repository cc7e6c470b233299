#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/base/file_stamp.h"
#include "app/check/input_file.h"

namespace app {

/// Asks the disk again what a check asked it. A file is read once while it is not written again.
/// Several threads may ask.
class InputAnswers {
public:
    /// Whether the disk would answer a check as it did then. What could not be read is never the
    /// same.
    bool is_same(const InputFile& input);

    /// The SHA-256 of a file; empty when it cannot be read.
    std::string content_of(const std::string& path);

private:
    using Names = std::shared_ptr<const std::vector<std::string>>;

    /// What was read, and of which state of the file or folder.
    template <typename T>
    struct Known {
        FileStamp stamp;
        bool was_fresh = true; // it may have been written again in the same moment
        T answer{};
    };

    std::optional<std::string> name_in_any_case(const InputFile& input);
    Names names_of(const std::string& folder);

    /// What is known of a path, if it has not been written since; else what is read.
    template <typename T, typename Read>
    T ask(std::map<std::string, Known<T>>& known, const std::string& path, Read&& read);

    std::mutex mutex_;
    std::map<std::string, Known<std::string>> contents_;
    std::map<std::string, Known<Names>> names_; // of folders
};

} // namespace app
