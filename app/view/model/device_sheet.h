#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace app::viewer {

struct ViewModel;

/// The emphasis of a value.
enum class Tone : uint8_t { plain, dim, near, bad };

/// A named value.
struct DeviceLine {
    std::string name, value;
    Tone tone = Tone::plain;
    std::optional<size_t> block = {}; // to which a click goes
};

/// The values under one heading.
struct DevicePart {
    std::string title;
    std::vector<DeviceLine> lines;
    bool is_short = false; // two lines fit side by side
};

/// All texts of the coprocessor panel for the current block.
struct DeviceSheet {
    std::string number; // in large type: the slack, or why there is none
    Tone tone = Tone::plain;
    std::string answer; // of the device for the block
    std::string exact;  // the result of the exact engine, compared with it
    Tone exact_tone = Tone::dim;
    std::vector<DevicePart> parts;
};

/// The texts of the panel. The model must have rows and a study.
DeviceSheet device_sheet(const ViewModel& model);

/// The progress or error to show while there are no results; empty once there are.
std::string device_status(const ViewModel& model);

/// The slack of a block for its tooltip; empty without a run or an answer.
std::string slack_words(const ViewModel& model, size_t block);

} // namespace app::viewer
