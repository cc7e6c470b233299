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
    std::optional<std::string> proposed{}; // the same, if the user shall decide
    std::string question{};                // the button for it
};
using JobFileReader = std::function<JobFileNews(const CheckJob& check, const std::string& path)>;

} // namespace app::viewer
