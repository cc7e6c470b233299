#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/session/condition_node.h"

namespace app {

/// What a name means where a number or word is wanted (`feed` of the control), and where something
/// true or false is (`feed`: the block feeds). Empty where it means nothing of the kind.
std::optional<Condition::Node> value_named(const std::string& name);
std::optional<Condition::Node> truth_named(const std::string& name);

/// The words that a part may be compared with; empty where there are too many to list.
std::vector<std::string> words_for(const Condition::Node& node);

/// Every name that is listed somewhere.
std::vector<std::string> condition_names();

} // namespace app
