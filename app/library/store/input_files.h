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

/// Repeats the file accesses of a check. Reads a file only once until it changes. Thread-safe.
class InputAnswers {
public:
    /// Whether the access gives the same answer as in the check. A file that could not be read
    /// counts as changed.
    bool is_same(const InputFile& input);

    /// The SHA-256 of a file; empty if it cannot be read.
    std::string content_of(const std::string& path);

private:
    using Names = std::shared_ptr<const std::vector<std::string>>;

    /// A cached answer, and the state of its file or folder.
    template <typename T>
    struct Known {
        FileStamp stamp;
        bool was_fresh = true; // may have been written within the resolution of its time stamp
        T answer{};
    };

    std::optional<std::string> name_in_any_case(const InputFile& input);
    Names names_of(const std::string& folder);

    /// The cached answer for a path if its stamp is unchanged, else a new one.
    template <typename T, typename Read>
    T ask(std::map<std::string, Known<T>>& known, const std::string& path, Read&& read);

    std::mutex mutex_;
    std::map<std::string, Known<std::string>> contents_;
    std::map<std::string, Known<Names>> names_; // of files in folders
};

} // namespace app
