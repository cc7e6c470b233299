#pragma once

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/sim/tool_description.h"

namespace app {

/// A size of a tool that can be stated: how a set-up calls it, how a person does, and where it is.
struct ToolField {
    using Member = std::variant<double core::ToolDescription::*,
                                std::optional<double> core::ToolDescription::*>;

    const char* key;
    const char* name;
    const char* unit;
    Member member;

    /// Empty where nothing is said of it.
    std::optional<double> of(const core::ToolDescription& tool) const;
    void put(core::ToolDescription& tool, std::optional<double> value) const;
};

/// Those that mean something for a shape, in the order in which they are shown.
std::vector<ToolField> fields_of(core::ToolShape shape);

/// Shapes that a person can choose; an outline is stated in a set-up file.
std::span<const core::ToolShape> stateable_shapes();

/// A tool with its lengths in the form that can be edited: one cylinder for its shank, if it has no
/// more, and the stick-out in place of what follows from it. It assembles to the same tool.
core::ToolDescription editable(core::ToolDescription tool);

/// The same tool in another shape: sizes that mean nothing for it are gone, those that it needs
/// are what such tools usually have.
core::ToolDescription reshaped(core::ToolDescription tool, core::ToolShape shape);

/// The name of a tool's holder among those that come with the program; empty if it is none of them.
std::string holder_name(const core::ToolDescription& tool);

} // namespace app
