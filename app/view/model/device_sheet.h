#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace app::viewer {

struct ViewModel;

/// How a value is meant.
enum class Tone : uint8_t { plain, dim, near, bad };

/// A value with its name.
struct DeviceLine {
    std::string name, value;
    Tone tone = Tone::plain;
    std::optional<size_t> block = {}; // where a click goes
};

/// Values under one heading.
struct DevicePart {
    std::string title;
    std::vector<DeviceLine> lines;
    bool is_short = false; // so that two fit side by side
};

/// All that the panel says of the device and the block at the cursor, in words.
struct DeviceSheet {
    std::string number; // in large letters: slack, or what there is in place of it
    Tone tone = Tone::plain;
    std::string answer; // what the device says of the block
    std::string exact;  // how the exact engine stands to that
    Tone exact_tone = Tone::dim;
    std::vector<DevicePart> parts;
};

/// For a model with rows and a device that has answered.
DeviceSheet device_sheet(const ViewModel& model);

/// What goes on, where something does or nothing can be shown: reading, running, what is wrong.
/// Empty while all is there.
std::string device_status(const ViewModel& model);

/// What a tooltip says of the slack of a block: empty without a run, or where nothing was asked.
std::string slack_words(const ViewModel& model, size_t block);

} // namespace app::viewer
