#pragma once

namespace app {

constexpr const char* version = FEELER_VERSION;

} // namespace app
