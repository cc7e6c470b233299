#pragma once

#include <string>

#include "app/session/body_pair.h"

namespace app {

/// The answer to `feeler distance` as JSON.
std::string json_distance(const BodyPairDistance& found);

/// The same for a person; of a sweep, it says when.
std::string text_distance(const BodyPairDistance& found, const std::string& a, const std::string& b,
                          bool swept);

} // namespace app
