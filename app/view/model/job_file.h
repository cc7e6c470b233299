#pragma once

#include <functional>
#include <optional>
#include <string>

namespace app {
struct CheckJob;
}

namespace app::viewer {

/// What a file of a CAM system or of the control says about a job.
struct JobFileNews {
    std::string title, text;               // for the user
    std::optional<std::string> setup_text; // the set-up with what the file adds; empty: unchanged
};
using JobFileReader = std::function<JobFileNews(const CheckJob& check, const std::string& path)>;

} // namespace app::viewer
