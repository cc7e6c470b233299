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
    std::optional<size_t> block = {}; // that a click goes to
};

/// The values under one heading.
struct DevicePart {
    std::string title;
    std::vector<DeviceLine> lines;
    bool is_short = false; // two fit side by side
};

/// All texts of the panel about the device and the current block.
struct DeviceSheet {
    std::string number; // in large type: the slack, or its replacement
    Tone tone = Tone::plain;
    std::string answer; // of the device for the block
    std::string exact;  // the exact engine compared with it
    Tone exact_tone = Tone::dim;
    std::vector<DevicePart> parts;
};

/// The model must have rows and a study.
DeviceSheet device_sheet(const ViewModel& model);

/// The progress or error that is shown while there are no results. Empty if there are.
std::string device_status(const ViewModel& model);

/// The tooltip for the slack of a block; empty without a run or an answer.
std::string slack_words(const ViewModel& model, size_t block);

} // namespace app::viewer
