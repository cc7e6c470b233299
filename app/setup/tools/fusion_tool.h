#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/setup/tools/found_tool.h"

namespace app {

/// A tool as Fusion 360 and HSM describe it: mm, degrees.
struct FusionTool {
    std::string type, name;
    int number = 0;
    std::optional<double> diameter, largest_diameter; // DC, and DCX of a face mill
    std::optional<double> corner_radius;              // RE
    std::optional<double> flank_deg, point_deg;       // TA from the axis, SIG of the whole tip
    std::optional<double> tip_diameter, tip_length;
    std::optional<double> flute_length;                       // LCF
    std::optional<double> shoulder_length, shoulder_diameter; // from the tip; above the flutes
    std::optional<double> shank_diameter;                     // SFDM
    std::optional<double> body_length;                        // LB: from the tip to the holder
    std::optional<double> pitch;                              // TP
    bool is_left_hand = false;
    std::vector<core::ConeStep> shaft;   // from the shoulder up
    std::vector<core::ConeStep> holder;  // from the tool up
    std::optional<double> holder_length; // from its lower face to the gauge line
    bool is_damaged_above = false;       // the shaft or the holder has a size that is no number
};

/// Whether tools of this type are for turning, cut without contact, or do not cut at all.
bool is_no_rotating_cutter(const std::string& type);

/// The tool as a set-up describes it. Above the flutes it has the shoulder, the shaft and the
/// shank, up to the holder; the holder ends at the gauge line.
///
/// Source: Fusion's sample tools, in which these relations hold: the shoulder diameter of a
/// dovetail
///         mill is DC - 2 LCF tan TA, that of a tapered mill DC + 2 LCF tan TA, that of a radius
///         mill DC + 2 RE; the assembly's gauge length is LB plus the gauge length of the holder.
FoundTool found_tool_of(const FusionTool& tool, const std::string& source);

/// Tools by number, from a list in which several may have the same number: the first counts. It
/// says so if another one differs.
class NumberedTools {
public:
    explicit NumberedTools(std::string source) : source_(std::move(source)) {}

    /// Adds a tool with a number above 0 and a diameter; leaves out others.
    void add(const FusionTool& tool);

    /// The tools so far.
    ///
    /// Errors: syntax if there are none.
    core::Result<std::map<core::ToolNumber, FoundTool>> result() const;

private:
    struct Entry {
        FoundTool tool;
        size_t others = 0; // that differ
    };
    std::string source_;
    std::map<core::ToolNumber, Entry> entries_;
};

} // namespace app
